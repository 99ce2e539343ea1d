#include "tests/firmware/appliance/access_rig.h"

#include <stdio.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

const char *access_rig_always(const char *level, bool two_people, const char *members)
{
    static char text[2000];
    (void)snprintf(
        text, sizeof text,
        "{\"schedules\": [{\"token\": \"always\", \"zone\": \"Etc/UTC\", \"weekly\": "
        "{\"sunday-saturday\": [\"00:00-24:00\"]}}],"
        " \"areas\": [{\"token\": \"out\"}, {\"token\": \"in\"}],"
        " \"security_levels\": [{\"token\": \"l\", %s}],"
        " \"authentication_profiles\": [{\"token\": \"p\", \"default_level\": \"l\", "
        "\"policies\": [%s]}],"
        " \"access_points\": [{\"token\": \"front\", \"authentication_profile\": \"p\"%s}],"
        " \"access_profiles\": [{\"token\": \"staff\", \"policies\": [{\"access_point\": "
        "\"front\", "
        "\"schedule\": \"always\"}]}],"
        " \"default_profile\": \"staff\"}",
        level,
        two_people ? "{\"schedule\": \"always\", \"active\": {\"level\": \"l\", "
                     "\"two_people\": true}}"
                   : "",
        members);
    return text;
}

uint64_t access_rig_set_policy(struct rig *rig, const char *json)
{
    struct iso_fault fault = {.text = ""};
    uint64_t revision = iso_site_access_revision(iso_appliance_access(rig->appliance));
    const int error = iso_appliance_set_policy(rig->appliance, json, revision, "asked by user 7",
                                               &revision, &fault);
    if (error) {
        fail_msg("%d %s", error, fault.text);
    }
    return revision;
}

void access_rig_set_credential(struct rig *rig, const char *person, const char *patch)
{
    struct iso_fault fault = {.text = ""};
    const int error = iso_appliance_set_credential(rig->appliance, person, patch, "asked by user 7",
                                                   &fault);
    if (error) {
        fail_msg("%d %s", error, fault.text);
    }
}

void access_rig_start(struct rig *rig, const char *policy)
{
    rig_enrol(rig, "anna", ACCESS_ANNA);
    rig_enrol(rig, "ben", ACCESS_BEN);
    rig_start(rig);
    if (*policy) {
        (void)access_rig_set_policy(rig, policy);
    }
    (void)rig_news(rig);
}

/* Somebody stands before the door for a moment. */
void access_rig_look(struct rig *rig, int face)
{
    rig_show(rig, face, face == ACCESS_STRANGER ? 30 : 3);
    rig_run(rig, face == ACCESS_STRANGER ? 1100 : 200);
}

/* Somebody comes; then nobody is there for a while, so that the next visit begins anew. */
static const char *visit(struct rig *rig, int face)
{
    static char news[4096];
    access_rig_look(rig, face);
    rig_run(rig, 12000);
    (void)snprintf(news, sizeof news, "%s", rig_news(rig));
    return news;
}

void access_rig_expect(const char *news, const char *part)
{
    if (!strstr(news, part)) {
        fail_msg("'%s' lacks '%s'", news, part);
    }
}

void access_rig_expect_visit(struct rig *rig, int face, const char *part)
{
    access_rig_expect(visit(rig, face), part);
}

void access_rig_show_card(struct rig *rig, const char *text)
{
    struct iso_card_number card;
    assert_int_equal(iso_card_number_read(text, &card), 0);
    iso_appliance_card(rig->appliance, &card);
}

void access_rig_type(struct rig *rig, const char *keys)
{
    for (; *keys; keys++) {
        iso_appliance_key(rig->appliance, *keys);
    }
}

void access_rig_restart(struct rig *rig)
{
    iso_appliance_stop(rig->appliance);
    iso_appliance_free(rig->appliance);
    rig->appliance = NULL;
    assert_int_equal(iso_appliance_new(&rig->borrowed, &rig->appliance), 0);
    rig_start(rig);
}
