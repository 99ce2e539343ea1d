/* What a configuration asks for, opened: everything that an appliance borrows. */
#ifndef ISO_FIRMWARE_PARTS_H
#define ISO_FIRMWARE_PARTS_H

#include <stdio.h>

#include "core/fault.h"
#include "firmware/appliance.h"
#include "firmware/crew.h"

struct iso_parts {
    struct iso_config config;
    struct iso_times times;
    struct iso_crew *crew; /* NULL: one thread */
    struct iso_pipeline pipeline;
    struct iso_key_ring *ring;
    struct iso_gallery *gallery;
    struct iso_audit *audit;
    struct iso_door_io *door_io;
    struct iso_cards *cards; /* NULL: none are sent */
    char lockout_path[ISO_CONFIG_TEXT_SIZE + 8];
};

/* Loads the modules (drivers/module.h) that the configuration asks for, so that nothing is loaded
 * later, when the process is confined. -ENOENT an unknown sensor, or a module is missing that the
 * sensor needs; -EBADMSG one cannot be used. That of the image check may be missing, unless the
 * configuration names a cascade (iso_pipeline_open). */
int iso_parts_load_modules(const struct iso_config *config, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Opens them in an order in which the door's lines are touched last. Every error of
 * iso_crew_new, iso_pipeline_open, iso_key_ring_open, iso_gallery_open, iso_audit_open,
 * iso_cards_load and iso_door_io_open, with nothing left open; -ESTALE if the log knows a newer
 * gallery. But with -ENODEV, -EBUSY, -EACCES or -EIO of the door its lines are lost and may come
 * back. What `times` points to must outlive the parts. */
int iso_parts_open(const struct iso_config *config, const struct iso_times *times,
                   struct iso_parts **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Puts the door's lines to where they rest without power and lets them go: for after a process that
 * may have left them otherwise. The errors of iso_door_io_open. */
int iso_parts_rest_door(const struct iso_config *config, const struct iso_times *times,
                        struct iso_fault *fault) __attribute__((warn_unused_result));

/* Opens the log alone, writes its records to `out`, a line each, and says whether it is sound: for
 * when no daemon runs. -EBADMSG with a fault if it is not, the errors of iso_key_ring_open and
 * iso_audit_open. */
int iso_parts_print_log(const struct iso_config *config, const struct iso_times *times, FILE *out,
                        struct iso_fault *fault) __attribute__((warn_unused_result));

/* NULL is fine. */
void iso_parts_close(struct iso_parts *parts);

/* Lent to an appliance; the sensor is opened from the configuration when it is needed. */
struct iso_appliance_parts iso_parts_lend(struct iso_parts *parts,
                                          const struct iso_appliance_events *events);

#endif
