/* What happens in a step of a run of test_faults.c: the sensor exposes frames (fault_sensor.c), the
 * appliance ends, begins and works (fault_appliance.c), and clients ask it (fault_clients.c). Each
 * of them tells the oracle of the world what it has to know. */
#ifndef TESTS_FIRMWARE_FAULTS_FAULT_STEP_H
#define TESTS_FIRMWARE_FAULTS_FAULT_STEP_H

#include "tests/firmware/faults/fault_world.h"

/* The number of the face of each actor in tests/firmware/rigs/puppets.h; 0: no face that is known.
 */
extern const int actor_faces[ACTORS];

/* Exposes one frame, as the faults of this step would have it. */
void world_expose(struct world *w);

/* Ends the appliance and closes its stores. */
void world_end_appliance(struct world *w);

/* Opens the stores and starts the appliance, as the daemon does. If an error keeps it from
 * starting, w->running stays false, and the next step tries again. */
void world_begin_appliance(struct world *w);

/* Lets the time of a frame pass, with memory as the faults of this step would have it. */
void world_pass_frame(struct world *w);

/* Clients may claim the appliance, let it go, or administer it. */
void world_ask(struct world *w);

/* The client that has the claim lets it go. */
void world_release_claim(struct world *w);

#endif
