/* One step of a run of test_faults.c. The sensor exposes frames (fault_sensor.c), the appliance
 * ends, starts and works (fault_appliance.c), and clients call it (fault_clients.c). Each part
 * reports to the oracle what the oracle has to know. */
#ifndef TESTS_FIRMWARE_FAULTS_FAULT_STEP_H
#define TESTS_FIRMWARE_FAULTS_FAULT_STEP_H

#include "tests/firmware/faults/fault_world.h"

/* The number of each actor's face in tests/firmware/rigs/puppets.h; 0: no usable face. */
extern const int actor_faces[ACTORS];

/* Exposes one frame, changed by the faults of this step. */
void world_expose(struct world *w);

/* Ends the appliance and closes its stores. */
void world_end_appliance(struct world *w);

/* Opens the stores and starts the appliance, as the daemon does. If an error keeps it from
 * starting, w->running stays false, and the next step tries again. */
void world_begin_appliance(struct world *w);

/* Advances the time by one frame and lets the appliance work, with the memory that the faults of
 * this step leave it. */
void world_pass_frame(struct world *w);

/* A client may claim the appliance, release it, or administer it. The random numbers of the run
 * decide. */
void world_ask(struct world *w);

/* Releases the claim of the client. */
void world_release_claim(struct world *w);

#endif
