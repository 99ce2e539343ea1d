/* The hours of the day in which a machine may restart. Pure. */
#ifndef ISO_DRIVERS_BASE_RESTART_HOURS_H
#define ISO_DRIVERS_BASE_RESTART_HOURS_H

#include <stdbool.h>

/* From the beginning of one hour, 0 to 23, to the beginning of another; over midnight if `until` is
 * the smaller one. Equal hours, such as all zero, are the whole day. */
struct iso_restart_hours {
    int from, until;
};

/* Reads "FROM-UNTIL": two whole hours that differ, such as "1-5". -EINVAL. */
int iso_restart_hours_read(const char *text, struct iso_restart_hours *out)
    __attribute__((warn_unused_result));

/* Whether a time between the beginning of this hour, 0 to 23, and the next one is among them. */
bool iso_restart_hours_have(const struct iso_restart_hours *hours, int hour);

#endif
