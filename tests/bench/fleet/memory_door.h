/* One simulated door: the fleet's part of the daemon (firmware/fleet/door) on a store in memory,
 * and the link (firmware/fleet/link). What is real: every message is received over the broker by
 * TLS with the door's own certificate, verified, opened, applied and answered, and fetches go over
 * HTTPS. What is simulated: the appliance around it, the disk and the log. The records of the log
 * are made when the link reads them. */
#ifndef TESTS_BENCH_FLEET_MEMORY_DOOR_H
#define TESTS_BENCH_FLEET_MEMORY_DOOR_H

#include <systemd/sd-event.h>

#include "firmware/fleet/link/link.h"
#include "tests/bench/fleet/fleet_table.h"

struct memory_door;

struct memory_door_setup {
    sd_event *event;
    struct link_http *http;
    struct link_broker broker; /* with the files of this door */
    const char *hub_url;
    struct fleet_table_door *row; /* outlives the door */
};

/* Makes a door that has joined. A failure ends the program with a line. */
struct memory_door *memory_door_new(const struct memory_door_setup *setup);
void memory_door_free(struct memory_door *door);

/* What the daemon does with time: tells the link what waits. Called twice a second; also tells the
 * row of the door what its link does. `visits`: records of visits that the door shall have made. */
void memory_door_step(struct memory_door *door, uint64_t visits);

#endif
