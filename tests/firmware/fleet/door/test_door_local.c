/* People who were enrolled at a door of a fleet: requests, and what the hub's answer does to them;
 * and what a door makes of contents that it cannot use as they are. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/fleet/door/door_rig.h"
#include "tests/firmware/rigs/gallery_rig.h"
#include "tests/firmware/rigs/puppets.h"

/* ---- people who were enrolled here ---- */

static struct iso_fleet_id request_of(struct door_rig *rig, const char *name)
{
    return iso_fleet_request_id(&rig->door, iso_gallery_version(rig->gallery).gallery,
                                door_rig_person(rig, name));
}

struct requests {
    struct door_rig *rig;
    int n;
    char names[200];
    struct iso_fleet_id last;
};

static void read_request(void *context, const void *bytes, size_t size)
{
    struct requests *requests = context;
    struct iso_fleet_bytes body = {.bytes = NULL};
    struct iso_fleet_person person;
    struct iso_fleet_id door;
    const struct door_rig *rig = requests->rig;
    assert_int_equal(iso_fleet_read_request(bytes, size, rig->door_signs.public, &rig->hub_receives,
                                            &door, &body, &person),
                     0);
    assert_true(iso_fleet_id_is_same(&door, &rig->door));
    assert_int_equal(person.n, 1);
    const size_t length = strlen(requests->names);
    (void)snprintf(requests->names + length, sizeof requests->names - length, "%.*s %.*s;",
                   (int)person.name_length, person.name,
                   person.credential_length > 100 ? 0 : (int)person.credential_length,
                   person.credential);
    requests->last = person.id;
    requests->n++;
    iso_fleet_bytes_free(&body);
}

static void an_enrolment_at_the_door_becomes_a_request(void **state)
{
    struct door_rig *rig = *state;
    struct requests requests = {.rig = rig};
    door_rig_begin(rig, 1);
    assert_int_equal(door_rig_give(rig, door_rig_put(rig, 0, 1, 1, "ada", 20, false)),
                     ISO_FLEET_APPLIED);
    assert_int_equal(gallery_rig_add(rig->gallery, "visitor", 60, NULL), 0);
    assert_int_equal(iso_fleet_requests(rig->fleet, read_request, &requests, NULL), 0);
    assert_int_equal(requests.n, 1);
    assert_string_equal(requests.names, "visitor ;");
    const struct iso_fleet_id id = request_of(rig, "visitor");
    assert_memory_equal(&requests.last, &id, sizeof id);
    assert_int_equal(door_rig_status(rig).pending, 1);
    assert_int_equal(door_rig_admission(rig, "visitor"), ISO_FLEET_NOT_APPROVED);
    rig->local_people = true;
    assert_int_equal(door_rig_answer(rig, 1), ISO_FLEET_APPLIED);
    assert_int_equal(door_rig_admission(rig, "visitor"), ISO_FLEET_MAY_ENTER);
}

static void give_change(struct door_rig *rig, const struct iso_fleet_change *change)
{
    struct iso_fleet_bytes bytes = {.bytes = NULL}, out = {.bytes = NULL};
    struct iso_fleet_delta delta = {.place = rig->zone[0].place};
    iso_fleet_put_change(&bytes, change);
    memcpy(delta.before, delta.place.digest, sizeof delta.before);
    delta.place.sequence++;
    assert_int_equal(
        iso_fleet_make_delta(&delta, bytes.bytes, bytes.size, &rig->zone[0].key, &rig->hub, &out),
        0);
    rig->zone[0].place = delta.place;
    iso_fleet_bytes_free(&bytes);
    assert_int_equal(door_rig_give(rig, out), ISO_FLEET_APPLIED);
}

/* The hub approves one, and refuses the other. */
static void an_answer_takes_the_place_of_the_local_person(void **state)
{
    struct door_rig *rig = *state;
    door_rig_begin(rig, 1);
    assert_int_equal(gallery_rig_add(rig->gallery, "visitor", 60, NULL), 0);
    assert_int_equal(gallery_rig_add(rig->gallery, "guest", 80, NULL), 0);
    struct iso_fleet_change change = {.kind = ISO_FLEET_PUT,
                                      .person = {.id = request_of(rig, "visitor"),
                                                 .revision = 1,
                                                 .name = "visitor 1",
                                                 .name_length = 9,
                                                 .credential = "{\"pin\":\"1234\"}",
                                                 .credential_length = 14}};
    give_change(rig, &change);
    assert_int_equal(door_rig_person(rig, "visitor"), 0);
    assert_true(door_rig_credential(rig, "visitor 1").pin != 0);
    assert_true(door_rig_noted(rig, "replaced visitor"));
    change = (struct iso_fleet_change){.kind = ISO_FLEET_REMOVE,
                                       .person = {.id = request_of(rig, "guest"), .revision = 2}};
    give_change(rig, &change);
    assert_int_equal(door_rig_person(rig, "guest"), 0);
    assert_int_equal(door_rig_status(rig).pending, 0);
    assert_int_equal(door_rig_status(rig).people, 1);
}

