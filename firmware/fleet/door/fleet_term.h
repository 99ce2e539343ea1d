/* How long a lease holds. Pure; the clocks are injected.
 *
 * A lease runs from the moment when the question was made, by the clock of the boot, which nobody
 * sets and which also runs while the machine is suspended. A restart of the daemon finds it again
 * by the id of the boot. After a reboot that clock is another one: then the lease holds until its
 * end by the date, if the date was known when it began and is known now. Otherwise there is no
 * lease until the hub answers. */
#ifndef ISO_FIRMWARE_FLEET_DOOR_FLEET_TERM_H
#define ISO_FIRMWARE_FLEET_DOOR_FLEET_TERM_H

#include <stdbool.h>
#include <stdint.h>

enum { ISO_FLEET_BOOT_ID_BYTES = 16 };

/* The clocks at one moment. */
struct iso_fleet_clocks {
    int64_t boot_ns;                          /* CLOCK_BOOTTIME */
    uint8_t boot_id[ISO_FLEET_BOOT_ID_BYTES]; /* of this boot */
    int64_t date_s;                           /* since 1970 */
    bool date_known; /* the clock was set, and is not behind what is on record */
};

/* A lease. All zero: there never was one. */
struct iso_fleet_term {
    struct iso_fleet_clocks begin; /* when the question was made */
    int64_t length_s;              /* more than 0 */
};

/* Whether there ever was a lease. */
bool iso_fleet_term_was_given(const struct iso_fleet_term *term);

/* For how long the lease still holds, in nanoseconds; 0: it is over, or there never was one. */
int64_t iso_fleet_term_left_ns(const struct iso_fleet_term *term,
                               const struct iso_fleet_clocks *now);

#endif
