#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/fault.h"
#include "firmware/policy/calendar.h"
#include "firmware/policy/document/day_text.h"
#include "firmware/policy/document/document.h"

/* These return 0, or -1 without memory. They take over what they are given. */
static int put(json_t *object, const char *member, json_t *value)
{
    return json_object_set_new(object, member, value);
}

static int append(json_t *list, json_t *value)
{
    return json_array_append_new(list, value);
}

static json_t *hours_json(const struct iso_day_hours *hours)
{
    json_t *list = json_array();
    int error = list ? 0 : -1;
    for (int i = 0; error == 0 && i < hours->n; i++) {
        char text[ISO_PERIOD_TEXT_SIZE];
        iso_period_write(&hours->periods[i], text);
        error = append(list, json_string(text));
    }
    if (error != 0) {
        json_decref(list);
        return NULL;
    }
    return list;
}

int iso__write_group(const struct iso_policy *policy, const void *record, json_t *object)
{
    (void)policy;
    const struct iso_special_day_group *group = record;
    json_t *days = json_array();
    int error = put(object, "days", days);
    for (int i = 0; error == 0 && i < group->n; i++) {
        char text[ISO_DATE_TEXT_SIZE];
        iso_date_write(group->days[i], text);
        error = append(days, json_string(text));
    }
    return error;
}

static bool hours_are_equal(const struct iso_day_hours *a, const struct iso_day_hours *b)
{
    bool equal = a->n == b->n;
    for (int i = 0; equal && i < a->n; i++) {
        equal = a->periods[i].from_min == b->periods[i].from_min &&
                a->periods[i].to_min == b->periods[i].to_min;
    }
    return equal;
}

/* From Monday to Sunday; days that follow each other and have the same hours are one member. */
static json_t *weekly_json(const struct iso_schedule *schedule)
{
    json_t *weekly = json_object();
    int error = weekly ? 0 : -1;
    for (int i = 0; error == 0 && i < ISO_WEEKDAYS;) {
        const int first = (i + 1) % ISO_WEEKDAYS;
        const struct iso_day_hours *hours = &schedule->weekly[first];
        int last = first;
        for (i++; i < ISO_WEEKDAYS; i++) {
            if (!hours_are_equal(hours, &schedule->weekly[(i + 1) % ISO_WEEKDAYS])) {
                break;
            }
            last = (i + 1) % ISO_WEEKDAYS;
        }
        if (hours->n > 0) {
            char text[ISO_DAYS_TEXT_SIZE];
            iso_days_write(first, last, text);
            error = put(weekly, text, hours_json(hours));
        }
    }
    if (error != 0) {
        json_decref(weekly);
        return NULL;
    }
    return weekly;
}

static int write_special_days(const struct iso_policy *policy, const struct iso_schedule *schedule,
                              json_t *object)
{
    json_t *list = json_array();
    int error = put(object, "special_days", list);
    for (int i = 0; error == 0 && i < schedule->n_special; i++) {
        const struct iso_special_hours *special = &schedule->special[i];
        error = append(list, json_pack("{s:s, s:o}", "group", policy->groups[special->group].token,
                                       "hours", hours_json(&special->hours)));
    }
    return error;
}

int iso__write_schedule(const struct iso_policy *policy, const void *record, json_t *object)
{
    const struct iso_schedule *schedule = record;
    int error = put(object, "zone", json_string(policy->zones[schedule->zone].name));
    error = error != 0 ? error : put(object, "weekly", weekly_json(schedule));
    return error != 0 || schedule->n_special == 0 ? error
                                                  : write_special_days(policy, schedule, object);
}

int iso__write_area(const struct iso_policy *policy, const void *record, json_t *object)
{
    (void)policy, (void)record, (void)object; /* an area is its token */
    return 0;
}

static json_t *recognition_group_json(uint8_t methods)
{
    json_t *list = json_array();
    int error = list ? 0 : -1;
    for (int method = 0; error == 0 && method < 3; method++) {
        if ((methods >> method & 1) != 0) {
            error = append(list, json_string(iso__method_words[method]));
        }
    }
    if (error != 0) {
        json_decref(list);
        return NULL;
    }
    return list;
}

int iso__write_level(const struct iso_policy *policy, const void *record, json_t *object)
{
    (void)policy;
    const struct iso_security_level *level = record;
    int error = put(object, "priority", json_integer(level->priority));
    if (error == 0 && level->open) {
        error = put(object, "open", json_true());
    }
    if (error == 0 && level->n_groups > 0) {
        json_t *groups = json_array();
        error = put(object, "recognition_groups", groups);
        for (int i = 0; error == 0 && i < level->n_groups; i++) {
            error = append(groups, recognition_group_json(level->groups[i]));
        }
    }
    return error;
}

static json_t *constraint_json(const struct iso_policy *policy,
                               const struct iso_level_constraint *constraint)
{
    if (constraint->level == ISO_INDEX_NONE) {
        return json_null();
    }
    const char *level = policy->levels[constraint->level].token;
    return constraint->dual ? json_pack("{s:s, s:b}", "level", level, "two_people", 1)
                            : json_pack("{s:s}", "level", level);
}

