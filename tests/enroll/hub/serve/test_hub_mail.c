/* The queue of the mail of doors, and the limit of attempts. */
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "enroll/hub/serve/bucket.h"
#include "enroll/hub/serve/mail_queue.h"
#include "firmware/fleet/message/envelope.h"

static const char id_text[] = "0190b3f2-1111-4222-8333-444455556666";

static void topics_name_the_door(void **state)
{
    static const char *const others[] = {
        "",
        "isotherm/door/",
        "isotherm/door/0190b3f2-1111-4222-8333-444455556666",
        "isotherm/door/0190b3f2-1111-4222-8333-444455556666/",
        "isotherm/door/0190b3f2-1111-4222-8333-444455556666/in",
        "isotherm/door/0190b3f2-1111-4222-8333-444455556666/out/",
        "isotherm/door/0190b3f2-1111-4222-8333-44445555666/out",
        "isotherm/door/0190b3f2-1111-4222-8333-4444555566666/out",
        "isotherm/zone/0190b3f2-1111-4222-8333-444455556666/out",
        "isotherm/door/zzzzb3f2-1111-4222-8333-444455556666/out",
    };
    struct iso_fleet_id id, wanted;
    bool is_presence;
    (void)state;

    assert_int_equal(iso_fleet_id_read(id_text, &wanted), 0);
    assert_true(hub_mail_topic("isotherm/door/0190b3f2-1111-4222-8333-444455556666/out", &id,
                               &is_presence));
    assert_false(is_presence);
    assert_true(iso_fleet_id_is_same(&id, &wanted));
    assert_true(hub_mail_topic("isotherm/door/0190b3f2-1111-4222-8333-444455556666/online", &id,
                               &is_presence));
    assert_true(is_presence);
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        if (hub_mail_topic(others[i], &id, &is_presence)) {
            fail_msg("%s", others[i]);
        }
    }
}

static void mail_is_taken_in_order(void **state)
{
    struct hub_mail_queue queue = {.first = NULL};
    struct iso_fleet_id door = {{1}};
    (void)state;

    hub_mail_drop_first(&queue);
    for (int round = 0; round < 2; round++) {
        assert_true(hub_mail_put(&queue, &door, false, "one", 3));
        assert_true(hub_mail_put(&queue, &door, true, "", 0));
        assert_true(hub_mail_put(&queue, &door, false, "three", 5));
        assert_int_equal(queue.n, 3);
        assert_int_equal(queue.bytes, 8);
        assert_memory_equal(queue.first->bytes, "one", 3);
        hub_mail_drop_first(&queue);
        assert_true(queue.first->is_presence);
        hub_mail_drop_first(&queue);
        assert_memory_equal(queue.first->bytes, "three", 5);
        hub_mail_drop_first(&queue);
        assert_null(queue.first);
        assert_int_equal(queue.bytes, 0);
    }
    assert_true(hub_mail_put(&queue, &door, false, "one", 3));
    hub_mail_clear(&queue);
    assert_int_equal(queue.n, 0);
}

static void a_full_queue_drops_the_newest(void **state)
{
    static unsigned char large[HUB_MAIL_BYTES_MAX / 4];
    struct hub_mail_queue queue = {.first = NULL};
    struct iso_fleet_id door = {{1}};
    (void)state;

    for (int i = 0; i < 4; i++) {
        large[0] = (unsigned char)i;
        assert_true(hub_mail_put(&queue, &door, false, large, sizeof large));
    }
    assert_false(hub_mail_put(&queue, &door, false, "x", 1));
    assert_int_equal(queue.dropped, 1);
    assert_int_equal(queue.first->bytes[0], 0);
    hub_mail_drop_first(&queue);
    assert_true(hub_mail_put(&queue, &door, false, "x", 1));
    hub_mail_clear(&queue);
}

enum { SIZE = ISO_FLEET_HEADER_BYTES + 1 + ISO_FLEET_SIGNATURE_BYTES };

/* A QUESTION as far as the queue reads it: header, a number and a signature, which is not read. */
static void make_question(unsigned char out[SIZE], uint8_t number)
{
    static const struct iso_fleet_signer signer;
    struct iso_fleet_bytes bytes = {.bytes = NULL};

    iso_fleet_begin(&bytes, ISO_FLEET_QUESTION);
    iso_fleet_put_u8(&bytes, number);
    assert_int_equal(iso_fleet_sign(&bytes, &signer), 0);
    assert_int_equal(bytes.size, SIZE);
    memcpy(out, bytes.bytes, SIZE);
    iso_fleet_bytes_free(&bytes);
}

static void a_question_takes_the_place_of_an_earlier_one(void **state)
{
    struct hub_mail_queue queue = {.first = NULL};
    const struct iso_fleet_id doors[2] = {{{1}}, {{2}}};
    unsigned char one[SIZE], two[SIZE];
    (void)state;

    make_question(one, 1);
    make_question(two, 2);
    for (int round = 0; round < 2; round++) {
        assert_true(hub_mail_put(&queue, &doors[0], false, one, SIZE));
        assert_true(hub_mail_put(&queue, &doors[1], false, one, SIZE));
        assert_true(hub_mail_put(&queue, &doors[0], false, "events", 6));
        assert_true(hub_mail_put(&queue, &doors[0], true, "1", 1));
        assert_true(hub_mail_put(&queue, &doors[0], false, two, SIZE));
        assert_int_equal(queue.n, 4);
        assert_int_equal(queue.bytes, 2 * SIZE + 7);
        assert_int_equal(queue.replaced, round + 1);
        assert_memory_equal(queue.first->bytes, two, SIZE); /* in the place of the earlier one */
        hub_mail_drop_first(&queue);
        assert_memory_equal(queue.first->bytes, one, SIZE); /* another door's question stays */
        /* One that is answered is not replaced any more. */
        assert_true(hub_mail_put(&queue, &doors[0], false, one, SIZE));
        assert_int_equal(queue.n, 4);
        hub_mail_clear(&queue);
        assert_int_equal(queue.bytes, 0);
        assert_null(queue.questions);
    }
}

static void a_bucket_fills_with_time(void **state)
{
    struct hub_bucket bucket = hub_bucket_of(3, 2);
    (void)state;

    assert_true(hub_bucket_take(&bucket, 100));
    assert_true(hub_bucket_take(&bucket, 100));
    assert_true(hub_bucket_take(&bucket, 100));
    assert_false(hub_bucket_take(&bucket, 100));
    assert_false(hub_bucket_take(&bucket, 100.4));
    assert_true(hub_bucket_take(&bucket, 100.6));
    assert_false(hub_bucket_take(&bucket, 100.6));
    for (int i = 0; i < 3; i++) {
        assert_true(hub_bucket_take(&bucket, 1000)); /* never more than it holds */
    }
    assert_false(hub_bucket_take(&bucket, 1000));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(topics_name_the_door),
        cmocka_unit_test(mail_is_taken_in_order),
        cmocka_unit_test(a_full_queue_drops_the_newest),
        cmocka_unit_test(a_question_takes_the_place_of_an_earlier_one),
        cmocka_unit_test(a_bucket_fills_with_time),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
