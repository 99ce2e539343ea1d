/* Messages between one door and the hub: keys, questions, leases, events, requests, fetches,
 * memberships and orders of updates. What is written is read; what was changed, cut, sealed for
 * another or signed by somebody else is refused. */
#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/fleet/message/door_mail.h"
#include "firmware/fleet/message/membership.h"
#include "firmware/fleet/message/zone_key.h"
#include "firmware/fleet/order/update_order.h"
#include "tests/firmware/fleet/message/message_rig.h"

static int read_key(void *context, const uint8_t *bytes, size_t size)
{
    const struct message_rig *rig = context;
    struct iso_fleet_key_grant grant;
    return iso_fleet_read_key(bytes, size, rig->hub.public, &rig->door_box, &grant);
}

static void a_key_is_for_one_door(void **state)
{
    struct message_rig rig;
    struct iso_fleet_key_grant grant, read;
    struct iso_fleet_bytes message = {.bytes = NULL};
    (void)state;
    message_rig_start(&rig);
    grant = (struct iso_fleet_key_grant){
        .door = iso_fleet_id_random(), .base = rig.here, .reset = true, .key = rig.key};
    assert_int_equal(iso_fleet_make_key(&grant, rig.door_box.public, &rig.hub, &message), 0);
    assert_int_equal(
        iso_fleet_read_key(message.bytes, message.size, rig.hub.public, &rig.door_box, &read), 0);
    assert_memory_equal(read.key.bytes, rig.key.bytes, sizeof rig.key.bytes);
    assert_true(read.reset);
    assert_true(iso_fleet_id_is_same(&read.door, &grant.door));
    assert_memory_equal(&read.base, &grant.base, sizeof grant.base);
    assert_null(memmem(message.bytes, message.size, rig.key.bytes, sizeof rig.key.bytes));
    message_rig_damage(&message, read_key, &rig);
    assert_int_equal(
        iso_fleet_read_key(message.bytes, message.size, rig.hub.public, &rig.hub_box, &read),
        -EKEYREJECTED);
    iso_fleet_bytes_free(&message);
}

static int read_question(void *context, const uint8_t *bytes, size_t size)
{
    const struct message_rig *rig = context;
    struct iso_fleet_question question;
    return iso_fleet_read_question(bytes, size, rig->door.public, &question);
}

static int read_lease(void *context, const uint8_t *bytes, size_t size)
{
    const struct message_rig *rig = context;
    struct iso_fleet_lease lease;
    return iso_fleet_read_lease(bytes, size, rig->hub.public, &lease);
}

static void a_question_and_its_answer(void **state)
{
    struct message_rig rig;
    struct iso_fleet_question question = {.time_s = 12, .algorithm = 7, .last_event = 99, .n = 2},
                              asked;
    struct iso_fleet_lease lease = {.lease_s = 86400, .local_people = true, .acked = 98, .n = 1},
                           answered;
    struct iso_fleet_bytes message = {.bytes = NULL};
    struct iso_fleet_id door;
    (void)state;
    message_rig_start(&rig);
    question.door = lease.door = iso_fleet_id_random();
    randombytes_buf(question.nonce, sizeof question.nonce);
    memcpy(lease.nonce, question.nonce, sizeof lease.nonce);
    question.places[0] = question.places[1] = lease.places[0] = rig.here;
    question.health = "{\"sensor\":\"lost\"}";
    question.health_length = strlen(question.health);
    assert_int_equal(iso_fleet_make_question(&question, &rig.door, &message), 0);
    assert_int_equal(iso_fleet_read_question(message.bytes, message.size, rig.door.public, &asked),
                     0);
    assert_memory_equal(asked.nonce, question.nonce, sizeof asked.nonce);
    assert_int_equal(asked.n, 2);
    assert_memory_equal(&asked.places[1], &rig.here, sizeof rig.here);
    assert_int_equal(asked.health_length, question.health_length);
    assert_memory_equal(asked.health, question.health, asked.health_length);
    assert_int_equal(asked.last_event, 99);
    assert_int_equal(iso_fleet_door_of(message.bytes, message.size, &door), 0);
    assert_true(iso_fleet_id_is_same(&door, &question.door));
    message_rig_damage(&message, read_question, &rig);
    iso_fleet_bytes_free(&message);

    assert_int_equal(iso_fleet_make_lease(&lease, &rig.hub, &message), 0);
    assert_int_equal(iso_fleet_read_lease(message.bytes, message.size, rig.hub.public, &answered),
                     0);
    assert_memory_equal(answered.nonce, question.nonce, sizeof answered.nonce);
    assert_int_equal(answered.lease_s, 86400);
    assert_true(answered.local_people);
    assert_int_equal(answered.acked, 98);
    assert_int_equal(answered.n, 1);
    message_rig_damage(&message, read_lease, &rig);
    assert_int_equal(read_question(&rig, message.bytes, message.size), -EBADMSG);
    iso_fleet_bytes_free(&message);
}

