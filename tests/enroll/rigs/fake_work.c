#include "tests/enroll/rigs/fake_work.h"

#include <string.h>
#include <time.h>

#include "firmware/contract/contract.h"

static void pause_ms(unsigned ms)
{
    const struct timespec pause = {ms / 1000, (long)(ms % 1000) * 1000000};

    (void)nanosleep(&pause, NULL);
}

static int send_progress(sd_bus_message *call, const struct fake_progress *progress)
{
    sd_bus_message *signal = NULL;
    int r = sd_bus_message_new_signal(sd_bus_message_get_bus(call), &signal, ISO_CONTRACT_PATH,
                                      ISO_CONTRACT_INTERFACE, ISO_CONTRACT_PROGRESS);

    pause_ms(progress->after_ms);
    if (r >= 0) {
        r = sd_bus_message_append(signal, "tt", progress->done, progress->total);
    }
    if (r >= 0) {
        r = sd_bus_send_to(NULL, signal, sd_bus_message_get_sender(call), NULL);
    }
    sd_bus_message_unref(signal);
    return r;
}

static int answer(sd_bus_message *call)
{
    const char *method = sd_bus_message_get_member(call);

    if (strcmp(method, ISO_CONTRACT_EXPORT_PEOPLE) == 0) {
        return sd_bus_reply_method_return(call, "u", 2);
    }
    if (strcmp(method, ISO_CONTRACT_IMPORT_PEOPLE) == 0) {
        return sd_bus_reply_method_return(call, "uu", 2, 0);
    }
    if (strcmp(method, ISO_CONTRACT_ROTATE_KEYS) == 0) {
        return sd_bus_reply_method_return(call, "s", "");
    }
    return sd_bus_reply_method_return(call, "bttsts", 1, UINT64_C(1), UINT64_C(100), "ab",
                                      UINT64_C(0), "");
}

int fake_work(sd_bus_message *call, const struct fake_script *script)
{
    int r = 0;

    for (size_t i = 0; r >= 0 && i < script->n_progress; i++) {
        r = send_progress(call, &script->progress[i]);
    }
    pause_ms(script->answer_ms);
    return r < 0 ? r : answer(call);
}
