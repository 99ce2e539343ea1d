/* One door of a fleet for the check of a whole fleet: the appliance of the daemon with its stores
 * on the disk, its part of the fleet, and the link that carries its messages. The camera and the
 * recognition are puppets (tests/firmware/rigs/puppets.h): a face is a number. Everything else is
 * the code of the product, and the clock is that of the machine. Many doors live in one process. */
#ifndef TESTS_FLEET_CHECK_DOOR_H
#define TESTS_FLEET_CHECK_DOOR_H

#include <systemd/sd-event.h>

#include "firmware/fleet/door/fleet.h"
#include "firmware/fleet/link/link.h"
#include "firmware/transfer/transfer.h"

struct check_door;

struct check_door_setup {
    sd_event *event;
    struct link_http *http;
    const char *folder; /* of this door; it is made if it is missing */
};

/* Opens the stores and starts the appliance. If the folder holds the files of a member
 * (link_files), the link starts, too. A failure ends the program with a line. */
struct check_door *check_door_new(const struct check_door_setup *setup);

/* Closes all of it in order. */
void check_door_free(struct check_door *door);

/* Lets the appliance do what is due; called every few milliseconds. */
void check_door_step(struct check_door *door);

/* The address of the appliance, for joining. */
void check_door_address(const struct check_door *door, char address[ISO_TRANSFER_ADDRESS_SIZE]);

/* Joins the fleet with the membership in a file, and starts the link. Writes "ok" or a fault. */
void check_door_join(struct check_door *door, const char *path, char *answer, size_t size);

/* Stops the link and the updates of a door that has joined, and starts them again if they shall
 * run. */
void check_door_link(struct check_door *door, bool runs);

/* Writes how far the door is with an update (check_update_describe()); "none": the link does not
 * run. */
void check_door_update(const struct check_door *door, char *answer, size_t size);

/* Shows usable frames of a face at n doors, one after the other person has left, and steps the
 * doors until each visit has a verdict, at most three seconds. check_door_answer() then is "allow
 * NAME", "deny REASON" or "nothing". */
void check_doors_show(struct check_door *const doors[], int n, int face);
const char *check_door_answer(const struct check_door *door);

/* Enrols somebody at the door, as an enrolment there would. Writes "" or a fault. */
void check_door_enrol(struct check_door *door, const char *name, int face, char *answer,
                      size_t size);

/* Moves the clock that runs since the boot of this door forward. */
void check_door_advance(struct check_door *door, int64_t seconds);

/* Writes one line: phase of the link, people, digest of the people with their revisions, lease, and
 * for each zone epoch, sequence and the first digits of its digest. */
void check_door_describe(struct check_door *door, char *answer, size_t size);

#endif
