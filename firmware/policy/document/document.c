#include "firmware/policy/document/document.h"

#include <assert.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

static const char *const group_members[] = {"token", "days", NULL};
static const char *const schedule_members[] = {"token", "zone", "weekly", "special_days", NULL};
static const char *const area_members[] = {"token", NULL};
static const char *const level_members[] = {"token", "priority", "recognition_groups", "open",
                                            NULL};
static const char *const authentication_members[] = {"token", "default_level", "policies", NULL};
static const char *const point_members[] = {
    "token",        "enabled",        "from", "to", "authentication_profile",
    "antipassback", "antipassback_s", NULL};
static const char *const profile_members[] = {"token", "policies", NULL};

const struct iso__kind iso__kinds[ISO__KINDS] = {
    [ISO__GROUP] = {"special_day_groups", "special_day_group", "special day group",
                    sizeof(struct iso_special_day_group), group_members, iso__read_group,
                    iso__write_group},
    [ISO__SCHEDULE] = {"schedules", "schedule", "schedule", sizeof(struct iso_schedule),
                       schedule_members, iso__read_schedule, iso__write_schedule},
    [ISO__AREA] = {"areas", "area", "area", sizeof(struct iso_area), area_members, iso__read_area,
                   iso__write_area},
    [ISO__LEVEL] = {"security_levels", "security_level", "security level",
                    sizeof(struct iso_security_level), level_members, iso__read_level,
                    iso__write_level},
    [ISO__AUTHENTICATION] = {"authentication_profiles", "authentication_profile",
                             "authentication profile", sizeof(struct iso_authentication_profile),
                             authentication_members, iso__read_authentication,
                             iso__write_authentication},
    [ISO__POINT] = {"access_points", "access_point", "access point",
                    sizeof(struct iso_access_point), point_members, iso__read_point,
                    iso__write_point},
    [ISO__PROFILE] = {"access_profiles", "access_profile", "access profile",
                      sizeof(struct iso_access_profile), profile_members, iso__read_profile,
                      iso__write_profile},
};

/* iso__document_token() relies on this. */
static_assert(offsetof(struct iso_special_day_group, token) == 0, "begins with the token");
static_assert(offsetof(struct iso_schedule, token) == 0, "begins with the token");
static_assert(offsetof(struct iso_area, token) == 0, "begins with the token");
static_assert(offsetof(struct iso_security_level, token) == 0, "begins with the token");
static_assert(offsetof(struct iso_authentication_profile, token) == 0, "begins with the token");
static_assert(offsetof(struct iso_access_point, token) == 0, "begins with the token");
static_assert(offsetof(struct iso_access_profile, token) == 0, "begins with the token");

const char iso__face_token[] = "face";
const char *const iso__method_words[3] = {"face", "card", "pin"};
const char *const iso__antipassback_words[4] = {"none", "soft", "hard", "timed"};
const char *const iso__state_words[ISO_SCHEDULE_STATES] = {
    [ISO_SCHEDULE_INACTIVE] = "inactive",
    [ISO_SCHEDULE_ACTIVE] = "active",
    [ISO_SCHEDULE_SPECIAL] = "special_inactive",
    [ISO_SCHEDULE_SPECIAL_ACTIVE] = "special_active"};

const char *iso__document_token(const struct iso_policy_document *document, enum iso__kind_id kind,
                                uint16_t index)
{
    return (const char *)document->records[kind] + index * iso__kinds[kind].size;
}

uint16_t iso__document_find(const struct iso_policy_document *document, enum iso__kind_id kind,
                            const char *token)
{
    for (uint16_t i = 0; i < document->n[kind]; i++) {
        if (strcmp(iso__document_token(document, kind, i), token) == 0) {
            return i;
        }
    }
    return ISO_INDEX_NONE;
}

const struct iso_policy *iso_policy_document_policy(const struct iso_policy_document *document)
{
    return &document->policy;
}

void iso_policy_document_free(struct iso_policy_document *document)
{
    if (!document) {
        return;
    }
    for (enum iso__kind_id kind = ISO__GROUP; kind < ISO__KINDS; kind++) {
        free(document->records[kind]);
    }
    free(document->zones);
    free(document);
}

uint16_t iso_policy_document_access_point(const struct iso_policy_document *document,
                                          const char *token)
{
    return iso__document_find(document, ISO__POINT, token);
}

uint16_t iso_policy_document_access_profile(const struct iso_policy_document *document,
                                            const char *token)
{
    return iso__document_find(document, ISO__PROFILE, token);
}

uint16_t iso_policy_document_default_profile(const struct iso_policy_document *document)
{
    return document->default_profile;
}
