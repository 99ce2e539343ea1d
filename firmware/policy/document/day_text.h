/* Dates, periods and days of the week as texts. Pure. */
#ifndef ISO_FIRMWARE_POLICY_DOCUMENT_DAY_TEXT_H
#define ISO_FIRMWARE_POLICY_DOCUMENT_DAY_TEXT_H

#include <stdint.h>

#include "firmware/policy/policy.h"

/* Sizes of the texts with their zero byte. */
enum { ISO_DATE_TEXT_SIZE = 16, ISO_PERIOD_TEXT_SIZE = 16, ISO_DAYS_TEXT_SIZE = 24 };

/* The day of "2026-12-25"; years 1970 to 9999. Returns 0, or -EINVAL if the text is not a date. */
int iso_date_read(const char *text, int32_t *day);

/* Writes such a day. */
void iso_date_write(int32_t day, char text[ISO_DATE_TEXT_SIZE]);

/* The period "09:00-17:30", whose end may be "24:00". Returns 0, or -EINVAL if the text is not one.
 * A period that ends before it begins is one: iso_policy_validate() refuses it. */
int iso_period_read(const char *text, struct iso_period *period);

/* Writes a period of a valid policy. */
void iso_period_write(const struct iso_period *period, char text[ISO_PERIOD_TEXT_SIZE]);

/* The days "monday", or "friday-monday" with all days between, as bits: bit 0 is Sunday. Returns 0
 * if the text is none of these. */
unsigned iso_days_read(const char *text);

/* Writes the days `first` to `last`, 0 for Sunday: one day if both are the same. */
void iso_days_write(int first, int last, char text[ISO_DAYS_TEXT_SIZE]);

#endif
