#include "tests/firmware/policy/document_rig.h"

#include <errno.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "core/base/fault.h"
#include "tests/firmware/policy/zone_rig.h"

static int read_zone(void *context, const char *name, struct iso_zone *out, struct iso_fault *fault)
{
    static const struct {
        const char *name;
        int32_t offset_s;
    } zones[] = {{"UTC", 0}, {"Test/East", 3600}, {"Test/West", -7200}};
    (void)context;
    for (size_t i = 0; i < sizeof zones / sizeof *zones; i++) {
        if (strcmp(name, zones[i].name) == 0) {
            zone_rig_fixed(zones[i].offset_s, out);
            (void)strcpy(out->name, name);
            return 0;
        }
    }
    return strcmp(name, "Test/Memory") == 0
               ? -ENOMEM
               : iso_fault_set(fault, -ENOENT, "there is no time zone \"%s\"", name);
}

const struct iso_zone_source document_rig_zones = {read_zone, NULL};

struct iso_policy_document *document_rig_read(const char *json)
{
    struct iso_policy_document *document = NULL;
    struct iso_fault fault = {0};
    if (iso_policy_document_read(json, strlen(json), &document_rig_zones, &document, &fault) != 0) {
        fail_msg("%s", fault.text);
    }
    return document;
}

char *document_rig_write(const struct iso_policy_document *document)
{
    char *json = NULL;
    assert_int_equal(iso_policy_document_write(document, &json, NULL), 0);
    return json;
}

static void assert_hours_equal(const struct iso_day_hours *a, const struct iso_day_hours *b)
{
    assert_int_equal(a->n, b->n);
    for (int i = 0; i < a->n; i++) {
        assert_int_equal(a->periods[i].from_min, b->periods[i].from_min);
        assert_int_equal(a->periods[i].to_min, b->periods[i].to_min);
    }
}

static void assert_times_equal(const struct iso_policy *a, const struct iso_policy *b)
{
    assert_int_equal(a->n_groups, b->n_groups);
    for (int i = 0; i < a->n_groups; i++) {
        assert_string_equal(a->groups[i].token, b->groups[i].token);
        assert_int_equal(a->groups[i].n, b->groups[i].n);
        assert_memory_equal(a->groups[i].days, b->groups[i].days, a->groups[i].n * sizeof(int32_t));
    }
    assert_int_equal(a->n_schedules, b->n_schedules);
    for (int i = 0; i < a->n_schedules; i++) {
        const struct iso_schedule *x = &a->schedules[i], *y = &b->schedules[i];
        assert_string_equal(x->token, y->token);
        assert_string_equal(a->zones[x->zone].name, b->zones[y->zone].name);
        for (int day = 0; day < 7; day++) {
            assert_hours_equal(&x->weekly[day], &y->weekly[day]);
        }
        assert_int_equal(x->n_special, y->n_special);
        for (int s = 0; s < x->n_special; s++) {
            assert_int_equal(x->special[s].group, y->special[s].group);
            assert_hours_equal(&x->special[s].hours, &y->special[s].hours);
        }
    }
}

static void assert_levels_equal(const struct iso_policy *a, const struct iso_policy *b)
{
    assert_int_equal(a->n_levels, b->n_levels);
    for (int i = 0; i < a->n_levels; i++) {
        const struct iso_security_level *x = &a->levels[i], *y = &b->levels[i];
        assert_string_equal(x->token, y->token);
        assert_int_equal(x->open, y->open);
        assert_int_equal(x->priority, y->priority);
        assert_int_equal(x->n_groups, y->n_groups);
        assert_memory_equal(x->groups, y->groups, x->n_groups);
    }
    assert_int_equal(a->n_authentication_profiles, b->n_authentication_profiles);
    for (int i = 0; i < a->n_authentication_profiles; i++) {
        const struct iso_authentication_profile *x = &a->authentication_profiles[i],
                                                *y = &b->authentication_profiles[i];
        assert_string_equal(x->token, y->token);
        assert_int_equal(x->default_level, y->default_level);
        assert_int_equal(x->n_policies, y->n_policies);
        for (int p = 0; p < x->n_policies; p++) {
            assert_int_equal(x->policies[p].schedule, y->policies[p].schedule);
            for (int s = 0; s < ISO_SCHEDULE_STATES; s++) {
                assert_int_equal(x->policies[p].constraints[s].level,
                                 y->policies[p].constraints[s].level);
                assert_int_equal(x->policies[p].constraints[s].dual,
                                 y->policies[p].constraints[s].dual);
            }
        }
    }
}

static void assert_places_equal(const struct iso_policy *a, const struct iso_policy *b)
{
    assert_int_equal(a->n_areas, b->n_areas);
    for (int i = 0; i < a->n_areas; i++) {
        assert_string_equal(a->areas[i].token, b->areas[i].token);
    }
    assert_int_equal(a->n_access_points, b->n_access_points);
    for (int i = 0; i < a->n_access_points; i++) {
        const struct iso_access_point *x = &a->access_points[i], *y = &b->access_points[i];
        assert_string_equal(x->token, y->token);
        assert_int_equal(x->enabled, y->enabled);
        assert_int_equal(x->from, y->from);
        assert_int_equal(x->to, y->to);
        assert_int_equal(x->authentication_profile, y->authentication_profile);
        assert_int_equal(x->antipassback, y->antipassback);
        assert_int_equal(x->antipassback_s, y->antipassback_s);
    }
    assert_int_equal(a->n_access_profiles, b->n_access_profiles);
    for (int i = 0; i < a->n_access_profiles; i++) {
        const struct iso_access_profile *x = &a->access_profiles[i], *y = &b->access_profiles[i];
        assert_string_equal(x->token, y->token);
        assert_int_equal(x->n_policies, y->n_policies);
        for (int p = 0; p < x->n_policies; p++) {
            assert_int_equal(x->policies[p].access_point, y->policies[p].access_point);
            assert_int_equal(x->policies[p].schedule, y->policies[p].schedule);
        }
    }
}

void document_rig_assert_equal(const struct iso_policy *a, const struct iso_policy *b)
{
    assert_times_equal(a, b);
    assert_levels_equal(a, b);
    assert_places_equal(a, b);
}
