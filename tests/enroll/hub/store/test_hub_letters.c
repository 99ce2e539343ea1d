/* Messages of doors that the hub takes together. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>

#include "enroll/hub/answer/hub_letters.h"
#include "tests/enroll/hub/rigs/played_door.h"

enum { DOORS = 3 };

static struct iso_fault fault;

/* The doors, and what was emitted. */
struct scene {
    struct store_rig *rig;
    struct store_rig other; /* another connection, which sees only what is committed */
    struct played_door doors[DOORS];
    struct iso_fleet_bytes messages[2 * DOORS];
    struct hub_letter letters[2 * DOORS + 1];
    size_t n;
    unsigned emitted;
    int64_t seen; /* reports of doors that the other connection saw at the first emission */
};

static struct hub_letter *add(struct scene *scene, struct played_door *door)
{
    struct hub_letter *letter = &scene->letters[scene->n];
    *letter = (struct hub_letter){.door = door->id,
                                  .bytes = scene->messages[scene->n].bytes,
                                  .size = scene->messages[scene->n].size};
    scene->n++;
    return letter;
}

static void add_question(struct scene *scene, struct played_door *door)
{
    struct iso_fleet_question question = {.door = door->id, .time_s = 5, .health = "{}"};
    question.health_length = 2;
    randombytes_buf(door->nonce, sizeof door->nonce);
    memcpy(question.nonce, door->nonce, sizeof question.nonce);
    assert_int_equal(iso_fleet_make_question(&question, &door->signs, &scene->messages[scene->n]),
                     0);
    (void)add(scene, door);
}

static void add_event(struct scene *scene, struct played_door *door, uint64_t number)
{
    const struct iso_fleet_events events = {.door = door->id, .first = number, .last = number};
    char line[64];
    const int length = snprintf(line, sizeof line, "{\"sequence\":%llu,\"event\":\"visit\"}\n",
                                (unsigned long long)number);
    assert_int_equal(iso_fleet_make_events(&events, line, (size_t)length, door->hub_receives,
                                           &door->signs, &scene->messages[scene->n]),
                     0);
    (void)add(scene, door);
}

/* Gives each message to its door, and looks whether the transaction is over. */
static int emit(void *context, const char *topic, const void *bytes, size_t size, bool retain)
{
    struct scene *scene = context;
    char own[ISO_FLEET_TOPIC_SIZE];
    if (scene->emitted++ == 0) {
        scene->seen = store_rig_number(&scene->other, "SELECT count(*) FROM door WHERE online");
    }
    for (int i = 0; i < DOORS; i++) {
        if (strcmp(topic, iso_fleet_topic_in(&scene->doors[i].id, own)) == 0) {
            const struct hub_emit door = played_door_emit(&scene->doors[i]);
            return door.emit(door.context, topic, bytes, size, retain);
        }
    }
    fail_msg("%s", topic);
    return -EINVAL;
}

/* Each door asks, and has one event. */
static void begin(struct scene *scene, struct store_rig *rig)
{
    const struct iso_fleet_id zone = store_rig_zone(rig, "office");
    *scene = (struct scene){.rig = rig, .other = *rig, .seen = -1};
    store_rig_open(rig, &scene->other.store);
    for (int i = 0; i < DOORS; i++) {
        char name[16];
        (void)snprintf(name, sizeof name, "door %d", i);
        played_door_join(&scene->doors[i], rig, name, &zone, 1);
        add_event(scene, &scene->doors[i], 1);
        add_question(scene, &scene->doors[i]);
    }
}

static void end(struct scene *scene)
{
    hub_store_close(&scene->other.store);
    for (size_t i = 0; i < sizeof scene->messages / sizeof *scene->messages; i++) {
        iso_fleet_bytes_free(&scene->messages[i]);
    }
}

static int take(struct scene *scene)
{
    const struct hub_emit to = {.emit = emit, .context = scene};
    return hub_take_letters(&scene->rig->store, scene->letters, scene->n, &to, &fault);
}

static void all_are_answered_after_the_commit(void **state)
{
    static struct scene scene;
    begin(&scene, *state);
    store_rig_fine(take(&scene), &fault);
    assert_int_equal(scene.seen, DOORS);
    for (int i = 0; i < DOORS; i++) {
        assert_int_equal(scene.doors[i].leases, 1);
        assert_int_equal(scene.doors[i].keys, 1);
        assert_int_equal(scene.doors[i].acks, 1);
        assert_int_equal(scene.doors[i].acked, 1);
        /* The event came before the question. */
        assert_int_equal(scene.doors[i].lease.acked, 1);
    }
    assert_int_equal(store_rig_number(scene.rig, "SELECT count(*) FROM event"), DOORS);
    end(&scene);
}

/* A QUESTION alone does not wait for the disk; together with EVENTS, which are acknowledged, it
 * does. The trigger looks during the commit. */
