/* The acts of a hub, for storage_acts.c: the door has one zone, and gets one change of it. */
#ifndef TESTS_FIRMWARE_FAULTS_STORAGE_FLEET_H
#define TESTS_FIRMWARE_FAULTS_STORAGE_FLEET_H

#include "tests/firmware/faults/storage_acts.h"

/* Starts an appliance at which anna and bob are enrolled. (storage_acts.c) */
void storage_prepare_two(struct storage_world *w);

/* The same at a door of a fleet, which is to put carl, to remove dora, or to take a policy. */
void storage_prepare_put(struct storage_world *w);
void storage_prepare_remove(struct storage_world *w);
void storage_prepare_hub_policy(struct storage_world *w);

/* The door gets the change. */
int storage_hear(struct storage_world *w, struct iso_fault *fault);

/* Appends the place of the zone, " place 1", so that people and place are judged together; nothing
 * without a fleet. Returns the length. */
size_t storage_place(const struct iso_gallery *gallery, char *text, size_t size);

#endif
