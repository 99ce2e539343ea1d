#include <sodium.h>
#include <time.h>

#include "firmware/fleet/link/link_inner.h"

uint64_t link_now_us(const struct link_door *door)
{
    uint64_t now = 0;

    (void)sd_event_now(door->event, CLOCK_BOOTTIME, &now);
    return now;
}

void link_rearm(struct link_door *door)
{
    uint64_t next = 0;

    for (int i = 0; i < LINK_DUES; i++) {
        if (door->due_us[i] && (!next || door->due_us[i] < next)) {
            next = door->due_us[i];
        }
    }
    if (next) {
        (void)sd_event_source_set_time(door->timer, next);
    }
    (void)sd_event_source_set_enabled(door->timer, next ? SD_EVENT_ONESHOT : SD_EVENT_OFF);
}

void link_at(struct link_door *door, enum link_due due, uint64_t at_us)
{
    if (!door->due_us[due] || at_us < door->due_us[due]) {
        door->due_us[due] = at_us ? at_us : 1;
        link_rearm(door);
    }
}

void link_in(struct link_door *door, enum link_due due, uint64_t delay_us)
{
    link_at(door, due, link_now_us(door) + delay_us);
}

void link_never(struct link_door *door, enum link_due due)
{
    if (door->due_us[due]) {
        door->due_us[due] = 0;
        link_rearm(door);
    }
}

uint64_t link_random(void)
{
    uint64_t random = 0;

    randombytes_buf(&random, sizeof random);
    return random;
}
