#include "enroll/hub/scim/scim_group.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* ---- ids ---- */

void scim_ids_free(struct scim_ids *ids)
{
    free(ids->ids);
    *ids = (struct scim_ids){.n = 0};
}

static int compare(const void *a, const void *b)
{
    return memcmp(a, b, sizeof(struct iso_fleet_id));
}

void scim_ids_order(struct scim_ids *ids)
{
    size_t n = 0;

    if (ids->n == 0) {
        return;
    }
    qsort(ids->ids, ids->n, sizeof *ids->ids, compare);
    for (size_t i = 0; i < ids->n; i++) {
        if (n == 0 || compare(&ids->ids[n - 1], &ids->ids[i]) != 0) {
            ids->ids[n++] = ids->ids[i];
        }
    }
    ids->n = n;
}

static bool has(const struct scim_ids *ids, const struct iso_fleet_id *id)
{
    return ids->n > 0 && bsearch(id, ids->ids, ids->n, sizeof *ids->ids, compare);
}

int scim_ids_without(const struct scim_ids *a, const struct scim_ids *b, struct scim_ids *out)
{
    struct scim_ids rest = {.ids = calloc(a->n + 1, sizeof *rest.ids)};

    if (!rest.ids) {
        return -ENOMEM;
    }
    for (size_t i = 0; i < a->n; i++) {
        if (!has(b, &a->ids[i])) {
            rest.ids[rest.n++] = a->ids[i];
        }
    }
    *out = rest;
    return 0;
}

static int no_memory(struct iso_fault *fault)
{
    return iso_fault_set(fault, -ENOMEM, "a group: no memory");
}

static int unite(struct scim_ids *to, const struct scim_ids *more, struct iso_fault *fault)
{
    struct iso_fleet_id *both = reallocarray(to->ids, to->n + more->n + 1, sizeof *both);

    if (!both) {
        return no_memory(fault);
    }
    to->ids = both;
    if (more->n > 0) {
        memcpy(both + to->n, more->ids, more->n * sizeof *both);
    }
    to->n += more->n;
    scim_ids_order(to);
    return to->n > SCIM_MEMBERS_MOST
               ? iso_fault_set(fault, -EINVAL, "a group has at most %d members", SCIM_MEMBERS_MOST)
               : 0;
}

static int subtract(struct scim_ids *from, const struct scim_ids *less, struct iso_fault *fault)
{
    struct scim_ids rest;

    if (scim_ids_without(from, less, &rest)) {
        return no_memory(fault);
    }
    scim_ids_free(from);
    *from = rest;
    return 0;
}

/* ---- members ---- */

/* Reads {"value": ID}. What cannot be an id is no member: to be added it is refused, and to be
 * removed it is left out. */
static int take_member(const json_t *item, bool must, struct scim_ids *out, struct iso_fault *fault)
{
    const json_t *named = json_is_object(item) ? scim_member(item, "value") : item;
    const char *text = json_string_value(named);
    const char *type = json_string_value(scim_member(item, "type"));

    if (must && type && strcasecmp(type, "User") != 0) {
        return iso_fault_set(fault, -EINVAL, "a member of a group has to be a user");
    }
    if (text && iso_fleet_id_read(text, &out->ids[out->n]) == 0) {
        out->n++;
        return 0;
    }
    return must ? iso_fault_set(fault, -EINVAL, "a member has to be {\"value\": \"ID\"}") : 0;
}

/* Reads a list of members, or one. The caller frees *out also after an error. */
static int take_members(const json_t *value, bool must, struct scim_ids *out,
                        struct iso_fault *fault)
{
    const size_t n = json_is_array(value) ? json_array_size(value) : 1;
    int error = 0;

    *out = (struct scim_ids){.ids = calloc(n + 1, sizeof *out->ids)};
    if (!out->ids) {
        return no_memory(fault);
    }
    if (!value || json_is_null(value)) {
        return 0;
    }
    for (size_t i = 0; !error && i < n; i++) {
        error = take_member(json_is_array(value) ? json_array_get(value, i) : value, must, out,
                            fault);
    }
    scim_ids_order(out);
    return error;
}

