/* SCIM over HTTPS, before the running hub: what a request means for the doors, and the guard. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "enroll/hub/store/hub_zone.h"
#include "tests/enroll/hub/serve/scim_rig.h"

static int64_t sequence(void)
{
    struct iso_fault fault = {.text = ""};
    struct hub_zone zone;

    served_ok(hub_zone_find(&rig.store, "Office", &zone, &fault), &fault);
    return (int64_t)zone.place.sequence;
}

static void who_is_disabled_or_deleted_loses_all_zones(void **state)
{
    (void)state;

    served_door_begin();
    scim_map("staff", "Office");
    const char *user = scim_ada();
    const char *group = scim_make("Groups", "{'displayName':'Staff'}");
    const struct iso_fleet_id person = scim_enrol("Ada Lovelace", true);
    assert_string_equal(scim_zones(&person), "Lab"); /* of the approval */
    int64_t before = sequence();
    scim_add_member(group, user);
    assert_string_equal(scim_zones(&person), "Lab Office");
    assert_true(sequence() > before);
    scim_do("PATCH", user,
            SCIM_PATCH
            "[{'op':'replace','path':'urn:ietf:params:scim:schemas:extension:isotherm:2.0:"
            "User:validUntil','value':'2099-12-31T18:00:00+01:00'}]}",
            200);
    assert_int_equal(scim_number("SELECT valid_until_s FROM person"), 4102419600);
    before = sequence();
    /* Neither a name that cannot be stored nor a name of somebody else keeps the zones. */
    scim_do("PATCH", user,
            SCIM_PATCH "[{'op':'replace','value':{'active':false,'displayName':' bad '}}]}", 200);
    assert_string_equal(scim_zones(&person), "");
    assert_true(sequence() > before); /* the doors are told */
    assert_int_equal(scim_number("SELECT count(*) FROM template"), 1);
    scim_do("PATCH", user, SCIM_PATCH "[{'op':'replace','value':{'active':true}}]}", 400);
    scim_do("PATCH", user,
            SCIM_PATCH "[{'op':'replace','value':{'active':true,'displayName':'Ada King'}}]}", 200);
    assert_string_equal(scim_zones(&person), "Office");
    assert_int_equal(scim_number("SELECT count(*) FROM person WHERE name = 'Ada King'"), 1);
    scim_do("DELETE", user, NULL, 204);
    assert_string_equal(scim_zones(&person), "");
    /* The next account of the name does not get the face, whose enrolment was before it. */
    (void)sleep(2);
    user = scim_make("Users", "{'userName':'ada@example.org','displayName':'Ada King'}");
    scim_add_member(group, user);
    assert_string_equal(scim_zones(&person), "");
    assert_int_equal(
        scim_number("SELECT count(*) FROM act WHERE what LIKE 'scim-user-%' AND actor = "
                    "'scim:entra'"),
        6);
    assert_int_equal(scim_number("SELECT count(*) FROM act WHERE what = 'person-directory' AND "
                                 "actor = 'scim:entra'"),
                     5);
}

static void the_leader_links_who_was_approved(void **state)
{
    (void)state;

    served_door_begin();
    scim_map("Staff", "Office");
    const char *user = scim_ada();
    scim_add_member(scim_make("Groups", "{'displayName':'Staff'}"), user);
    const struct iso_fleet_id person = scim_enrol("Ada Lovelace", false);
    for (int i = 0; strcmp(scim_zones(&person), "Lab Office") != 0; i++) {
        assert_true(i < 300);
        (void)usleep(100000);
    }
    /* A zone that the directory gives is given again after somebody has taken it by hand. */
    struct iso_fault fault = {.text = ""};
    struct hub_zone lab;
    served_ok(hub_zone_find(&rig.store, "Lab", &lab, &fault), &fault);
    served_ok(hub_person_set_zones(&rig.store, &person, &lab.place.zone, 1, &fault), &fault);
    for (int i = 0; strcmp(scim_zones(&person), "Lab Office") != 0; i++) {
        assert_true(i < 300);
        (void)usleep(100000);
    }
}

static void the_guard_stops_the_loss_of_many(void **state)
{
    enum { PEOPLE = 15 };
    char body[2048] = SCIM_PATCH "[{'op':'add','path':'members','value':[";
    char users[PEOPLE][64];
    struct iso_fault fault = {.text = ""};
    (void)state;

    served_door_begin();
    scim_map("Staff", "Office");
    const char *group = scim_make("Groups", "{'displayName':'Staff'}");
    for (int i = 0; i < PEOPLE; i++) {
        char user[128];
        (void)snprintf(user, sizeof user, "{'userName':'u%d'}", i);
        (void)snprintf(users[i], sizeof users[i], "%s", scim_make("Users", user));
        const size_t at = strlen(body);
        (void)snprintf(body + at, sizeof body - at, "%s{'value':'%s'}", i > 0 ? "," : "",
                       users[i] + strlen("Users/"));
    }
    (void)strcat(body, "]}]}");
    scim_do("PATCH", group, body, 200);
    scim_do("DELETE", group, NULL, 429);
    assert_true(scim_has(scim_headers, "Retry-After"));
    assert_int_equal(scim_number("SELECT count(*) FROM directory_zone"), PEOPLE);
    for (int i = 0; i < HUB_SCIM_LOSSES_FREE; i++) {
        scim_do("PATCH", users[i], SCIM_PATCH "[{'op':'replace','value':{'active':false}}]}", 200);
    }
    scim_do("DELETE", users[PEOPLE - 1], NULL, 429);
    assert_string_equal(scim_text(users[PEOPLE - 1], "active"), "true");
    assert_int_equal(scim_number("SELECT count(*) FROM act WHERE what = 'scim-stopped'"), 1);
    served_ok(hub_scim_allow(&rig.store, &fault), &fault);
    scim_do("DELETE", users[PEOPLE - 1], NULL, 204);
    scim_do("DELETE", group, NULL, 204);
    assert_int_equal(scim_number("SELECT count(*) FROM directory_zone"), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        SCIM_TEST(who_is_disabled_or_deleted_loses_all_zones),
        SCIM_TEST(the_leader_links_who_was_approved),
        SCIM_TEST(the_guard_stops_the_loss_of_many),
    };
    return cmocka_run_group_tests(tests, NULL, hub_rig_end);
}