static int read_events(void *context, const uint8_t *bytes, size_t size)
{
    const struct message_rig *rig = context;
    struct iso_fleet_events events;
    struct iso_fleet_bytes lines = {.bytes = NULL};
    const int error = iso_fleet_read_events(bytes, size, rig->door.public, &rig->hub_box, &events,
                                            &lines);
    iso_fleet_bytes_free(&lines);
    return error;
}

static void events_are_for_the_hub(void **state)
{
    static const char text[] = "{\"sequence\":5,\"person\":\"ada\"}\n{\"sequence\":6}\n";
    struct message_rig rig;
    struct iso_fleet_events events = {.first = 5, .last = 6}, read;
    struct iso_fleet_bytes message = {.bytes = NULL}, lines = {.bytes = NULL};
    (void)state;
    message_rig_start(&rig);
    events.door = iso_fleet_id_random();
    assert_int_equal(iso_fleet_make_events(&events, text, sizeof text - 1, rig.hub_box.public,
                                           &rig.door, &message),
                     0);
    assert_null(memmem(message.bytes, message.size, "ada", 3));
    assert_int_equal(iso_fleet_read_events(message.bytes, message.size, rig.door.public,
                                           &rig.hub_box, &read, &lines),
                     0);
    assert_int_equal(read.first, 5);
    assert_int_equal(read.last, 6);
    assert_int_equal(lines.size, sizeof text - 1);
    assert_memory_equal(lines.bytes, text, lines.size);
    iso_fleet_bytes_free(&lines);
    message_rig_damage(&message, read_events, &rig);
    iso_fleet_bytes_free(&message);
    events.last = 4; /* before the first */
    assert_int_equal(iso_fleet_make_events(&events, text, sizeof text - 1, rig.hub_box.public,
                                           &rig.door, &message),
                     0);
    assert_int_equal(read_events(&rig, message.bytes, message.size), -EBADMSG);
    iso_fleet_bytes_free(&message);
}

static int read_ack(void *context, const uint8_t *bytes, size_t size)
{
    const struct message_rig *rig = context;
    struct iso_fleet_ack ack;
    return iso_fleet_read_ack(bytes, size, rig->hub.public, &ack);
}

static int read_fetch(void *context, const uint8_t *bytes, size_t size)
{
    const struct message_rig *rig = context;
    struct iso_fleet_fetch fetch;
    return iso_fleet_read_fetch(bytes, size, rig->door.public, &fetch);
}

static void an_ack_and_a_fetch(void **state)
{
    struct message_rig rig;
    struct iso_fleet_ack ack = {.number = 1000000}, acked;
    struct iso_fleet_fetch fetch = {.after = 41, .what = ISO_FLEET_WANT_SNAPSHOT}, fetched;
    struct iso_fleet_bytes message = {.bytes = NULL};
    (void)state;
    message_rig_start(&rig);
    ack.door = fetch.door = iso_fleet_id_random();
    fetch.zone = rig.here.zone;
    assert_int_equal(iso_fleet_make_ack(&ack, &rig.hub, &message), 0);
    assert_int_equal(iso_fleet_read_ack(message.bytes, message.size, rig.hub.public, &acked), 0);
    assert_int_equal(acked.number, 1000000);
    message_rig_damage(&message, read_ack, &rig);
    iso_fleet_bytes_free(&message);
    assert_int_equal(iso_fleet_make_fetch(&fetch, &rig.door, &message), 0);
    assert_int_equal(iso_fleet_read_fetch(message.bytes, message.size, rig.door.public, &fetched),
                     0);
    assert_int_equal(fetched.after, 41);
    assert_int_equal(fetched.what, ISO_FLEET_WANT_SNAPSHOT);
    assert_true(iso_fleet_id_is_same(&fetched.zone, &rig.here.zone));
    message_rig_damage(&message, read_fetch, &rig);
    iso_fleet_bytes_free(&message);
}

static int read_request(void *context, const uint8_t *bytes, size_t size)
{
    const struct message_rig *rig = context;
    struct iso_fleet_id door;
    struct iso_fleet_person person;
    struct iso_fleet_bytes body = {.bytes = NULL};
    const int error = iso_fleet_read_request(bytes, size, rig->door.public, &rig->hub_box, &door,
                                             &body, &person);
    iso_fleet_bytes_free(&body);
    return error;
}

