#include "drivers/door/osdp/osdp_display.h"

#include <string.h>

#define UNIT_NS   INT64_C(100000000)
#define SECOND_NS INT64_C(1000000000)

/* ---- the lamp ---- */

/* The bytes of one record of the command LED. */
enum {
    LED_READER,
    LED_NUMBER,
    LED_TEMPORARY, /* 0 leave it, 1 end it, 2 begin it */
    LED_TEMPORARY_ON,
    LED_TEMPORARY_OFF,
    LED_TEMPORARY_ON_COLOR,
    LED_TEMPORARY_OFF_COLOR,
    LED_TIMER,
    LED_PERMANENT = LED_TIMER + 2, /* 0 leave it, 1 set it */
    LED_ON,
    LED_OFF,
    LED_ON_COLOR,
    LED_OFF_COLOR,
    LED_BYTES,
};

static bool is_record_right(const uint8_t *record)
{
    return record[LED_READER] == 0 && record[LED_NUMBER] == 0 && record[LED_TEMPORARY] <= 2 &&
           record[LED_PERMANENT] <= 1 && record[LED_TEMPORARY_ON_COLOR] < ISO_OSDP_COLORS &&
           record[LED_TEMPORARY_OFF_COLOR] < ISO_OSDP_COLORS &&
           record[LED_ON_COLOR] < ISO_OSDP_COLORS && record[LED_OFF_COLOR] < ISO_OSDP_COLORS;
}

/* Four bytes of a record, from the time of the first colour on. */
static struct iso_osdp_lamp read_lamp(const uint8_t *bytes, int64_t now_ns)
{
    return (struct iso_osdp_lamp){.on = bytes[0],
                                  .off = bytes[1],
                                  .on_color = bytes[2],
                                  .off_color = bytes[3],
                                  .since_ns = now_ns};
}

static void do_record(struct iso_osdp_display *display, const uint8_t *record, int64_t now_ns)
{
    if (record[LED_PERMANENT] == 1) {
        display->lamp = read_lamp(record + LED_ON, now_ns);
    }
    if (record[LED_TEMPORARY] == 1) {
        display->lamp_until_ns = INT64_MIN;
    } else if (record[LED_TEMPORARY] == 2) {
        const int64_t timer = record[LED_TIMER] | record[LED_TIMER + 1] << 8;
        display->temporary_lamp = read_lamp(record + LED_TEMPORARY_ON, now_ns);
        display->lamp_until_ns = timer ? now_ns + timer * UNIT_NS : INT64_MAX;
    }
}

int iso_osdp_display_led(struct iso_osdp_display *display, const uint8_t *data, size_t n,
                         int64_t now_ns)
{
    if (n == 0 || n % LED_BYTES) {
        return ISO_OSDP_NAK_LENGTH;
    }
    for (size_t at = 0; at < n; at += LED_BYTES) {
        if (!is_record_right(data + at)) {
            return ISO_OSDP_NAK_RECORD;
        }
    }
    for (size_t at = 0; at < n; at += LED_BYTES) {
        do_record(display, data + at, now_ns);
    }
    return 0;
}

static enum iso_osdp_color lamp_color(const struct iso_osdp_lamp *lamp, int64_t now_ns)
{
    const int64_t period_ns = (lamp->on + lamp->off) * UNIT_NS;
    const bool on = period_ns == 0 || (now_ns - lamp->since_ns) % period_ns < lamp->on * UNIT_NS;
    return (enum iso_osdp_color)(on ? lamp->on_color : lamp->off_color);
}

/* ---- the buzzer ---- */

int iso_osdp_display_buz(struct iso_osdp_display *display, const uint8_t *data, size_t n,
                         int64_t now_ns)
{
    if (n != 5) {
        return ISO_OSDP_NAK_LENGTH;
    }
    /* Tone 0 is "no tone", 1 "off", 2 the standard tone; others are reserved. */
    if (data[0] != 0 || data[1] > 2 || (data[1] == 2 && data[2] == 0)) {
        return ISO_OSDP_NAK_RECORD;
    }
    display->tone = data[1];
    display->tone_on = data[2];
    display->tone_off = data[3];
    display->tone_count = data[4];
    display->tone_since_ns = now_ns;
    return 0;
}

