/* What the panel wants the door station to show: one lamp, one buzzer, and a text of two rows.
 * Pure; the time is handed in. Times of the protocol are in units of 100 ms. */
#ifndef ISO_DRIVERS_DOOR_OSDP_OSDP_DISPLAY_H
#define ISO_DRIVERS_DOOR_OSDP_OSDP_DISPLAY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "drivers/door/osdp/osdp_codes.h"

enum {
    ISO_OSDP_ROWS = 2,
    ISO_OSDP_COLUMNS = 16,
};

/* What is to be shown at one moment. */
struct iso_osdp_shown {
    enum iso_osdp_color lamp;
    bool buzzer;
    char text[ISO_OSDP_ROWS][ISO_OSDP_COLUMNS + 1]; /* ASCII, without blanks at the end */
};

struct iso_osdp_lamp {
    uint8_t on, off;             /* how long each colour is shown; both 0: the first one always */
    uint8_t on_color, off_color; /* enum iso_osdp_color */
    int64_t since_ns;
};

struct iso_osdp_page {
    char cells[ISO_OSDP_ROWS][ISO_OSDP_COLUMNS]; /* 0: blank */
};

/* An all-zero display is dark, silent and empty. */
struct iso_osdp_display {
    struct iso_osdp_lamp lamp, temporary_lamp;
    int64_t lamp_until_ns;                       /* until then the temporary lamp is shown */
    uint8_t tone, tone_on, tone_off, tone_count; /* count 0: until it is switched off */
    int64_t tone_since_ns;
    struct iso_osdp_page page, temporary_page;
    int64_t page_until_ns;
};

/* Does the commands LED, BUZ and TEXT. Return 0 or the reason for a NAK (enum iso_osdp_nak); the
 * display is unchanged then. There is one reader (0) with one lamp (0). */
int iso_osdp_display_led(struct iso_osdp_display *display, const uint8_t *data, size_t n,
                         int64_t now_ns) __attribute__((warn_unused_result));
int iso_osdp_display_buz(struct iso_osdp_display *display, const uint8_t *data, size_t n,
                         int64_t now_ns) __attribute__((warn_unused_result));
int iso_osdp_display_text(struct iso_osdp_display *display, const uint8_t *data, size_t n,
                          int64_t now_ns) __attribute__((warn_unused_result));

/* What is to be shown now. */
void iso_osdp_display_read(const struct iso_osdp_display *display, int64_t now_ns,
                           struct iso_osdp_shown *shown);

#endif
