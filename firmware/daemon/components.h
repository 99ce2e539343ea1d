/* What a configuration asks for, opened: everything that an appliance borrows. */
#ifndef ISO_FIRMWARE_DAEMON_COMPONENTS_H
#define ISO_FIRMWARE_DAEMON_COMPONENTS_H

#include <stdio.h>

#include "core/base/fault.h"
#include "firmware/appliance/appliance.h"
#include "firmware/audit/journal.h"
#include "firmware/door/door_guard.h"

struct iso_components {
    struct iso_config config;
    struct iso_times times;
    struct iso_pipeline pipeline;
    struct iso_key_ring *ring;
    struct iso_gallery *gallery;
    struct iso_journal *journal;       /* NULL: the log is not told there */
    struct iso_state_counter *counter; /* NULL: none is configured, or it is not open yet */
    struct iso_audit *audit;
    struct iso_door_io *door_io;
    struct iso_door_guard *door; /* works already; NULL without threads */
    bool threads;                /* iso_appliance_borrowed.threads */
    struct iso_cards *cards;     /* NULL: none are sent */
    char lockout_path[ISO_CONFIG_TEXT_SIZE + 8];
};

/* Loads the modules (drivers/base/module.h) that the configuration asks for, so that nothing is
 * loaded later, when the process is confined. -ENOENT an unknown sensor, or a module is missing
 * that the sensor needs; -EBADMSG one cannot be used. That of the image check may be missing,
 * unless the configuration names a cascade (iso_pipeline_open). */
int iso_components_load_modules(const struct iso_config *config, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Whether a start with this configuration would find everything that it needs apart from devices:
 * does what iso_components_open does first, and lets it go. Sensor and door options are checked,
 * the directories of the stores have to exist, model files and cards are loaded; nothing is written
 * and no device is touched. A device that is missing is no fault here, since the daemon waits for
 * it. The installed state directory may be missing: the service manager makes it at the start. The
 * errors of iso_sensor_check, iso_door_io_check, iso_pipeline_open and
 * iso_cards_load; -ENOENT there is no such directory. */
int iso_components_check(const struct iso_config *config, const struct iso_times *times,
                         struct iso_fault *fault) __attribute__((warn_unused_result));

/* Opens them: first what is only read, then the door's lines, then the stores. With `threads` the
 * door is put to work as soon as its lines are open, so that the exit button does not wait for a
 * slow disk: the door is locked then, and nobody is let in before there is an appliance. Every
 * error of iso_components_check, iso_pipeline_open, iso_key_ring_open,
 * iso_gallery_open, iso_audit_open, iso_cards_load, iso_door_io_open and iso_door_guard_start, with
 * nothing left open and the door's lines without power; -ESTALE if one of the stores is of an
 * earlier time than another knows (heads.h). But with -ENODEV, -EBUSY, -EACCES or -EIO of the door
 * its lines are lost and may come back. What `times` points to must outlive the components. */
int iso_components_open(const struct iso_config *config, const struct iso_times *times,
                        bool threads, struct iso_components **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Components of which nothing is open yet. NULL for want of memory; iso_components_close ends it.
 */
struct iso_components *iso_components_new(const struct iso_config *config,
                                          const struct iso_times *times);

/* Whether the directories of the stores exist: -ENOENT, -EACCES. (components_stores.c) */
int iso_components_check_places(const struct iso_config *config, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Whether the configuration of the counter of the state (state_counter.h) is sound; touches no
 * device. -EINVAL. (components_counter.c) */
int iso_components_check_counter(const struct iso_config *config, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Opens that counter, if one is configured and components->counter is NULL. The errors of
 * iso_components_check_counter and iso_tpm2_counter_open, -ENOMEM. (components_counter.c) */
int iso_components_open_counter(struct iso_components *components, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Begins to count, when the stores have been compared and everything else is open, before anybody
 * is let in: raises the number in the log's anchor and the counter. threaded: a thread does the
 * later increments. Does nothing without a counter. The errors of iso_state_counter_begin,
 * iso_state_counter_start_thread and iso_audit_renew_anchor; what the device refuses then. */
int iso_components_begin_counter(struct iso_components *components, bool threaded,
                                 struct iso_fault *fault) __attribute__((warn_unused_result));

/* Opens key ring, gallery and log of components whose config, times and pipeline are set, looks at
 * the lock-out file, and compares what they know of each other, and with the counter: a part of
 * iso_components_open. -ESTALE one of them is of an earlier time than another knows, or all of them
 * are of an earlier time than the counter; else the errors of iso_components_open_counter,
 * iso_key_ring_open, iso_gallery_open and iso_audit_open. What is open then is for
 * iso_components_close.
 */
int iso_components_open_stores(struct iso_components *components, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The two halves of it. */
int iso_components_open_each_store(struct iso_components *components, struct iso_fault *fault)
    __attribute__((warn_unused_result));
int iso_components_compare_stores(const struct iso_components *components, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Opens the stores as iso_components_open_stores does, but accepts stores that are of different
 * times. It then writes the record "state-accepted" into the log, and writes every store again;
 * from then on the stores agree. A lock-out file that cannot be used becomes a lockdown. *why says
 * what was accepted; it is "" if the stores agreed already. Returns the errors of opening and
 * writing the stores. */
int iso_components_accept_stores(struct iso_components *components, struct iso_fault *why,
                                 struct iso_fault *fault) __attribute__((warn_unused_result));

/* The same with a configuration alone, for when no daemon runs; says on `out` what it did. */
int iso_components_accept(const struct iso_config *config, const struct iso_times *times, FILE *out,
                          struct iso_fault *fault) __attribute__((warn_unused_result));

/* Puts the door's lines to where they rest without power and lets them go: for after a process that
 * may have left them otherwise. The errors of iso_door_io_open. */
int iso_components_rest_door(const struct iso_config *config, const struct iso_times *times,
                             struct iso_fault *fault) __attribute__((warn_unused_result));

/* Opens the log alone, writes its records to `out`, a line each, and says whether it is sound: for
 * when no daemon runs. -EBADMSG with a fault if it is not, the errors of iso_key_ring_open and
 * iso_audit_open. */
int iso_components_print_log(const struct iso_config *config, const struct iso_times *times,
                             FILE *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* NULL is fine. */
void iso_components_close(struct iso_components *components);

/* Lent to an appliance; the sensor is opened from the configuration when it is needed. */
struct iso_appliance_borrowed iso_components_lend(struct iso_components *components,
                                                  const struct iso_appliance_events *events);

#endif