static int change_members(struct scim_group *group, enum scim_op op, const json_t *value,
                          struct iso_fault *fault)
{
    struct scim_ids named = {.n = 0};
    int error = 0;

    if (op == SCIM_REMOVE && (!value || json_is_null(value))) {
        group->members.n = 0;
        return 0;
    }
    error = take_members(value, op != SCIM_REMOVE, &named, fault);
    if (!error && op == SCIM_REPLACE) {
        group->members.n = 0;
    }
    if (!error) {
        error = op == SCIM_REMOVE ? subtract(&group->members, &named, fault)
                                  : unite(&group->members, &named, fault);
    }
    scim_ids_free(&named);
    return error;
}

/* members[value eq "ID"] */
static int remove_filtered(struct scim_group *group, const struct scim_operation *operation,
                           struct iso_fault *fault)
{
    const struct scim_filter *filter = &operation->path.filter;

    if (operation->op != SCIM_REMOVE || filter->n != 1 ||
        strcmp(filter->terms[0].attribute, "value") != 0) {
        return iso_fault_set(fault, -ENXIO,
                             "members with a filter can be removed by their value alone");
    }
    json_t *value = json_string(filter->terms[0].value);
    const int error = value ? change_members(group, SCIM_REMOVE, value, fault) : no_memory(fault);
    json_decref(value);
    return error;
}

/* ---- attributes ---- */

static int set_text(const char *path, enum scim_op op, const json_t *value,
                    char out[SCIM_TEXT_SIZE], struct iso_fault *fault)
{
    if (op == SCIM_REMOVE || !value || json_is_null(value)) {
        *out = '\0';
        return 0;
    }
    if (!json_is_string(value) || json_string_length(value) >= SCIM_TEXT_SIZE) {
        return iso_fault_set(fault, -EINVAL, "%s has to be a text of at most 256 bytes", path);
    }
    (void)snprintf(out, SCIM_TEXT_SIZE, "%s", json_string_value(value));
    return 0;
}

static int set_path(struct scim_group *group, enum scim_op op, const char *path,
                    const json_t *value, struct iso_fault *fault)
{
    if (strcmp(path, "displayname") == 0) {
        return set_text("displayName", op, value, group->display, fault);
    }
    if (strcmp(path, "externalid") == 0) {
        return set_text("externalId", op, value, group->external, fault);
    }
    return strcmp(path, "members") == 0 ? change_members(group, op, value, fault) : 0;
}

static int set_all(struct scim_group *group, enum scim_op op, const json_t *object,
                   struct iso_fault *fault)
{
    const char *key;
    json_t *value;
    char path[SCIM_TEXT_SIZE];
    int error = 0;

    json_object_foreach((json_t *)(uintptr_t)object, key, value)
    {
        if (!error && scim_attribute_take(key, strlen(key), path) == 0) {
            error = set_path(group, op, path, value, fault);
        }
    }
    return error;
}

static int check(const struct scim_group *group, struct iso_fault *fault)
{
    return *group->display ? 0 : iso_fault_set(fault, -EINVAL, "displayName is missing");
}

int scim_group_read(const json_t *body, struct scim_group *out, struct iso_fault *fault)
{
    struct scim_group group = {.display = ""};
    int error = json_is_object(body) ? set_all(&group, SCIM_REPLACE, body, fault)
                                     : iso_fault_set(fault, -EBADMSG, "the body is no JSON object");

    error = error ? error : check(&group, fault);
    if (error) {
        scim_ids_free(&group.members);
        return error;
    }
    *out = group;
    return 0;
}

static int apply(void *context, const struct scim_operation *operation, struct iso_fault *fault)
{
    const struct scim_path *path = &operation->path;

    if (!operation->has_path) {
        return set_all(context, operation->op, operation->value, fault);
    }
    if (path->filter.n > 0) {
        return strcmp(path->attribute, "members") == 0 ? remove_filtered(context, operation, fault)
                                                       : 0;
    }
    return set_path(context, operation->op, path->attribute, operation->value, fault);
}

int scim_group_patch(const json_t *body, struct scim_group *group, struct iso_fault *fault)
{
    const int error = scim_patch_each(body, apply, group, fault);

    return error ? error : check(group, fault);
}
