/* The acts of an administrator: renames people, limits the time of their access, changes their
 * credentials and the policy, copies people from door to door, rotates keys, tests the relay,
 * changes settings, takes back what people have taught the metric, checks a door before it goes
 * into service. Each act is recorded before it is done. Its result is recorded after it. */
#ifndef ISO_FIRMWARE_APPLIANCE_ADMINISTRATION_ADMINISTRATION_H
#define ISO_FIRMWARE_APPLIANCE_ADMINISTRATION_ADMINISTRATION_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "firmware/appliance/appliance.h"
#include "firmware/settings/live_settings.h"
#include "firmware/transfer/transfer.h"

struct iso_fleet;

/* Errors of all these functions: -EBUSY while an action of a client goes on, or an error of the log
 * if the act could not be recorded; then nothing was done.  */

/* Unlocks the door for ISO_DOOR_TEST_MS, so that the installer hears the relay click. Besides this
 * function, the identification at the door and the exit button unlock the door. -EBUSY a client has
 * the camera, or the door is not locked; -EPERM lockdown or lock-out; -ENODEV the door has no
 * relay, or its lines do not work. */
int iso_appliance_test_door(struct iso_appliance *appliance, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Lets the access panel open a secure channel with the default key and set a key of its own, for
 * two minutes (osdp_peripheral.h). It may be called at any time. -ENODEV no panel is configured, or
 * an error of the log; then nothing was done. */
int iso_appliance_install_panel(struct iso_appliance *appliance, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* An item of the checks of a door before it goes into service, as RecordCommission has it
 * (contract.h). */
struct iso_commission_item {
    const char *item;   /* its word */
    const char *answer; /* a word ISO_CONTRACT_ANSWER_... */
    const char *remark; /* "": none */
};

struct iso_commission {
    const char *by;  /* the name of who checked */
    const char *who; /* describes the user who asks */
    const struct iso_commission_item *items;
    size_t n;
};

/* Puts the items on record, and after them the outcome, which follows from the answers: *outcome is
 * a word ISO_CONTRACT_COMMISSION_..., a constant, and *sequence the number of its record. -EINVAL
 * there is no item, or an answer is none of the words: nothing is recorded. Errors of the log: the
 * outcome is not on record, but items may be. (commission.c) */
int iso_appliance_record_commission(struct iso_appliance *appliance,
                                    const struct iso_commission *commission, const char **outcome,
                                    uint64_t *sequence, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Writes people to an open, empty file: those of a list that NULL ends, or all if the list is NULL
 * or empty. *n is then their number. -EINVAL it is not a file, or not empty; also the errors of
 * iso_transfer_write and of writing. */
int iso_appliance_export(struct iso_appliance *appliance, int fd, const char *const *people,
                         const struct iso_transfer_lock *lock,
                         const struct iso_work_listener *listener, size_t *n,
                         struct iso_fault *fault) __attribute__((warn_unused_result));

struct iso_import_request {
    int fd;                         /* an open file */
    const struct iso_seal_key *key; /* the key of the passphrase; NULL: there is none */
    const char *sender;             /* the address that has to have signed the file; NULL: any */
    bool replace;                   /* replaces people who are known here */
    const struct iso_work_listener *listener;
};

/* Adds people from a file. *added is the number of people who were added or replaced. *known is the
 * number of the others: they were known here already, and stay as they are. Errors of
 * iso_transfer_read, iso_gallery_import and of reading; then nobody was added. */
int iso_appliance_import(struct iso_appliance *appliance, const struct iso_import_request *request,
                         size_t *added, size_t *known, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Gives a person another name and records both names. *remark says what else contains the old name
 * (the file of card numbers), or is "". -ENOENT, -EINVAL a bad name, -EEXIST another person has it,
 * or an error of the gallery; then nothing has changed. */
int iso_appliance_rename(struct iso_appliance *appliance, const char *person, const char *name,
                         const char **remark, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Changes from when and until when the door opens to a person, and records the limits before and
 * after. -ENOENT, -EINVAL limits that make no sense (validity.h), or an error of the gallery; then
 * nothing has changed. */
int iso_appliance_set_validity(struct iso_appliance *appliance, const char *person,
                               const struct iso_validity_change *change, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* A setting that is to be changed while the daemon runs. */
struct iso_setting_request {
    const char *section, *key;
    const char *value; /* in the form of the configuration file; NULL: as that file has it */
    const char *who;   /* describes the user who asks, for the record */
};

/* Changes a setting, records the values before and after, and keeps the change over a restart. The
 * change holds at once; a visit that goes on begins anew. *value is then the value in force.
 * -EINVAL a key that cannot be changed, a bad value, or one that contradicts other settings; or an
 * error of the disk; then nothing has changed. -ENOSYS the appliance has no such settings.
 * (appliance_settings.c) */
int iso_appliance_set_setting(struct iso_appliance *appliance,
                              const struct iso_setting_request *request,
                              char value[ISO_LIVE_VALUE_SIZE], struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Excludes templates, so that the metric no longer learns from them: all that are enrolled now, or
 * those of the last enrolment that is not excluded (iso_gallery_reset_site()). `who` describes the
 * user who asks, for the record. *n is the number of templates that this call has excluded; 0:
 * nothing has changed. -EINVAL if the metric does not adapt, or an error of the gallery; then
 * nothing has changed. (site.c) */
int iso_appliance_reset_site(struct iso_appliance *appliance, const char *who, size_t *n,
                             struct iso_fault *fault) __attribute__((warn_unused_result));
int iso_appliance_roll_back_site(struct iso_appliance *appliance, const char *who, size_t *n,
                                 struct iso_fault *fault) __attribute__((warn_unused_result));

/* Seals the gallery, the anchors, the lock-out file and the changed settings with new keys, and
 * drops the old ones. The log goes on with a new key; its closed segments keep the old key, which
 * is dropped when the last of them is deleted. Then gives the ring another key of the appliance,
 * unless that key is a credential of the system; *remark says so then, else it is "". After an
 * error some of the keys may be new. */
int iso_appliance_rotate_keys(struct iso_appliance *appliance,
                              const struct iso_work_listener *listener, const char **remark,
                              struct iso_fault *fault) __attribute__((warn_unused_result));

/* ---- the policy (policy.c) ---- */

/* Stores a policy in place of the one of revision `based_on` (0: there is none), and uses it at
 * once; "" removes it. `who` describes the user who asks, for the record. Each record of the policy
 * that changes is put on record before it is done, with its text before and after. *revision is
 * that of the new policy. -ECANCELED another revision is stored, -EINVAL the document is refused
 * (iso_site_access_prepare()), -EFBIG; or an error of the gallery; then nothing has changed. */
int iso_appliance_set_policy(struct iso_appliance *appliance, const char *json, uint64_t based_on,
                             const char *who, uint64_t *revision, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Changes a person's credential by a patch (credential_json.h), and records its text before and
 * after, without PINs. -ENOENT, -EINVAL the patch is refused, -EEXIST somebody else has one of the
 * cards, or an error of the gallery; then nothing has changed. */
int iso_appliance_set_credential(struct iso_appliance *appliance, const char *person,
                                 const char *patch, const char *who, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The policy and what it would decide. Nothing is recorded. */
struct iso_site_access *iso_appliance_access(const struct iso_appliance *appliance);

/* The fleet (firmware/fleet/door/fleet.h), of which somebody at the door may change nothing but
 * that it is joined and left. NULL while the gallery could not be read yet. (fleet.c) */
struct iso_fleet *iso_appliance_fleet(const struct iso_appliance *appliance);

/* The date by which the policy decides, and whether it is known. */
int64_t iso_appliance_date_s(const struct iso_appliance *appliance, bool *known);

#endif
