#include "firmware/config/door_options.h"

struct iso_door_guard_options iso_door_options_of(const struct iso_config_door *config,
                                                  const struct iso_times *times,
                                                  struct iso_door_io *io, bool threaded)
{
    return (struct iso_door_guard_options){
        .door =
            {
                .fail = config->fail,
                .unlock_ns = config->unlock_ms * ISO_NS_PER_MS,
                .held_ns = config->held_ms * ISO_NS_PER_MS,
                .refused_ns = config->refused_ms * ISO_NS_PER_MS,
                .pulse_ns = config->relay_pulse_ms * ISO_NS_PER_MS,
            },
        .timing =
            {
                .poll_ns = config->poll_ms * ISO_NS_PER_MS,
                .retry_ns = config->retry_ms * ISO_NS_PER_MS,
                .retry_max_ns = config->retry_max_ms * ISO_NS_PER_MS,
            },
        .clock = times->boottime.now_ns ? times->boottime : times->monotonic,
        .io = io,
        .threaded = threaded,
    };
}
