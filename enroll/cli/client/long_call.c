#include "enroll/cli/client/long_call.h"

#include "drivers/terminal/progress.h"
#include "firmware/contract/contract.h"

/* A signal that cannot be read does not make the call fail. */
static bool on_progress(sd_bus_message *signal, void *context)
{
    uint64_t done, total;

    if (sd_bus_message_read(signal, "tt", &done, &total) >= 0) {
        iso_progress_set(context, done < total ? done : total, total);
    }
    return false;
}

enum cli_exit cli_long_call(struct cli_daemon *daemon, sd_bus_message *call, const char *what,
                            sd_bus_message **reply, struct cli_fault *fault)
{
    struct iso_progress *progress = iso_progress_start(stderr, "isotherm", what, 0, NULL);
    enum cli_exit exit;

    exit = cli_daemon_subscribe(daemon, ISO_CONTRACT_PROGRESS, on_progress, progress, fault);
    if (exit) {
        sd_bus_message_unref(call);
    } else {
        exit = cli_daemon_send_and_listen(daemon, call, reply, fault);
    }
    iso_progress_end(progress);
    return exit;
}
