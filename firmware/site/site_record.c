#include "firmware/site/site_record.h"

#include <errno.h>
#include <string.h>

#include "core/base/bytes.h"

bool iso_site_record_is_empty(const struct iso_site_record *record)
{
    return record->n_ranges == 0 && record->n_marks == 0;
}

bool iso_site_record_teaches(const struct iso_site_record *record, uint64_t number)
{
    for (int i = 0; i < record->n_ranges; i++) {
        if (number >= record->range[i].first && number < record->range[i].end) {
            return false;
        }
    }
    return true;
}

/* Makes one range of those at `at` and `at` + 1. */
static void join(struct iso_site_range *range, int *n, int at)
{
    if (range[at + 1].end > range[at].end) {
        range[at].end = range[at + 1].end;
    }
    memmove(&range[at + 1], &range[at + 2], (size_t)(*n - at - 2) * sizeof *range);
    --*n;
}

/* Returns the place before the smallest gap. */
static int smallest_gap(const struct iso_site_range *range, int n)
{
    int at = 0;
    for (int i = 1; i + 1 < n; i++) {
        if (range[i + 1].first - range[i].end < range[at + 1].first - range[at].end) {
            at = i;
        }
    }
    return at;
}

void iso_site_record_exclude(struct iso_site_record *record, uint64_t first, uint64_t end)
{
    struct iso_site_range range[ISO_SITE_RANGES_MAX + 1]; /* with room for one more */
    int n = record->n_ranges, at = 0;
    if (first >= end) {
        return;
    }
    while (at < n && record->range[at].first < first) {
        at++;
    }
    memcpy(range, record->range, (size_t)at * sizeof *range);
    range[at] = (struct iso_site_range){first, end};
    memcpy(&range[at + 1], &record->range[at], (size_t)(n - at) * sizeof *range);
    n++;
    for (int i = 0; i + 1 < n;) {
        if (range[i].end >= range[i + 1].first) {
            join(range, &n, i);
        } else {
            i++;
        }
    }
    if (n > ISO_SITE_RANGES_MAX) {
        join(range, &n, smallest_gap(range, n));
    }
    memset(record->range, 0, sizeof record->range);
    memcpy(record->range, range, (size_t)n * sizeof *range);
    record->n_ranges = n;
}

void iso_site_record_mark(struct iso_site_record *record, uint64_t number)
{
    if (record->n_marks == ISO_SITE_MARKS_MAX) {
        memmove(&record->mark[0], &record->mark[1], sizeof record->mark - sizeof record->mark[0]);
        record->n_marks--;
    }
    record->mark[record->n_marks++] = number;
}

void iso_site_record_put(const struct iso_site_record *record, uint8_t bytes[ISO_SITE_RECORD_BYTES])
{
    uint8_t *p = iso_put_u64(bytes, (uint64_t)record->n_ranges);
    for (int i = 0; i < ISO_SITE_RANGES_MAX; i++) {
        const bool used = i < record->n_ranges;
        p = iso_put_u64(p, used ? record->range[i].first : 0);
        p = iso_put_u64(p, used ? record->range[i].end : 0);
    }
    p = iso_put_u64(p, (uint64_t)record->n_marks);
    for (int i = 0; i < ISO_SITE_MARKS_MAX; i++) {
        p = iso_put_u64(p, i < record->n_marks ? record->mark[i] : 0);
    }
}

int iso_site_record_get(const uint8_t bytes[ISO_SITE_RECORD_BYTES], struct iso_site_record *out)
{
    const uint8_t *marks = bytes + 8 + ISO_SITE_RANGES_MAX * 16;
    const uint64_t n_ranges = iso_get_u64(bytes), n_marks = iso_get_u64(marks);
    if (n_ranges > ISO_SITE_RANGES_MAX || n_marks > ISO_SITE_MARKS_MAX) {
        return -EBADMSG;
    }
    *out = (struct iso_site_record){.n_ranges = (int)n_ranges, .n_marks = (int)n_marks};
    for (int i = 0; i < out->n_ranges; i++) {
        out->range[i].first = iso_get_u64(bytes + 8 + i * 16);
        out->range[i].end = iso_get_u64(bytes + 16 + i * 16);
    }
    for (int i = 0; i < out->n_marks; i++) {
        out->mark[i] = iso_get_u64(marks + 8 + i * 8);
    }
    return 0;
}