static bool is_sounding(const struct iso_osdp_display *display, int64_t now_ns)
{
    if (display->tone != 2) {
        return false;
    }
    const int64_t period_ns = (display->tone_on + display->tone_off) * UNIT_NS;
    const int64_t since_ns = now_ns - display->tone_since_ns;
    return (display->tone_count == 0 || since_ns / period_ns < display->tone_count) &&
           since_ns % period_ns < display->tone_on * UNIT_NS;
}

/* ---- the text ---- */

enum {
    TEXT_READER,
    TEXT_KIND, /* 1 and 2 for good, 3 and 4 for a time; 2 and 4 go on in the next row */
    TEXT_SECONDS,
    TEXT_ROW, /* from 1 on, as the column */
    TEXT_COLUMN,
    TEXT_LENGTH,
    TEXT_LETTERS,
};

static void write_cells(struct iso_osdp_page *page, const uint8_t *data)
{
    const bool wraps = data[TEXT_KIND] == 2 || data[TEXT_KIND] == 4;
    size_t row = data[TEXT_ROW] - 1U, column = data[TEXT_COLUMN] - 1U;
    for (size_t i = 0; i < data[TEXT_LENGTH]; i++) {
        if (column == ISO_OSDP_COLUMNS && wraps) {
            column = 0;
            row++;
        }
        if (row >= ISO_OSDP_ROWS || column >= ISO_OSDP_COLUMNS) {
            return;
        }
        /* The text goes to a screen and to the message bus, so it must not have control codes. */
        const uint8_t letter = data[TEXT_LETTERS + i];
        page->cells[row][column++] = letter >= ' ' && letter <= '~' ? (char)letter : '?';
    }
}

int iso_osdp_display_text(struct iso_osdp_display *display, const uint8_t *data, size_t n,
                          int64_t now_ns)
{
    if (n < TEXT_LETTERS || n != (size_t)TEXT_LETTERS + data[TEXT_LENGTH]) {
        return ISO_OSDP_NAK_LENGTH;
    }
    if (data[TEXT_READER] != 0 || data[TEXT_KIND] < 1 || data[TEXT_KIND] > 4 ||
        data[TEXT_ROW] < 1 || data[TEXT_ROW] > ISO_OSDP_ROWS || data[TEXT_COLUMN] < 1 ||
        data[TEXT_COLUMN] > ISO_OSDP_COLUMNS) {
        return ISO_OSDP_NAK_RECORD;
    }
    if (data[TEXT_KIND] <= 2) {
        /* A text in the first cell replaces the page; at another place it is added to it. */
        if (data[TEXT_ROW] == 1 && data[TEXT_COLUMN] == 1) {
            memset(&display->page, 0, sizeof display->page);
        }
        write_cells(&display->page, data);
    } else {
        memset(&display->temporary_page, 0, sizeof display->temporary_page);
        write_cells(&display->temporary_page, data);
        display->page_until_ns = now_ns + data[TEXT_SECONDS] * SECOND_NS;
    }
    return 0;
}

static void copy_row(const char *cells, char *row)
{
    size_t n = ISO_OSDP_COLUMNS;
    while (n > 0 && (cells[n - 1] == 0 || cells[n - 1] == ' ')) {
        n--;
    }
    for (size_t i = 0; i < n; i++) {
        row[i] = cells[i] ? cells[i] : ' ';
    }
    row[n] = '\0';
}

void iso_osdp_display_read(const struct iso_osdp_display *display, int64_t now_ns,
                           struct iso_osdp_shown *shown)
{
    const bool temporary = now_ns < display->page_until_ns;
    const struct iso_osdp_page *page = temporary ? &display->temporary_page : &display->page;
    memset(shown, 0, sizeof *shown);
    shown->lamp = lamp_color(
        now_ns < display->lamp_until_ns ? &display->temporary_lamp : &display->lamp, now_ns);
    shown->buzzer = is_sounding(display, now_ns);
    for (size_t row = 0; row < ISO_OSDP_ROWS; row++) {
        copy_row(page->cells[row], shown->text[row]);
    }
}
