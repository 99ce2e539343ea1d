/* Reports the progress of a long call to the client that made it. */
#include "firmware/bus/bus_state.h"
#include "firmware/contract/contract.h"

/* The time between two signals, and before the first one. A call that takes less time sends no
 * signal. */
static const int64_t interval_ns = 500 * ISO_NS_PER_MS;

/* sd_bus_send() writes what the socket takes at once and queues the rest, so it never waits. */
static void on_step(void *context, uint64_t done, uint64_t total)
{
    struct iso__bus_progress *progress = context;
    const int64_t now_ns = iso_times_now_ns(&progress->bus->borrowed->times);
    sd_bus_message *signal = NULL;
    if (now_ns - progress->sent_ns < interval_ns) {
        return;
    }
    progress->sent_ns = now_ns;
    int r = iso__bus_new_signal(progress->bus, ISO_CONTRACT_PROGRESS, &signal);
    if (r >= 0) {
        r = sd_bus_message_append(signal, "tt", done, total);
    }
    iso__bus_send_signal(signal, progress->caller, r);
}

struct iso_work_listener iso__bus_report_progress(struct iso__bus_progress *progress,
                                                  const struct iso_bus *bus, sd_bus_message *call)
{
    *progress = (struct iso__bus_progress){
        .bus = bus,
        .caller = sd_bus_message_get_sender(call),
        .sent_ns = iso_times_now_ns(&bus->borrowed->times),
    };
    return (struct iso_work_listener){on_step, progress};
}
