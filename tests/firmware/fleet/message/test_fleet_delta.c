/* Changes, deltas and heads of a zone: what is written is read; what was changed, cut, signed by
 * somebody else or sealed with another key is refused; and which delta comes next. */
#include <errno.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/fleet/message/head.h"
#include "tests/firmware/fleet/message/message_rig.h"

static void a_person_is_read_as_written(void **state)
{
    struct message_rig rig;
    struct iso_fleet_delta delta;
    struct iso_fleet_change change;
    struct iso_fleet_bytes plain = {.bytes = NULL};
    const struct iso_fleet_person ada = message_rig_person();
    (void)state;
    message_rig_start(&rig);
    struct iso_fleet_bytes message = message_rig_next(&rig);
    assert_int_equal(iso_fleet_read_delta(message.bytes, message.size, rig.hub.public, &delta), 0);
    assert_int_equal(delta.place.sequence, 1);
    assert_memory_equal(&delta.place, &rig.here, sizeof rig.here);
    assert_int_equal(iso_fleet_open_delta(message.bytes, message.size, &rig.key, &plain), 0);
    assert_int_equal(iso_fleet_read_change(plain.bytes, plain.size, &change), 0);
    assert_int_equal(change.kind, ISO_FLEET_PUT);
    assert_true(iso_fleet_id_is_same(&change.person.id, &ada.id));
    assert_int_equal(change.person.revision, 17);
    assert_true(change.person.offline_ok);
    assert_int_equal(change.person.valid_from_s, 1700000000);
    assert_int_equal(change.person.name_length, 12);
    assert_memory_equal(change.person.name, ada.name, 12);
    assert_memory_equal(change.person.credential, ada.credential, 16);
    assert_int_equal(change.person.n, 2);
    for (size_t i = 0; i < 2; i++) {
        assert_int_equal(change.person.templates[i].algorithm, ada.templates[i].algorithm);
        assert_int_equal(change.person.templates[i].size, ada.templates[i].size);
        assert_memory_equal(change.person.templates[i].bytes, ada.templates[i].bytes,
                            ada.templates[i].size);
    }
    iso_fleet_bytes_free(&plain);
    iso_fleet_bytes_free(&message);
}

static void a_broker_sees_no_name_and_no_template(void **state)
{
    static const uint8_t part[16] = {0x22, 0x22, 0x22, 0x22, 0x22, 0x22, 0x22, 0x22,
                                     0x22, 0x22, 0x22, 0x22, 0x22, 0x22, 0x22, 0x22};
    struct message_rig rig;
    (void)state;
    message_rig_start(&rig);
    struct iso_fleet_bytes message = message_rig_next(&rig);
    assert_null(memmem(message.bytes, message.size, "Ada", 3));
    assert_null(memmem(message.bytes, message.size, part, sizeof part));
    iso_fleet_bytes_free(&message);
}

static int read_delta(void *context, const uint8_t *bytes, size_t size)
{
    const struct message_rig *rig = context;
    struct iso_fleet_delta delta;
    return iso_fleet_read_delta(bytes, size, rig->hub.public, &delta);
}

static void a_changed_delta_is_refused(void **state)
{
    struct message_rig rig;
    struct iso_fleet_delta delta;
    struct iso_fleet_bytes plain = {.bytes = NULL};
    (void)state;
    message_rig_start(&rig);
    struct iso_fleet_bytes message = message_rig_next(&rig);
    message_rig_damage(&message, read_delta, &rig);
    assert_int_equal(iso_fleet_read_delta(message.bytes, message.size, rig.other.public, &delta),
                     -EKEYREJECTED);
    struct iso_fleet_zone_key key = rig.key;
    key.bytes[3] ^= 1;
    assert_int_equal(iso_fleet_open_delta(message.bytes, message.size, &key, &plain),
                     -EKEYREJECTED);
    assert_null(plain.bytes);
    iso_fleet_bytes_free(&message);
}

