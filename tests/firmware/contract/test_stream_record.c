/* The records of the streams: what is written is read, and a reader accepts nothing else. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/contract/stream_record.h"

static struct iso_outline_record sample(void)
{
    struct iso_outline_record record = {
        .head = {.kind = ISO_STREAM_OUTLINE, .missed = 3, .sequence = 70000, .t_ns = -5},
        .distance_mm = 612,
        .lockdown = true,
        .mode = "watch",
        .hint = "no-face-in-image",
        .verdict = "deny",
        .reason = "not-on-record",
        .n_points = 3,
        .outline = {{0, 0}, {-32767, 40}, {900, 32767}},
    };
    record.silhouette[59][9] = 1;
    return record;
}

static void an_outline_is_read_as_it_was_written(void **state)
{
    (void)state;
    const struct iso_outline_record wanted = sample();
    struct iso_outline_record found;
    uint8_t bytes[ISO_OUTLINE_BYTES];
    assert_int_equal(iso_outline_record_write(&wanted, bytes), ISO_OUTLINE_BYTES);
    iso_stream_record_set_missed(bytes, 9);
    assert_int_equal(iso_outline_record_read(bytes, sizeof bytes, &found), 0);
    assert_int_equal(found.head.missed, 9);
    assert_int_equal(found.head.sequence, 70000);
    assert_true(found.head.t_ns == -5);
    assert_int_equal(found.distance_mm, 612);
    assert_true(found.lockdown && !found.locked_out);
    assert_string_equal(found.mode, "watch");
    assert_string_equal(found.hint, "no-face-in-image");
    assert_string_equal(found.verdict, "deny");
    assert_string_equal(found.reason, "not-on-record");
    assert_int_equal(found.n_points, 3);
    assert_memory_equal(found.outline, wanted.outline, sizeof wanted.outline);
    assert_true(iso_silhouette_is_set(found.silhouette, 79, 59));
    assert_false(iso_silhouette_is_set(found.silhouette, 78, 59));
}

static void a_relief_is_read_as_it_was_written(void **state)
{
    static struct iso_relief_record wanted;
    static struct iso_relief_record found;
    static uint8_t bytes[ISO_STREAM_BYTES_MAX];
    (void)state;
    wanted = (struct iso_relief_record){.head = {.sequence = 1}, .columns = 5, .rows = 3};
    wanted.depth_mm[14] = 65535;
    const size_t size = iso_relief_record_write(&wanted, bytes);
    assert_int_equal(size, 20 + 2 * 15);
    assert_int_equal(iso_relief_record_read(bytes, size, &found), 0);
    assert_int_equal(found.columns * found.rows, 15);
    assert_int_equal(found.depth_mm[14], 65535);
    assert_int_equal(iso_relief_record_read(bytes, size - 1, &found), -EBADMSG);
    assert_int_equal(iso_relief_record_read(bytes, size + 1, &found), -EBADMSG);
    bytes[16] = 0; /* no columns */
    assert_int_equal(iso_relief_record_read(bytes, size, &found), -EBADMSG);
    bytes[16] = 161;
    assert_int_equal(iso_relief_record_read(bytes, size, &found), -EBADMSG);
    assert_int_equal(iso_relief_record_read(bytes, 0, &found), -EBADMSG);
}

/* Changes one byte of a good record and expects that it is refused. */
static void refuse(size_t at, uint8_t value)
{
    const struct iso_outline_record good = sample();
    struct iso_outline_record found;
    uint8_t bytes[ISO_OUTLINE_BYTES];
    (void)iso_outline_record_write(&good, bytes);
    bytes[at] = value;
    assert_int_equal(iso_outline_record_read(bytes, sizeof bytes, &found), -EBADMSG);
}

static void a_damaged_outline_is_refused(void **state)
{
    (void)state;
    const struct iso_outline_record good = sample();
    struct iso_outline_record found;
    uint8_t bytes[ISO_OUTLINE_BYTES + 1] = {0};
    (void)iso_outline_record_write(&good, bytes);
    for (size_t size = 0; size <= sizeof bytes; size++) {
        assert_int_equal(iso_outline_record_read(bytes, size, &found),
                         size == ISO_OUTLINE_BYTES ? 0 : -EBADMSG);
    }
    refuse(0, 2);                 /* another version */
    refuse(1, ISO_STREAM_RELIEF); /* another kind */
    refuse(19, 2);                /* an outline of two points */
    refuse(19, ISO_OUTLINE_POINTS + 1);
    refuse(20, 'W');         /* a letter that no word has */
    refuse(20 + 5 + 1, 'x'); /* something behind the end of a word */
    refuse(20 + 12 + 16, 0xff);
}

static void a_word_that_is_too_long_is_cut(void **state)
{
    (void)state;
    struct iso_outline_record record = sample();
    struct iso_outline_record found;
    uint8_t bytes[ISO_OUTLINE_BYTES];
    memset(record.reason, 'x', sizeof record.reason); /* without an end */
    (void)iso_outline_record_write(&record, bytes);
    assert_int_equal(iso_outline_record_read(bytes, sizeof bytes, &found), 0);
    assert_int_equal(strlen(found.reason), sizeof found.reason - 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_outline_is_read_as_it_was_written),
        cmocka_unit_test(a_relief_is_read_as_it_was_written),
        cmocka_unit_test(a_damaged_outline_is_refused),
        cmocka_unit_test(a_word_that_is_too_long_is_cut),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