static void a_request_brings_a_person(void **state)
{
    struct message_rig rig;
    struct iso_fleet_bytes message = {.bytes = NULL}, body = {.bytes = NULL};
    const struct iso_fleet_person ada = message_rig_person();
    struct iso_fleet_person read;
    struct iso_fleet_id from;
    (void)state;
    message_rig_start(&rig);
    const struct iso_fleet_id door = iso_fleet_id_random();
    assert_int_equal(iso_fleet_make_request(&door, &ada, rig.hub_box.public, &rig.door, &message),
                     0);
    assert_null(memmem(message.bytes, message.size, "Ada", 3));
    assert_int_equal(iso_fleet_read_request(message.bytes, message.size, rig.door.public,
                                            &rig.hub_box, &from, &body, &read),
                     0);
    assert_true(iso_fleet_id_is_same(&from, &door));
    assert_int_equal(read.n, ada.n);
    uint8_t one[ISO_FLEET_DIGEST_BYTES], other[ISO_FLEET_DIGEST_BYTES];
    iso_fleet_templates_digest(&ada, one);
    iso_fleet_templates_digest(&read, other);
    assert_memory_equal(one, other, sizeof one);
    iso_fleet_bytes_free(&body);
    message_rig_damage(&message, read_request, &rig);
    iso_fleet_bytes_free(&message);
}

static int read_membership(void *context, const uint8_t *bytes, size_t size)
{
    struct iso_fleet_membership membership;
    (void)context;
    return iso_fleet_read_membership(bytes, size, &membership);
}

static void a_membership_names_both_keys(void **state)
{
    struct message_rig rig;
    struct iso_fleet_membership membership = {.hub_name = "Headquarters", .door_name = "Lobby"},
                                read;
    struct iso_fleet_bytes message = {.bytes = NULL};
    (void)state;
    message_rig_start(&rig);
    membership.door = iso_fleet_id_random();
    memcpy(membership.hub_signs, rig.hub.public, sizeof membership.hub_signs);
    memcpy(membership.hub_receives, rig.hub_box.public, sizeof membership.hub_receives);
    memcpy(membership.door_signs, rig.door.public, sizeof membership.door_signs);
    assert_int_equal(iso_fleet_make_membership(&membership, &rig.hub, &message), 0);
    assert_int_equal(iso_fleet_read_membership(message.bytes, message.size, &read), 0);
    assert_string_equal(read.hub_name, "Headquarters");
    assert_string_equal(read.door_name, "Lobby");
    assert_memory_equal(read.door_signs, rig.door.public, sizeof read.door_signs);
    message_rig_damage(&message, read_membership, &rig);
    iso_fleet_bytes_free(&message);
}

static void topics_are_those_of_the_broker(void **state)
{
    char topic[ISO_FLEET_TOPIC_SIZE];
    struct iso_fleet_id id;
    (void)state;
    assert_int_equal(iso_fleet_id_read("0190b3f2-0190-4190-8190-0190b3f20190", &id), 0);
    assert_string_equal(iso_fleet_topic_delta(&id, topic),
                        "isotherm/zone/0190b3f2-0190-4190-8190-0190b3f20190/delta");
    assert_string_equal(iso_fleet_topic_head(&id, topic),
                        "isotherm/zone/0190b3f2-0190-4190-8190-0190b3f20190/head");
    assert_string_equal(iso_fleet_topic_in(&id, topic),
                        "isotherm/door/0190b3f2-0190-4190-8190-0190b3f20190/in");
    assert_string_equal(iso_fleet_topic_out(&id, topic),
                        "isotherm/door/0190b3f2-0190-4190-8190-0190b3f20190/out");
    assert_string_equal(iso_fleet_topic_online(&id, topic),
                        "isotherm/door/0190b3f2-0190-4190-8190-0190b3f20190/online");
}

static int read_update(void *context, const uint8_t *bytes, size_t size)
{
    const struct message_rig *rig = context;
    struct iso_fleet_update update;
    return iso_fleet_read_update(bytes, size, rig->hub.public, &update);
}