static void a_name_of_the_hub_replaces_a_local_person(void **state)
{
    struct door_rig *rig = *state;
    door_rig_begin(rig, 1);
    assert_int_equal(gallery_rig_add(rig->gallery, "ada", 60, NULL), 0);
    assert_int_equal(gallery_rig_add(rig->gallery, "ben", 80, NULL), 0);
    assert_int_equal(door_rig_give(rig, door_rig_put(rig, 0, 1, 1, "ADA", 20, false)),
                     ISO_FLEET_APPLIED);
    assert_true(iso_credential_is_of_fleet(
        &(struct iso_credential_record){.fleet = door_rig_credential(rig, "ada").fleet}));
    assert_int_equal(door_rig_status(rig).pending, 1);
    /* Ada of the fleet gets Ben's name: he was enrolled here, and leaves. */
    assert_int_equal(door_rig_give(rig, door_rig_put(rig, 0, 1, 2, "ben", 20, false)),
                     ISO_FLEET_APPLIED);
    assert_int_equal(door_rig_status(rig).pending, 0);
    assert_int_equal(door_rig_status(rig).people, 1);
    assert_true(door_rig_noted(rig, "removed ben"));
    door_rig_restart(rig);
    assert_int_equal(door_rig_status(rig).people, 1);
    assert_int_equal(door_rig_status(rig).pending, 0);
}

static void a_credential_that_cannot_be_read_lets_nobody_in(void **state)
{
    struct door_rig *rig = *state;
    door_rig_begin(rig, 1);
    const struct iso_fleet_change change = {.kind = ISO_FLEET_PUT,
                                            .person = {.id = door_rig_id(1),
                                                       .revision = 1,
                                                       .name = "ada",
                                                       .name_length = 3,
                                                       .credential = "{\"colour\":1}",
                                                       .credential_length = 12}};
    give_change(rig, &change);
    assert_false(door_rig_credential(rig, "ada").enabled);
}

/* More templates than the gallery keeps of one person: those of the door's algorithm come first. */
static void templates_of_the_own_algorithm_come_first(void **state)
{
    struct door_rig *rig = *state;
    static uint8_t bytes[2][ISO_TEMPLATE_BYTES_MAX];
    struct iso_fleet_change change = {.kind = ISO_FLEET_PUT,
                                      .person = {.id = door_rig_id(1),
                                                 .revision = 1,
                                                 .name = "ada",
                                                 .name_length = 3,
                                                 .n = ISO_FLEET_TEMPLATES_MAX}};
    door_rig_begin(rig, 1);
    for (uint32_t a = 0; a < 2; a++) {
        const struct iso_template tmpl = puppet_template(20, PUPPET_ALGORITHM + a);
        const int size = iso_template_serialise(&tmpl, bytes[a], sizeof bytes[a]);
        for (size_t i = 0; i < ISO_FLEET_TEMPLATES_MAX; i++) {
            if (i < 28 ? a == 1 : a == 0) { /* the last four are of the own one */
                change.person.templates[i] = (struct iso_fleet_template){PUPPET_ALGORITHM + a,
                                                                         (uint32_t)size, bytes[a]};
            }
        }
    }
    give_change(rig, &change);
    assert_int_equal(iso_gallery_find(rig->gallery, "ada")->templates, ISO_GALLERY_TEMPLATES_MAX);
    assert_int_equal(iso_gallery_find(rig->gallery, "ada")->usable, 4);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, door_rig_setup, door_rig_teardown)
    const struct CMUnitTest tests[] = {
        TEST(an_enrolment_at_the_door_becomes_a_request),
        TEST(an_answer_takes_the_place_of_the_local_person),
        TEST(a_name_of_the_hub_replaces_a_local_person),
        TEST(a_credential_that_cannot_be_read_lets_nobody_in),
        TEST(templates_of_the_own_algorithm_come_first),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
