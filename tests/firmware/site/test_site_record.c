/* The record of templates that do not teach, against ranges that are joined by hand. */
#include <errno.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/site/site_record.h"

static void ranges_that_touch_become_one(void **state)
{
    struct iso_site_record record = {.n_ranges = 0};
    (void)state;
    assert_true(iso_site_record_is_empty(&record));
    iso_site_record_exclude(&record, 20, 30);
    iso_site_record_exclude(&record, 5, 8);
    iso_site_record_exclude(&record, 40, 41);
    iso_site_record_exclude(&record, 50, 50);
    assert_int_equal(record.n_ranges, 3);
    iso_site_record_exclude(&record, 8, 20);
    assert_int_equal(record.n_ranges, 2);
    assert_int_equal(record.range[0].first, 5);
    assert_int_equal(record.range[0].end, 30);
    iso_site_record_exclude(&record, 6, 7);
    iso_site_record_exclude(&record, 1, 100);
    assert_int_equal(record.n_ranges, 1);
    assert_true(iso_site_record_teaches(&record, 0) && iso_site_record_teaches(&record, 100));
    assert_false(iso_site_record_teaches(&record, 1) || iso_site_record_teaches(&record, 99));
}

/* The 17th range: the gap from 31 to 33 is the smallest one. */
static void too_many_ranges_exclude_more(void **state)
{
    struct iso_site_record record = {.n_ranges = 0};
    (void)state;
    for (uint64_t i = 0; i < ISO_SITE_RANGES_MAX; i++) {
        iso_site_record_exclude(&record, 10 * i, 10 * i + 1);
    }
    iso_site_record_exclude(&record, 33, 34);
    assert_int_equal(record.n_ranges, ISO_SITE_RANGES_MAX);
    assert_int_equal(record.range[3].first, 30);
    assert_int_equal(record.range[3].end, 34);
    for (uint64_t i = 0; i < ISO_SITE_RANGES_MAX; i++) {
        assert_false(iso_site_record_teaches(&record, 10 * i));
    }
    assert_true(iso_site_record_teaches(&record, 35));
}

static void the_last_marks_are_kept(void **state)
{
    struct iso_site_record record = {.n_marks = 0};
    (void)state;
    for (uint64_t i = 1; i <= ISO_SITE_MARKS_MAX + 3; i++) {
        iso_site_record_mark(&record, i);
    }
    assert_int_equal(record.n_marks, ISO_SITE_MARKS_MAX);
    assert_int_equal(record.mark[0], 4);
    assert_int_equal(record.mark[ISO_SITE_MARKS_MAX - 1], ISO_SITE_MARKS_MAX + 3);
}

static void it_comes_back_as_it_was(void **state)
{
    struct iso_site_record record = {.n_ranges = 0}, back;
    uint8_t bytes[ISO_SITE_RECORD_BYTES];
    (void)state;
    iso_site_record_exclude(&record, 3, (uint64_t)1 << 40);
    iso_site_record_mark(&record, (uint64_t)1 << 41);
    iso_site_record_put(&record, bytes);
    assert_int_equal(iso_site_record_get(bytes, &back), 0);
    assert_memory_equal(&back, &record, sizeof record);
    bytes[0] = ISO_SITE_RANGES_MAX + 1;
    assert_int_equal(iso_site_record_get(bytes, &back), -EBADMSG);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ranges_that_touch_become_one),
        cmocka_unit_test(too_many_ranges_exclude_more),
        cmocka_unit_test(the_last_marks_are_kept),
        cmocka_unit_test(it_comes_back_as_it_was),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