static void an_update_names_its_file(void **state)
{
    struct message_rig rig;
    struct iso_fleet_update update = {.door = iso_fleet_id_random(),
                                      .rollout = iso_fleet_id_random(),
                                      .size = 123456789,
                                      .spread_s = 77,
                                      .version = "1.2~rc1",
                                      .board = "isotherm-pc-usb-amd64"},
                            read;
    struct iso_fleet_bytes message = {.bytes = NULL};
    (void)state;
    message_rig_start(&rig);
    randombytes_buf(update.sha256, sizeof update.sha256);
    randombytes_buf(update.nonce, sizeof update.nonce);
    assert_int_equal(iso_fleet_make_update(&update, &rig.hub, &message), 0);
    assert_int_equal(iso_fleet_read_update(message.bytes, message.size, rig.hub.public, &read), 0);
    assert_true(iso_fleet_id_is_same(&read.door, &update.door));
    assert_true(iso_fleet_id_is_same(&read.rollout, &update.rollout));
    assert_memory_equal(read.nonce, update.nonce, sizeof read.nonce);
    assert_int_equal(read.size, 123456789);
    assert_int_equal(read.spread_s, 77);
    assert_memory_equal(read.sha256, update.sha256, sizeof read.sha256);
    assert_string_equal(read.version, "1.2~rc1");
    assert_string_equal(read.board, "isotherm-pc-usb-amd64");
    message_rig_damage(&message, read_update, &rig);
    assert_int_equal(iso_fleet_read_update(message.bytes, message.size, rig.door.public, &read),
                     -EKEYREJECTED);
    iso_fleet_bytes_free(&message);
}

static void a_line_of_a_door_is_made_harmless(void **state)
{
    static const char escape[] = "no \x1b[31mspace\nleft\xc2\x85\xe2\x80\x9chere\xe2\x80\x9d\x7f";
    char out[ISO_FLEET_UPDATE_FAULT_SIZE], text[300];
    (void)state;
    iso_fleet_update_fault_copy(out, escape);
    assert_string_equal(out, "no ?[31mspace?left?\xe2\x80\x9chere\xe2\x80\x9d?");
    iso_fleet_update_fault_copy(out, "cut\xe2\x80");
    assert_string_equal(out, "cut");
    /* 190 bytes, and a character of three bytes that does not fit whole. */
    memset(text, 'x', 190);
    strcpy(text + 190, "\xe2\x80\x9c...");
    iso_fleet_update_fault_copy(out, text);
    assert_int_equal(strlen(out), 190);
    memset(text, 'x', sizeof text - 1);
    text[sizeof text - 1] = '\0';
    iso_fleet_update_fault_copy(out, text);
    assert_int_equal(strlen(out), ISO_FLEET_UPDATE_FAULT_SIZE - 1);
}

static void an_update_that_is_not_allowed_is_refused(void **state)
{
    static const struct {
        uint64_t size;
        const char *version, *board;
    } bad[] = {
        {0, "1.2", "pc"},    {ISO_FLEET_UPDATE_BYTES_MAX + 1, "1.2", "pc"},
        {1, "", "pc"},       {1, "1.2", ""},
        {1, "../1.2", "pc"}, {1, "1.2", "a board"},
    };
    struct message_rig rig;
    struct iso_fleet_update update = {.size = 1}, read = {.size = 99};
    (void)state;
    message_rig_start(&rig);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        struct iso_fleet_bytes message = {.bytes = NULL};
        update.size = bad[i].size;
        (void)snprintf(update.version, sizeof update.version, "%s", bad[i].version);
        (void)snprintf(update.board, sizeof update.board, "%s", bad[i].board);
        assert_int_equal(iso_fleet_make_update(&update, &rig.hub, &message), 0);
        assert_int_equal(iso_fleet_read_update(message.bytes, message.size, rig.hub.public, &read),
                         -EBADMSG);
        assert_int_equal(read.size, 99);
        iso_fleet_bytes_free(&message);
    }
}

static void states_of_an_update_have_words(void **state)
{
    enum iso_fleet_update_state read = ISO_FLEET_UPDATE_STATES;
    (void)state;
    for (int i = 0; i < ISO_FLEET_UPDATE_STATES; i++) {
        const char *word = iso_fleet_update_state_word((enum iso_fleet_update_state)i);
        assert_int_equal(iso_fleet_update_state_read(word, &read), 0);
        assert_int_equal(read, i);
    }
    assert_int_equal(iso_fleet_update_state_read("", &read), -EINVAL);
    assert_int_equal(iso_fleet_update_state_read("healthier", &read), -EINVAL);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_key_is_for_one_door),
        cmocka_unit_test(a_question_and_its_answer),
        cmocka_unit_test(events_are_for_the_hub),
        cmocka_unit_test(an_ack_and_a_fetch),
        cmocka_unit_test(a_request_brings_a_person),
        cmocka_unit_test(a_membership_names_both_keys),
        cmocka_unit_test(topics_are_those_of_the_broker),
        cmocka_unit_test(an_update_names_its_file),
        cmocka_unit_test(a_line_of_a_door_is_made_harmless),
        cmocka_unit_test(an_update_that_is_not_allowed_is_refused),
        cmocka_unit_test(states_of_an_update_have_words),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