static void the_commit_waits_for_the_disk(void **state)
{
    static struct scene scene;
    begin(&scene, *state);
    store_rig_fine(
        hub_db_script(scene.rig->store.db,
                      "CREATE TABLE seen (setting text);"
                      "CREATE FUNCTION look() RETURNS trigger LANGUAGE plpgsql AS $$ BEGIN INSERT "
                      "INTO seen VALUES (current_setting('synchronous_commit')); RETURN NULL; END "
                      "$$; CREATE CONSTRAINT TRIGGER look AFTER UPDATE ON door DEFERRABLE "
                      "INITIALLY DEFERRED FOR EACH ROW EXECUTE FUNCTION look()",
                      &fault),
        &fault);
    store_rig_fine(take(&scene), &fault);
    assert_true(store_rig_number(scene.rig, "SELECT count(*) FROM seen") >= DOORS);
    assert_int_equal(store_rig_number(scene.rig, "SELECT count(*) FROM seen WHERE setting <> 'on'"),
                     0);
    end(&scene);
}

/* Two messages of a door keep their order, wherever they lie. */
static void the_order_of_a_door_is_kept(void **state)
{
    static struct scene scene;
    begin(&scene, *state);
    const struct hub_letter event = scene.letters[0];
    memmove(&scene.letters[0], &scene.letters[1], (scene.n - 1) * sizeof event);
    scene.letters[scene.n - 1] = event; /* now behind the question of its door */
    store_rig_fine(take(&scene), &fault);
    assert_int_equal(scene.doors[0].lease.acked, 0);
    assert_int_equal(scene.doors[0].acked, 1);
    end(&scene);
}

static void a_bad_message_undoes_all(void **state)
{
    static struct scene scene;
    uint8_t bad[512];
    begin(&scene, *state);
    struct hub_letter *last = &scene.letters[scene.n - 1];
    assert_true(last->size <= sizeof bad);
    memcpy(bad, last->bytes, last->size);
    bad[last->size - 1] ^= 1;
    last->bytes = bad;
    assert_int_equal(take(&scene), -EKEYREJECTED);
    assert_int_equal(scene.emitted, 0);
    assert_int_equal(store_rig_number(scene.rig, "SELECT count(*) FROM event"), 0);
    assert_int_equal(store_rig_number(scene.rig, "SELECT count(*) FROM door WHERE online"), 0);
    scene.n--;
    store_rig_fine(take(&scene), &fault);
    assert_int_equal(scene.doors[DOORS - 1].acked, 1);
    end(&scene);
}

static void who_is_online_is_taken_with_them(void **state)
{
    static struct scene scene;
    begin(&scene, *state);
    scene.letters[scene.n++] = (struct hub_letter){.door = scene.doors[1].id, .online = false};
    store_rig_fine(take(&scene), &fault);
    assert_int_equal(store_rig_number(scene.rig, "SELECT count(*) FROM door WHERE online"),
                     DOORS - 1);
    end(&scene);
}

/* A REQUEST may change a zone, so it is a transaction by itself. */
static void a_request_is_taken_alone(void **state)
{
    static struct scene scene;
    const struct iso_fleet_person person = store_rig_person("ada", 3, 1, 7);
    struct iso_fleet_bytes request = {.bytes = NULL};
    begin(&scene, *state);
    assert_int_equal(iso_fleet_make_request(&scene.doors[0].id, &person,
                                            scene.doors[0].hub_receives, &scene.doors[0].signs,
                                            &request),
                     0);
    scene.letters[scene.n++] = (struct hub_letter){
        .door = scene.doors[0].id, .bytes = request.bytes, .size = request.size};
    assert_false(hub_letter_is_joint(request.bytes, request.size));
    assert_int_equal(take(&scene), -EINVAL);
    assert_int_equal(store_rig_number(scene.rig, "SELECT count(*) FROM event"), 0);
    iso_fleet_bytes_free(&request);
    end(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(all_are_answered_after_the_commit, store_rig_setup,
                                        store_rig_teardown),
        cmocka_unit_test_setup_teardown(the_commit_waits_for_the_disk, store_rig_setup,
                                        store_rig_teardown),
        cmocka_unit_test_setup_teardown(the_order_of_a_door_is_kept, store_rig_setup,
                                        store_rig_teardown),
        cmocka_unit_test_setup_teardown(a_bad_message_undoes_all, store_rig_setup,
                                        store_rig_teardown),
        cmocka_unit_test_setup_teardown(who_is_online_is_taken_with_them, store_rig_setup,
                                        store_rig_teardown),
        cmocka_unit_test_setup_teardown(a_request_is_taken_alone, store_rig_setup,
                                        store_rig_teardown),
    };
    return cmocka_run_group_tests(tests, store_rig_start, store_rig_stop);
}