static json_t *authentication_policy_json(const struct iso_policy *policy,
                                          const struct iso_authentication_policy *part)
{
    static const struct iso_level_constraint none = {.level = ISO_INDEX_NONE};
    static const enum iso_schedule_state order[] = {ISO_SCHEDULE_ACTIVE, ISO_SCHEDULE_INACTIVE,
                                                    ISO_SCHEDULE_SPECIAL_ACTIVE,
                                                    ISO_SCHEDULE_SPECIAL};
    json_t *object = json_pack("{s:s}", "schedule", policy->schedules[part->schedule].token);
    int error = object ? 0 : -1;
    for (int i = 0; error == 0 && i < ISO_SCHEDULE_STATES; i++) {
        const enum iso_schedule_state state = order[i];
        const struct iso_level_constraint *constraint = &part->constraints[state];
        /* What a state asks for that is not given. */
        const struct iso_level_constraint *usual = state == ISO_SCHEDULE_SPECIAL_ACTIVE
                                                       ? &part->constraints[ISO_SCHEDULE_ACTIVE]
                                                   : state == ISO_SCHEDULE_SPECIAL
                                                       ? &part->constraints[ISO_SCHEDULE_INACTIVE]
                                                       : &none;
        if (constraint->level != usual->level || constraint->dual != usual->dual) {
            error = put(object, iso__state_words[state], constraint_json(policy, constraint));
        }
    }
    if (error != 0) {
        json_decref(object);
        return NULL;
    }
    return object;
}

int iso__write_authentication(const struct iso_policy *policy, const void *record, json_t *object)
{
    const struct iso_authentication_profile *profile = record;
    int error = put(object, "default_level",
                    json_string(policy->levels[profile->default_level].token));
    if (error == 0 && profile->n_policies > 0) {
        json_t *list = json_array();
        error = put(object, "policies", list);
        for (int i = 0; error == 0 && i < profile->n_policies; i++) {
            error = append(list, authentication_policy_json(policy, &profile->policies[i]));
        }
    }
    return error;
}

int iso__write_point(const struct iso_policy *policy, const void *record, json_t *object)
{
    const struct iso_access_point *point = record;
    int error = point->enabled ? 0 : put(object, "enabled", json_false());
    if (error == 0 && point->from != ISO_INDEX_NONE) {
        error = put(object, "from", json_string(policy->areas[point->from].token));
    }
    if (error == 0 && point->to != ISO_INDEX_NONE) {
        error = put(object, "to", json_string(policy->areas[point->to].token));
    }
    if (error == 0) {
        error = put(
            object, "authentication_profile",
            json_string(policy->authentication_profiles[point->authentication_profile].token));
    }
    if (error == 0 && point->antipassback != ISO_ANTIPASSBACK_NONE) {
        error = put(object, "antipassback",
                    json_string(iso__antipassback_words[point->antipassback]));
    }
    if (error == 0 && point->antipassback == ISO_ANTIPASSBACK_TIMED) {
        error = put(object, "antipassback_s", json_integer(point->antipassback_s));
    }
    return error;
}

int iso__write_profile(const struct iso_policy *policy, const void *record, json_t *object)
{
    const struct iso_access_profile *profile = record;
    json_t *list = json_array();
    int error = put(object, "policies", list);
    for (int i = 0; error == 0 && i < profile->n_policies; i++) {
        const struct iso_access_policy *part = &profile->policies[i];
        error = append(list, json_pack("{s:s, s:s}", "access_point",
                                       policy->access_points[part->access_point].token, "schedule",
                                       policy->schedules[part->schedule].token));
    }
    return error;
}

json_t *iso__document_record(const struct iso_policy_document *document, enum iso__kind_id kind,
                             uint16_t index)
{
    const char *token = iso__document_token(document, kind, index);
    json_t *object = json_pack("{s:s}", "token", token);
    if (object && iso__kinds[kind].write(&document->policy, token, object) != 0) {
        json_decref(object);
        return NULL;
    }
    return object;
}

char *iso__document_dump(const json_t *value)
{
    enum { FLAGS = JSON_COMPACT | JSON_ENCODE_ANY };
    const size_t size = json_dumpb(value, NULL, 0, FLAGS);
    char *text = size > 0 ? malloc(size + 1) : NULL;
    if (!text) {
        return NULL;
    }
    if (json_dumpb(value, text, size, FLAGS) != size) {
        free(text);
        return NULL;
    }
    text[size] = '\0';
    return text;
}

static int write_root(const struct iso_policy_document *document, json_t *root)
{
    int error = 0;
    for (enum iso__kind_id kind = ISO__GROUP; error == 0 && kind < ISO__KINDS; kind++) {
        json_t *list = NULL;
        if (document->n[kind] > 0) {
            list = json_array();
            error = put(root, iso__kinds[kind].array, list);
        }
        for (uint16_t i = 0; error == 0 && i < document->n[kind]; i++) {
            error = append(list, iso__document_record(document, kind, i));
        }
    }
    if (error == 0 && document->default_profile != ISO_INDEX_NONE) {
        error = put(
            root, "default_profile",
            json_string(iso__document_token(document, ISO__PROFILE, document->default_profile)));
    }
    return error;
}

int iso_policy_document_write(const struct iso_policy_document *document, char **json,
                              struct iso_fault *fault)
{
    json_t *root = json_object();
    char *text = root && write_root(document, root) == 0 ? iso__document_dump(root) : NULL;
    json_decref(root);
    if (!text) {
        return iso_fault_set(fault, -ENOMEM, "out of memory");
    }
    if (strlen(text) > ISO_POLICY_DOCUMENT_MAX_BYTES) {
        (void)iso_fault_set(fault, -E2BIG, "policy: has %zu bytes as a document, at most %d",
                            strlen(text), ISO_POLICY_DOCUMENT_MAX_BYTES);
        free(text);
        return -E2BIG;
    }
    *json = text;
    return 0;
}
