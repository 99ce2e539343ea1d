/* Which enrolled templates do not teach the metric, and where the last enrolments began. An
 * administrator excludes templates that must not teach: they go on to identify their person. Pure.
 *
 * A template is known by its number in the gallery. Numbers rise, and none is used twice. */
#ifndef ISO_FIRMWARE_SITE_SITE_RECORD_H
#define ISO_FIRMWARE_SITE_SITE_RECORD_H

#include <stdbool.h>
#include <stdint.h>

enum {
    ISO_SITE_RANGES_MAX = 16,
    ISO_SITE_MARKS_MAX = 16,
    ISO_SITE_RECORD_BYTES = 8 * (1 + 2 * ISO_SITE_RANGES_MAX + 1 + ISO_SITE_MARKS_MAX),
};

/* The numbers from `first` to `end`, without `end`. */
struct iso_site_range {
    uint64_t first, end;
};

/* All zero: every template teaches, and no enrolment is known. */
struct iso_site_record {
    int n_ranges;
    struct iso_site_range range[ISO_SITE_RANGES_MAX]; /* excluded; rising and apart */
    int n_marks;
    uint64_t mark[ISO_SITE_MARKS_MAX]; /* the first number of each of the last enrolments; rising */
};

/* Whether it is all zero. */
bool iso_site_record_is_empty(const struct iso_site_record *record);

/* Whether the template of this number teaches. */
bool iso_site_record_teaches(const struct iso_site_record *record, uint64_t number);

/* Excludes the templates from `first` to `end`, without `end`. Ranges that touch become one. If
 * there would be too many, the two with the smallest gap become one, so that more templates are
 * excluded than asked for, and never fewer. */
void iso_site_record_exclude(struct iso_site_record *record, uint64_t first, uint64_t end);

/* Notes that an enrolment begins with this number. The oldest mark is dropped if there are too
 * many. */
void iso_site_record_mark(struct iso_site_record *record, uint64_t number);

/* Writes the record, or reads it. get: -EBADMSG if it cannot be a record. */
void iso_site_record_put(const struct iso_site_record *record,
                         uint8_t bytes[ISO_SITE_RECORD_BYTES]);
int iso_site_record_get(const uint8_t bytes[ISO_SITE_RECORD_BYTES], struct iso_site_record *out)
    __attribute__((warn_unused_result));

#endif
