/* What the tests of outlets share: doors with events, and a process of its own that runs the
 * outlets, so that it can be killed. Failures fail the running cmocka test. */
#ifndef TESTS_ENROLL_HUB_OUTLET_OUTLET_RIG_H
#define TESTS_ENROLL_HUB_OUTLET_OUTLET_RIG_H

#include "enroll/hub/outlet/hub_outlet.h"
#include "tests/enroll/hub/rigs/store_rig.h"

/* The first lines of main(): in the process that runs the outlets it does so, and never returns. */
void outlet_rig_main(int argc, char **argv);

/* Starts the process, with its lines in the file `log`. */
pid_t outlet_rig_run(const struct store_rig *rig, const char *log);
void outlet_rig_kill(pid_t pid); /* SIGKILL */
void outlet_rig_end(pid_t pid);  /* SIGTERM; fails if it does not end within three seconds */

/* Adds a door that is in no zone's stream; it has no events yet. */
struct iso_fleet_id outlet_rig_door(struct store_rig *rig, const char *name);

/* Stores the events `from` to `to` of a door as the hub does that takes them from it. */
void outlet_rig_events(struct store_rig *rig, const struct iso_fleet_id *door, uint64_t from,
                       uint64_t to, const char *event);

/* The outlet of this name. */
struct hub_outlet outlet_rig_outlet(struct store_rig *rig, const char *name);

/* Waits until the outlet has nothing to hand over. */
void outlet_rig_wait_idle(struct store_rig *rig, const char *name, double seconds);

#endif
