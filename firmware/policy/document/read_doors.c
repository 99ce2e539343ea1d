/* Areas, security levels, authentication profiles, access points and access profiles. */
#include <errno.h>
#include <string.h>

#include "firmware/policy/document/reader.h"

int iso__read_area(struct iso__reader *reader, const json_t *object, void *record)
{
    (void)reader, (void)object, (void)record; /* an area is its token */
    return 0;
}

/* The position of a text in a list of n words, or -1. */
static int word_at(const char *text, const char *const *words, int n)
{
    int i = 0;
    while (i < n && (!text || strcmp(text, words[i]) != 0)) {
        i++;
    }
    return i < n ? i : -1;
}

static int read_recognition_group(const struct iso__reader *reader, const json_t *list,
                                  uint8_t *out)
{
    if (!json_is_array(list)) {
        return iso__reader_refuse(reader, "a recognition group is not an array");
    }
    uint8_t methods = 0;
    size_t i;
    json_t *part;
    json_array_foreach(list, i, part)
    {
        const char *text = json_string_value(part);
        const int method = word_at(text, iso__method_words, 3);
        if (method < 0) {
            return iso__reader_refuse(reader, "\"%.*s\" is none of \"face\", \"card\" and \"pin\"",
                                      iso__quoted(text), text ? text : "");
        }
        if ((methods >> method & 1) != 0) {
            return iso__reader_refuse(reader, "a recognition group has \"%s\" twice", text);
        }
        methods |= (uint8_t)(1U << method);
    }
    *out = methods;
    return 0;
}

int iso__read_level(struct iso__reader *reader, const json_t *object, void *record)
{
    struct iso_security_level *level = record;
    const json_t *groups = NULL;
    level->priority = (int32_t)reader->number;
    int error = iso__reader_number(reader, object, "priority", &level->priority);
    error = error != 0 ? error : iso__reader_truth(reader, object, "open", &level->open);
    error = error != 0 ? error
                       : iso__reader_list(reader, object, "recognition_groups",
                                          ISO_RECOGNITION_GROUPS_MAX, &groups);
    size_t i;
    json_t *part;
    json_array_foreach(groups, i, part)
    {
        error = error != 0 ? error : read_recognition_group(reader, part, &level->groups[i]);
        level->n_groups++;
    }
    return error;
}

/* Reads what one state of a schedule asks for. *out is as it was if the state is not given. */
static int read_constraint(const struct iso__reader *reader, const json_t *policy,
                           const char *state, struct iso_level_constraint *out)
{
    static const char *const members[] = {"level", "two_people", NULL};
    const json_t *value = json_object_get(policy, state);
    struct iso_level_constraint constraint = {.level = ISO_INDEX_NONE};
    if (!value) {
        return 0;
    }
    int error = 0;
    if (!json_is_null(value)) {
        error = iso__reader_members(reader, state, value, members);
        error = error != 0 ? error
                           : iso__reader_reference(reader, value, "level", ISO__LEVEL, true,
                                                   &constraint.level);
        error = error != 0 ? error
                           : iso__reader_truth(reader, value, "two_people", &constraint.dual);
    }
    if (error == 0) {
        *out = constraint;
    }
    return error;
}

static int read_authentication_policy(const struct iso__reader *reader, const json_t *object,
                                      struct iso_authentication_policy *policy)
{
    static const char *const members[] = {"schedule",         "inactive",       "active",
                                          "special_inactive", "special_active", NULL};
    int error = iso__reader_members(reader, "an entry of \"policies\"", object, members);
    error = error != 0 ? error
                       : iso__reader_reference(reader, object, "schedule", ISO__SCHEDULE, true,
                                               &policy->schedule);
    for (int s = 0; error == 0 && s < ISO_SCHEDULE_STATES; s++) {
        /* The same state on other days, which was read before. */
        policy->constraints[s] = (s & ISO_SCHEDULE_SPECIAL) != 0
                                     ? policy->constraints[s & ~ISO_SCHEDULE_SPECIAL]
                                     : (struct iso_level_constraint){.level = ISO_INDEX_NONE};
        error = read_constraint(reader, object, iso__state_words[s], &policy->constraints[s]);
    }
    return error;
}

int iso__read_authentication(struct iso__reader *reader, const json_t *object, void *record)
{
    struct iso_authentication_profile *profile = record;
    const json_t *policies = NULL;
    int error = iso__reader_reference(reader, object, "default_level", ISO__LEVEL, true,
                                      &profile->default_level);
    error = error != 0 ? error
                       : iso__reader_list(reader, object, "policies",
                                          ISO_AUTHENTICATION_POLICIES_MAX, &policies);
    size_t i;
    json_t *part;
    json_array_foreach(policies, i, part)
    {
        error = error != 0 ? error
                           : read_authentication_policy(reader, part, &profile->policies[i]);
        profile->n_policies++;
    }
    return error;
}

int iso__read_point(struct iso__reader *reader, const json_t *object, void *record)
{
    struct iso_access_point *point = record;
    const char *antipassback = "none";
    point->enabled = true;
    point->from = point->to = ISO_INDEX_NONE;
    /* The reader has added this profile if an access point needs it. */
    point->authentication_profile = (uint16_t)json_integer_value(
        json_object_get(reader->indices[ISO__AUTHENTICATION], iso__face_token));
    int error = iso__reader_truth(reader, object, "enabled", &point->enabled);
    error = error != 0
                ? error
                : iso__reader_reference(reader, object, "from", ISO__AREA, false, &point->from);
    error = error != 0 ? error
                       : iso__reader_reference(reader, object, "to", ISO__AREA, false, &point->to);
    error = error != 0
                ? error
                : iso__reader_reference(reader, object, "authentication_profile",
                                        ISO__AUTHENTICATION, false, &point->authentication_profile);
    error = error != 0 ? error : iso__reader_text(reader, object, "antipassback", &antipassback);
    error = error != 0
                ? error
                : iso__reader_number(reader, object, "antipassback_s", &point->antipassback_s);
    const int kind = word_at(antipassback, iso__antipassback_words, 4);
    if (error == 0 && kind < 0) {
        return iso__reader_refuse(
            reader, "antipassback: \"%.*s\" is none of \"none\", \"soft\", \"hard\" and \"timed\"",
            iso__quoted(antipassback), antipassback);
    }
    point->antipassback = (uint8_t)(kind < 0 ? 0 : kind);
    return error;
}

int iso__read_profile(struct iso__reader *reader, const json_t *object, void *record)
{
    static const char *const members[] = {"access_point", "schedule", NULL};
    struct iso_access_profile *profile = record;
    const json_t *policies = NULL;
    int error = iso__reader_list(reader, object, "policies", ISO_ACCESS_POLICIES_MAX, &policies);
    size_t i;
    json_t *part;
    json_array_foreach(policies, i, part)
    {
        struct iso_access_policy *policy = &profile->policies[i];
        error = error != 0 ? error
                           : iso__reader_members(reader, "an entry of \"policies\"", part, members);
        error = error != 0 ? error
                           : iso__reader_reference(reader, part, "access_point", ISO__POINT, true,
                                                   &policy->access_point);
        error = error != 0 ? error
                           : iso__reader_reference(reader, part, "schedule", ISO__SCHEDULE, true,
                                                   &policy->schedule);
        profile->n_policies++;
    }
    return error;
}
