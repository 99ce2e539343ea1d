#include "enroll/hub/scim/scim_json.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* What the errors of this room and of the store are for a client. */
static const struct {
    int error;
    unsigned status;
    const char *type; /* scimType; NULL: none */
} answers[] = {
    {-EBADMSG, 400, "invalidSyntax"},
    {-EINVAL, 400, "invalidValue"},
    {-E2BIG, 400, "invalidValue"},
    {-ENXIO, 400, "invalidPath"},
    {-EDOM, 400, "invalidFilter"},
    {-EACCES, 401, NULL},
    {-ENOENT, 404, NULL},
    {-EOPNOTSUPP, 405, NULL},
    {-EEXIST, 409, "uniqueness"},
    {-ECANCELED, 412, NULL},
    {-EPERM, 429, NULL},
    {-ESTALE, 503, NULL},
    {-ENOTCONN, 503, NULL},
    {-EAGAIN, 503, NULL},
    {-ENOSPC, 507, NULL},
};

static void time_text(int64_t time_s, char text[32])
{
    const time_t time = time_s;
    struct tm utc;

    if (!gmtime_r(&time, &utc) || strftime(text, 32, "%Y-%m-%dT%H:%M:%SZ", &utc) == 0) {
        text[0] = '\0';
    }
}

/* Adds "id", "schemas" and "meta". */
static json_t *complete(json_t *json, const char *base, const char *type,
                        const struct scim_row *row, json_t *schemas)
{
    char id[ISO_FLEET_ID_TEXT_SIZE], made[32], changed[32], version[40], location[320];

    (void)iso_fleet_id_text(&row->id, id);
    time_text(row->made_s, made);
    time_text(row->changed_s, changed);
    (void)snprintf(version, sizeof version, "W/\"%" PRId64 "\"", row->version);
    (void)snprintf(location, sizeof location, "%s/%ss/%s", base, type, id);
    json_t *meta = json_pack("{s:s, s:s, s:s, s:s, s:s}", "resourceType", type, "created", made,
                             "lastModified", changed, "location", location, "version", version);
    const bool ok = json && json_object_set_new(json, "id", json_string(id)) == 0 &&
                    json_object_set(json, "schemas", schemas) == 0 &&
                    json_object_set(json, "meta", meta) == 0;
    json_decref(schemas);
    json_decref(meta);
    if (!ok) {
        json_decref(json);
        return NULL;
    }
    return json;
}

json_t *hub__scim_user_resource(const char *base, const struct scim_user *user,
                                const struct scim_row *row)
{
    json_t *json = scim_user_json(user);
    json_t *groups = json_loads(row->related, 0, NULL);
    const bool extended = json_object_get(json, SCIM_EXTENSION_USER) != NULL;
    json_t *schemas = extended ? json_pack("[s, s]", SCIM_CORE "User", SCIM_EXTENSION_USER)
                               : json_pack("[s]", SCIM_CORE "User");

    if (json_object_set_new(json, "groups", groups)) {
        json_decref(json);
        json = NULL;
    }
    return complete(json, base, "User", row, schemas);
}

json_t *hub__scim_group_resource(const char *base, const struct scim_group *group,
                                 const struct scim_row *row, bool with_members)
{
    json_t *json = json_pack("{s:s}", "displayName", group->display);
    bool ok = json != NULL;

    if (*group->external) {
        ok = ok && json_object_set_new(json, "externalId", json_string(group->external)) == 0;
    }
    if (with_members) {
        ok = ok && json_object_set_new(json, "members", json_loads(row->related, 0, NULL)) == 0;
    }
    if (!ok) {
        json_decref(json);
        json = NULL;
    }
    return complete(json, base, "Group", row, json_pack("[s]", SCIM_CORE "Group"));
}

json_t *hub__scim_list(json_t *resources, int64_t total, int64_t start)
{
    return json_pack("{s:[s], s:I, s:I, s:I, s:o}", "schemas",
                     "urn:ietf:params:scim:api:messages:2.0:ListResponse", "totalResults",
                     (json_int_t)total, "startIndex", (json_int_t)start, "itemsPerPage",
                     (json_int_t)json_array_size(resources), "Resources", resources);
}

json_t *hub__scim_constant(const char *name, const char *id)
{
    json_t *document = json_loads((const char *)hub__scim_document, 0, NULL);
    json_t *part = json_incref(json_object_get(document, name)), *found = NULL, *item;
    size_t i;

    json_decref(document);
    if (!json_is_array(part)) {
        found = *id ? NULL : json_incref(part);
    } else if (!*id) {
        found = hub__scim_list(json_incref(part), (int64_t)json_array_size(part), 1);
    }
    json_array_foreach(part, i, item)
    {
        if (*id && strcmp(json_string_value(json_object_get(item, "id")), id) == 0) {
            found = json_incref(item);
        }
    }
    json_decref(part);
    return found;
}

void hub__scim_refuse(struct hub_scim_reply *reply, int error, const struct iso_fault *fault)
{
    char status[8];
    unsigned number = 500;
    const char *type = NULL, *detail = fault->text;

    for (size_t i = 0; i < sizeof answers / sizeof *answers; i++) {
        if (answers[i].error == error) {
            number = answers[i].status;
            type = answers[i].type;
        }
    }
    if (number >= 500 || error == -EPERM) {
        reply->trouble = *fault;
    }
    if (number == 500) {
        detail = "the hub could not do it; its log says why";
    }
    reply->status = number;
    reply->retry_s = error == -EPERM ? 900 : number == 503 ? 30 : 0;
    (void)snprintf(status, sizeof status, "%u", number);
    json_t *json = json_pack("{s:[s], s:s, s:s, s:s*}", "schemas",
                             "urn:ietf:params:scim:api:messages:2.0:Error", "status", status,
                             "detail", detail, "scimType", type);
    free(reply->text);
    reply->text = json ? json_dumps(json, JSON_COMPACT) : NULL;
    json_decref(json);
}