/* The hub itself may not give a sealed change another place: the place is bound to the seal. */
static void a_sealed_change_cannot_move(void **state)
{
    struct message_rig rig;
    struct iso_fleet_bytes plain = {.bytes = NULL};
    (void)state;
    message_rig_start(&rig);
    struct iso_fleet_bytes message = message_rig_next(&rig);
    message.bytes[ISO_FLEET_HEADER_BYTES + ISO_FLEET_ID_BYTES + 8] ^= 2; /* the sequence */
    message.size -= ISO_FLEET_SIGNATURE_BYTES;
    assert_int_equal(iso_fleet_sign(&message, &rig.hub), 0);
    assert_int_equal(read_delta(&rig, message.bytes, message.size), 0);
    assert_int_equal(iso_fleet_open_delta(message.bytes, message.size, &rig.key, &plain),
                     -EKEYREJECTED);
    iso_fleet_bytes_free(&message);
}

static enum iso_fleet_step step(const struct message_rig *rig, const struct iso_fleet_place *here,
                                const struct iso_fleet_bytes *message)
{
    struct iso_fleet_delta delta;
    assert_int_equal(iso_fleet_read_delta(message->bytes, message->size, rig->hub.public, &delta),
                     0);
    return iso_fleet_step_of(here, &delta);
}

static void only_the_next_delta_comes_next(void **state)
{
    struct message_rig rig;
    struct iso_fleet_place places[4];
    struct iso_fleet_bytes messages[4];
    (void)state;
    message_rig_start(&rig);
    for (int i = 0; i < 4; i++) {
        places[i] = rig.here;
        messages[i] = message_rig_next(&rig);
    }
    for (int here = 0; here < 4; here++) {
        for (int i = 0; i < 4; i++) {
            assert_int_equal(step(&rig, &places[here], &messages[i]),
                             i == here  ? ISO_FLEET_STEP_NEXT
                             : i < here ? ISO_FLEET_STEP_KNOWN
                                        : ISO_FLEET_STEP_GAP);
        }
    }
    struct iso_fleet_place other = places[2];
    other.zone.bytes[0] ^= 1;
    assert_int_equal(step(&rig, &other, &messages[2]), ISO_FLEET_STEP_FOREIGN);
    other = places[2]; /* another history */
    other.digest[0] ^= 1;
    assert_int_equal(step(&rig, &other, &messages[2]), ISO_FLEET_STEP_FOREIGN);
    assert_int_equal(step(&rig, &other, &messages[1]), ISO_FLEET_STEP_FOREIGN);
    other = places[2]; /* the door is in a later epoch */
    other.epoch = 2;
    assert_int_equal(step(&rig, &other, &messages[2]), ISO_FLEET_STEP_FOREIGN);
    rig.here.epoch = 2;
    struct iso_fleet_bytes later = message_rig_next(&rig);
    assert_int_equal(step(&rig, &places[3], &later), ISO_FLEET_STEP_EPOCH);
    iso_fleet_bytes_free(&later);
    for (int i = 0; i < 4; i++) {
        iso_fleet_bytes_free(&messages[i]);
    }
}

