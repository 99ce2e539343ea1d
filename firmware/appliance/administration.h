/* What an administrator does to an appliance: renames people, limits their time, copies them from
 * door to door, rotates keys, tests the relay. Each act is put on record before it is done, and
 * its result after it. */
#ifndef ISO_FIRMWARE_APPLIANCE_ADMINISTRATION_H
#define ISO_FIRMWARE_APPLIANCE_ADMINISTRATION_H

#include <stdbool.h>
#include <stddef.h>

#include "firmware/appliance/appliance.h"
#include "firmware/gallery/transfer.h"

/* Common to all: -EBUSY an action of a client goes on; an error of the log, when it could not be
 * put on record: then nothing was done. */

/* Unlocks the door for ISO_DOOR_TEST_MS, so that the installer hears the relay click. Only this,
 * the identification at the door and the exit button unlock the door. -EBUSY a client has the
 * camera, or the door is not locked; -EPERM lockdown or lock-out; -ENODEV the door has no relay,
 * or its lines do not work. */
int iso_appliance_test_door(struct iso_appliance *appliance, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Writes people (NULL, or an empty list: all; NULL ends it) to an open, empty file. -EINVAL it is
 * not a file, or not empty; the errors of iso_transfer_write and of writing. */
int iso_appliance_export(struct iso_appliance *appliance, int fd, const char *const *people,
                         const struct iso_transfer_lock *lock,
                         const struct iso_work_listener *listener, size_t *n,
                         struct iso_fault *fault) __attribute__((warn_unused_result));

struct iso_import_request {
    int fd;                         /* an open file */
    const struct iso_seal_key *key; /* of the passphrase; NULL: there is none */
    const char *sender;             /* address that has to have signed it; NULL: any */
    bool replace;                   /* people who are known here */
    const struct iso_work_listener *listener;
};

/* Adds people from a file. *known is how many of them were known here already and stay as they
 * are. Errors of iso_transfer_read, iso_gallery_import and of reading; then nobody was added. */
int iso_appliance_import(struct iso_appliance *appliance, const struct iso_import_request *request,
                         size_t *added, size_t *known, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Gives a person another name; both are on record. *remark says what else names the person (the
 * file of card numbers), else it is "". -ENOENT, -EINVAL a bad name, -EEXIST somebody else has it,
 * or an error of the gallery: then nothing has changed. */
int iso_appliance_rename(struct iso_appliance *appliance, const char *person, const char *name,
                         const char **remark, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Changes from when and until when the door opens to a person; the limits before and after are on
 * record. -ENOENT, -EINVAL limits that make no sense (validity.h), or an error of the gallery: then
 * nothing has changed. */
int iso_appliance_set_validity(struct iso_appliance *appliance, const char *person,
                               const struct iso_validity_change *change, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Seals gallery, log and anchors with new keys and drops the old ones; then gives the ring another
 * key of the appliance, if that is not a credential of the system (*remark says so; else ""). */
int iso_appliance_rotate_keys(struct iso_appliance *appliance,
                              const struct iso_work_listener *listener, const char **remark,
                              struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
