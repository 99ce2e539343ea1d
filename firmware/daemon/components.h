/* Everything that an appliance borrows, opened as the configuration says. */
#ifndef ISO_FIRMWARE_DAEMON_COMPONENTS_H
#define ISO_FIRMWARE_DAEMON_COMPONENTS_H

#include <stdio.h>

#include "core/base/fault.h"
#include "firmware/appliance/appliance.h"
#include "firmware/audit/journal.h"
#include "firmware/door/door_guard.h"
#include "firmware/panel/panel.h"

struct iso_components {
    struct iso_config config;
    struct iso_times times;
    struct iso_pipeline pipeline;
    struct iso_key_ring *ring;
    struct iso_gallery *gallery;
    struct iso_journal *journal;       /* NULL: the log does not go to the journal */
    struct iso_state_counter *counter; /* NULL: no counter is configured, or it is not open yet */
    struct iso_audit *audit;
    struct iso_door_io *door_io;
    struct iso_door_guard *door;   /* already started; NULL without threads */
    bool threads;                  /* iso_appliance_borrowed.threads */
    struct iso_cards *cards;       /* NULL: no card numbers are sent */
    struct iso_wiegand_in *reader; /* of cards and keys, on Wiegand lines; NULL: there is none */
    struct iso_osdp_reader_port *osdp_reader; /* the same over OSDP; not both */
    struct iso_panel *panel; /* NULL: no access panel is configured, or there are no threads */
    char lockout_path[ISO_CONFIG_TEXT_SIZE + 8];
    struct iso_live_settings settings; /* changes of config */
    char settings_path[ISO_CONFIG_TEXT_SIZE + 10];
};

/* Loads the modules (drivers/base/module.h) that the configuration needs, because nothing can be
 * loaded later, when the process is confined. -ENOENT an unknown sensor, or the sensor needs a
 * module that is missing; -EBADMSG a module cannot be used. The module of the image check may be
 * missing, unless the configuration names a cascade (iso_pipeline_open). */