static void other_changes_are_read_as_written(void **state)
{
    struct iso_fleet_change change = {.kind = ISO_FLEET_REMOVE}, read;
    struct iso_fleet_bytes plain = {.bytes = NULL};
    (void)state;
    assert_int_equal(iso_fleet_start(NULL), 0);
    change.person.id = iso_fleet_id_random();
    change.person.revision = UINT64_MAX;
    iso_fleet_put_change(&plain, &change);
    assert_int_equal(iso_fleet_read_change(plain.bytes, plain.size, &read), 0);
    assert_int_equal(read.kind, ISO_FLEET_REMOVE);
    assert_true(iso_fleet_id_is_same(&read.person.id, &change.person.id));
    assert_true(read.person.revision == UINT64_MAX);
    assert_int_equal(iso_fleet_read_change(plain.bytes, plain.size - 1, &read), -EBADMSG);
    iso_fleet_bytes_free(&plain);

    change = (struct iso_fleet_change){
        .kind = ISO_FLEET_POLICY, .policy = "{\"a\":1}", .policy_length = 7};
    iso_fleet_put_change(&plain, &change);
    assert_int_equal(iso_fleet_read_change(plain.bytes, plain.size, &read), 0);
    assert_int_equal(read.policy_length, 7);
    assert_memory_equal(read.policy, "{\"a\":1}", 7);
    plain.bytes[5] = '\0'; /* a text has no NUL */
    assert_int_equal(iso_fleet_read_change(plain.bytes, plain.size, &read), -EBADMSG);
    iso_fleet_bytes_free(&plain);

    change = (struct iso_fleet_change){.kind = ISO_FLEET_LOCKDOWN, .lockdown = true};
    iso_fleet_put_change(&plain, &change);
    assert_int_equal(iso_fleet_read_change(plain.bytes, plain.size, &read), 0);
    assert_true(read.lockdown);
    plain.bytes[1] = 2;
    assert_int_equal(iso_fleet_read_change(plain.bytes, plain.size, &read), -EBADMSG);
    plain.bytes[0] = 99;
    assert_int_equal(iso_fleet_read_change(plain.bytes, plain.size, &read), -EPROTONOSUPPORT);
    iso_fleet_bytes_free(&plain);
    assert_int_equal(iso_fleet_read_change("", 0, &read), -EBADMSG);
}

static int read_head(void *context, const uint8_t *bytes, size_t size)
{
    const struct message_rig *rig = context;
    struct iso_fleet_head head;
    return iso_fleet_read_head(bytes, size, rig->hub.public, &head);
}

static void a_head_is_read_as_written(void **state)
{
    struct message_rig rig;
    struct iso_fleet_head head, read;
    struct iso_fleet_bytes message = {.bytes = NULL};
    (void)state;
    message_rig_start(&rig);
    rig.here.sequence = 1842;
    head = (struct iso_fleet_head){
        .place = rig.here, .time_s = 1764140000, .snapshot_sequence = 1800};
    assert_int_equal(iso_fleet_make_head(&head, &rig.hub, &message), 0);
    assert_int_equal(iso_fleet_read_head(message.bytes, message.size, rig.hub.public, &read), 0);
    assert_memory_equal(&read.place, &head.place, sizeof head.place);
    assert_int_equal(read.snapshot_sequence, 1800);
    message_rig_damage(&message, read_head, &rig);
    assert_int_equal(read_delta(&rig, message.bytes, message.size), -EBADMSG);
    iso_fleet_bytes_free(&message);
}

static void an_id_has_one_spelling(void **state)
{
    char text[ISO_FLEET_ID_TEXT_SIZE];
    struct iso_fleet_id read;
    (void)state;
    assert_int_equal(iso_fleet_start(NULL), 0);
    const struct iso_fleet_id id = iso_fleet_id_random(), of = iso_fleet_id_of("ada", 3);
    assert_int_equal(iso_fleet_id_read(iso_fleet_id_text(&id, text), &read), 0);
    assert_true(iso_fleet_id_is_same(&id, &read));
    assert_int_equal(text[14], '4');
    assert_false(iso_fleet_id_is_zero(&id));
    assert_int_equal(iso_fleet_id_text(&of, text)[14], '8');
    static const char *const bad[] = {"",
                                      "ada",
                                      "0190b3f2-0190-4190-8190-0190b3f2019",
                                      "0190b3f2-0190-4190-8190-0190b3f20190a",
                                      "0190b3f2-0190-4190-8190-0190b3f2019g",
                                      "0190b3f2+0190-4190-8190-0190b3f20190",
                                      "0190b3f2-0190-4190-8190-0190b3f2-190"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        assert_int_equal(iso_fleet_id_read(bad[i], &read), -EINVAL);
    }
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_person_is_read_as_written),
        cmocka_unit_test(a_broker_sees_no_name_and_no_template),
        cmocka_unit_test(a_changed_delta_is_refused),
        cmocka_unit_test(a_sealed_change_cannot_move),
        cmocka_unit_test(only_the_next_delta_comes_next),
        cmocka_unit_test(other_changes_are_read_as_written),
        cmocka_unit_test(a_head_is_read_as_written),
        cmocka_unit_test(an_id_has_one_spelling),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