int iso_components_load_modules(const struct iso_config *config, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Whether a start with this configuration would find everything that it needs apart from devices.
 * Does the first steps of iso_components_open, and releases everything. Sensor and door options are
 * checked, the directories of the stores have to exist, model files and cards are loaded; nothing
 * is written and no device is used. A missing device is not a fault here, since the daemon waits
 * for it. The installed state directory may be missing, because the service manager makes it at the
 * start. The errors of iso_sensor_check, iso_door_io_check, iso_pipeline_open and iso_cards_load;
 * -ENOENT a directory does not exist. */
int iso_components_check(const struct iso_config *config, const struct iso_times *times,
                         struct iso_fault *fault) __attribute__((warn_unused_result));

/* Opens the components: first those that are only read, then the door's lines, then the stores.
 * With `threads` the door starts as soon as its lines are open, so that the exit button does not
 * wait for a slow disk. The door is locked then, and nobody is let in before there is an appliance.
 * Errors: those of iso_components_check, iso_key_ring_open, iso_gallery_open, iso_audit_open,
 * iso_door_io_open, iso_door_guard_start and iso_panel_open; -ESTALE if one of the stores is of an
 * earlier time than another store knows (heads.h). After an error nothing is open, and the door's
 * lines are without power. But -ENODEV, -EBUSY, -EACCES and -EIO of opening the door's lines are no
 * errors here: the lines count as lost and may come back. What `times` points to must outlive the
 * components. */
int iso_components_open(const struct iso_config *config, const struct iso_times *times,
                        bool threads, struct iso_components **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Makes components of which nothing is open yet. NULL if there is no memory. iso_components_close
 * frees them. */
struct iso_components *iso_components_new(const struct iso_config *config,
                                          const struct iso_times *times);

/* Opens the pipeline of components whose config and times are set. The errors of
 * iso_pipeline_open. iso_components_close closes it. */
int iso_components_open_pipeline(struct iso_components *components, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The length of the directory part of a path, with its last slash. 0: the working directory.
 * Internal to firmware/daemon. (components_stores.c) */
size_t iso__components_directory_length(const char *path);

/* Whether the directories of the stores exist: -ENOENT, -EACCES. (components_stores.c) */
int iso_components_check_places(const struct iso_config *config, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Checks the configuration of the counter of the state (state_counter.h); uses no device. -EINVAL.
 * (components_counter.c) */
int iso_components_check_counter(const struct iso_config *config, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Opens that counter if one is configured and components->counter is NULL. The errors of
 * iso_components_check_counter and iso_tpm2_counter_open, -ENOMEM. (components_counter.c) */
int iso_components_open_counter(struct iso_components *components, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Opens the access panel if one is configured, once the stores are open. The errors of
 * iso_panel_open. (components_stores.c) */
int iso_components_open_panel(struct iso_components *components, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The card reader: checks how its lines are wired, or its key; opens it, which a missing chip or
 * serial line does not prevent; closes it; lends it. -EINVAL, -ENOENT a line is configured and
 * there is no libgpiod, -EAGAIN no thread, and the errors of iso_reader_key_read.
 * (components_reader.c) */
int iso_components_check_reader(const struct iso_config *config, struct iso_fault *fault)
    __attribute__((warn_unused_result));
int iso_components_open_reader(struct iso_components *components, struct iso_fault *fault)
    __attribute__((warn_unused_result));
void iso_components_close_reader(struct iso_components *components);
struct iso_card_source iso_components_card_source(const struct iso_components *components);

/* Begins to count, when the stores have been compared and everything else is open, before anybody
 * is let in: raises the number in the log's anchor, and the counter. threaded: a thread does the
 * later increments. Does nothing without a counter. The errors of iso_state_counter_begin,
 * iso_state_counter_start_thread and iso_audit_renew_anchor, and an error of the device. */
int iso_components_begin_counter(struct iso_components *components, bool threaded,
                                 struct iso_fault *fault) __attribute__((warn_unused_result));

/* A part of iso_components_open. Opens key ring, gallery and log of components whose config, times
 * and pipeline are set, and reads the lock-out file. Then compares what the stores know of each
 * other, and compares them with the counter. -ESTALE one of them is of an earlier time than another
 * knows, or all of them are of an earlier time than the counter; else the errors of
 * iso_components_open_counter, iso_key_ring_open, iso_gallery_open and iso_audit_open.
 * iso_components_close closes what is open then. */
int iso_components_open_stores(struct iso_components *components, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The two halves of iso_components_open_stores. */
int iso_components_open_each_store(struct iso_components *components, struct iso_fault *fault)
    __attribute__((warn_unused_result));
int iso_components_compare_stores(const struct iso_components *components, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Opens the stores as iso_components_open_stores does, but accepts stores that are of different
 * times. It then writes every store again, and a record "state-accepted" into the log before and
 * after that; from then on the stores agree. A lock-out file that cannot be used becomes a
 * lockdown. *why says what was accepted; it is "" if the stores agreed already. Returns the errors
 * of opening and writing the stores. */
int iso_components_accept_stores(struct iso_components *components, struct iso_fault *why,
                                 struct iso_fault *fault) __attribute__((warn_unused_result));

/* The same with a configuration alone, while no daemon runs. Prints on `out` what it did. */
int iso_components_accept(const struct iso_config *config, const struct iso_times *times, FILE *out,
                          struct iso_fault *fault) __attribute__((warn_unused_result));

/* Puts the door's lines into their state without power, and releases them. Used after a process
 * that may have left them in another state. The errors of iso_door_io_open. */
int iso_components_rest_door(const struct iso_config *config, const struct iso_times *times,
                             struct iso_fault *fault) __attribute__((warn_unused_result));

/* Opens the key ring and the log alone, while no daemon runs. Checks the whole log, and then writes
 * its records to `out`, one in a line. -EBADMSG with a fault if the log is not sound; then nothing
 * is written. -EIO; the errors of iso_key_ring_open and iso_audit_open. */
int iso_components_print_log(const struct iso_config *config, const struct iso_times *times,
                             FILE *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* ---- the factory reset (components_reset.c; firmware/reset/reset.h) ---- */

/* Returns 0 unless a reset was begun and is not finished: then -EBUSY, and nothing may be opened.
 */
int iso_components_check_reset(const struct iso_config *config, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* With a counter of the state: whether the appliance was reset since the counter has begun; and no
 * longer. */
bool iso_components_was_reset(const struct iso_config *config);
void iso_components_forget_reset(const struct iso_config *config);

/* Resets the appliance. No daemon may run. -EBUSY one runs; then nothing has changed. The errors of
 * iso_reset_begin and iso_reset_finish. Prints on `out` what it did. */
int iso_components_reset(const struct iso_config *config, FILE *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Before a start: finishes a reset that was begun, or resets an appliance that has a gallery if the
 * button is held for ISO_RESET_HOLD_S, and returns 1. Else returns 0 and does nothing. A button
 * that cannot be read is not held, and *remark says why; else it is "". The errors of
 * iso_components_reset. */
int iso_components_finish_reset(const struct iso_config *config, const struct iso_times *times,
                                FILE *out, struct iso_fault *remark, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Stops the door, which leaves its lines without power; closes all that is open, and frees the
 * components. NULL is accepted. */
void iso_components_close(struct iso_components *components);

/* Lends the components to an appliance, which calls the handlers `events`. The sensor is opened
 * from the configuration when it is needed. */
struct iso_appliance_borrowed iso_components_lend(struct iso_components *components,
                                                  const struct iso_appliance_events *events);

#endif
