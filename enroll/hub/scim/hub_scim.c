/* Which request does what. */
#include "enroll/hub/scim/hub_scim.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "enroll/hub/scim/scim_json.h"
#include "enroll/hub/scim/scim_token.h"

/* A request on its way. */
struct work {
    struct hub_store *store;
    const struct hub_scim_request *request;
    json_t *body;  /* NULL: none, or it cannot be read */
    bool is_group; /* else a user */
    bool has_id;   /* of one resource */
    bool is_new;   /* it is made */
    struct iso_fleet_id id;
    json_t *list;    /* of resources */
    json_t *out;     /* the answer */
    int64_t version; /* of the answer; 0: it is a list */
};

bool hub_scim_changes(const char *method)
{
    return strcmp(method, "GET") != 0;
}

static const char *asked(const struct work *w, const char *name)
{
    return w->request->query(w->request->context, name);
}

static int no_memory(struct iso_fault *fault)
{
    return iso_fault_set(fault, -ENOMEM, "SCIM: no memory");
}

/* ---- reading ---- */

/* Whether a list such as "userName, members" has an attribute. */
static bool lists(const char *list, const char *attribute)
{
    char name[SCIM_TEXT_SIZE];

    while (list && *list) {
        const size_t n = strcspn(list, ", ");
        if (scim_attribute_take(list, n, name) == 0 && strcmp(name, attribute) == 0) {
            return true;
        }
        list += n;
        list += strspn(list, ", ");
    }
    return false;
}

/* Whether the groups of users or the members of groups are wanted: attributes= names what, and
 * excludedAttributes= what not. */
static bool wants_related(const struct work *w)
{
    const char *name = w->is_group ? "members" : "groups";
    const char *only = asked(w, "attributes");

    return only ? lists(only, name) : !lists(asked(w, "excludedAttributes"), name);
}

static int add(struct work *w, json_t *resource, const struct scim_row *row)
{
    w->version = row->version;
    return resource && json_array_append_new(w->list, resource) == 0 ? 0 : -ENOMEM;
}

static int add_user(void *context, const struct scim_user *user, const struct scim_row *row)
{
    struct work *w = context;

    return add(w, hub__scim_user_resource(w->request->base, user, row), row);
}

static int add_group(void *context, const struct scim_group *group, const struct scim_row *row)
{
    struct work *w = context;

    return add(w, hub__scim_group_resource(w->request->base, group, row, wants_related(w)), row);
}

static int read_page(struct work *w, struct scim_page *page, int64_t *total,
                     struct iso_fault *fault)
{
    int error;

    page->related = wants_related(w);
    json_decref(w->list);
    w->list = json_array();
    error = w->is_group ? hub__scim_groups_each(w->store, page, total, add_group, w, fault)
                        : hub__scim_users_each(w->store, page, total, add_user, w, fault);
    return error == -ENOMEM ? no_memory(fault) : error;
}

/* The resource of the request, as the answer. */
static int show(struct work *w, struct iso_fault *fault)
{
    struct scim_page page = {.start = 1, .count = 1, .filter = {.n = 1}};
    int64_t total = 0;

    (void)strcpy(page.filter.terms[0].attribute, "id");
    (void)iso_fleet_id_text(&w->id, page.filter.terms[0].value);
    const int error = read_page(w, &page, &total, fault);
    if (error || total == 0) {
        return error ? error : iso_fault_set(fault, -ENOENT, "there is no such resource");
    }
    w->out = json_incref(json_array_get(w->list, 0));
    return 0;
}

/* A number of the query; what is smaller than `least` counts as it. */
static int number_of(const struct work *w, const char *name, int64_t least, int64_t most,
                     int64_t otherwise, int64_t *out, struct iso_fault *fault)
{
    const char *text = asked(w, name);
    char *end = NULL;

    *out = otherwise;
    if (!text) {
        return 0;
    }
    errno = 0;
    const long long value = strtoll(text, &end, 10);
    if (end == text || *end || errno) {
        return iso_fault_set(fault, -EINVAL, "%s has to be a whole number", name);
    }
    *out = value < least ? least : value > most ? most : value;
    return 0;
}

static int list(struct work *w, struct iso_fault *fault)
{
    struct scim_page page = {.start = 1};
    const char *filter = asked(w, "filter");
    int64_t total = 0;
    int error = filter ? scim_filter_read(filter, &page.filter, fault) : 0;

    error = error ? error : number_of(w, "startIndex", 1, INT32_MAX, 1, &page.start, fault);
    error = error ? error : number_of(w, "count", 0, HUB_SCIM_PAGE_MOST, 100, &page.count, fault);
    error = error ? error : read_page(w, &page, &total, fault);
    w->version = 0;
    w->out = error ? NULL : hub__scim_list(json_incref(w->list), total, page.start);
    return error || w->out ? error : no_memory(fault);
}

/* ---- changing ---- */

/* The version of the resource that the client has seen, if it says one. */
static int check_version(const struct work *w, int64_t version, struct iso_fault *fault)
{
    char now[40];
    const char *seen = w->request->if_match;

    (void)snprintf(now, sizeof now, "W/\"%" PRId64 "\"", version);
    /* "3" and W/"3" are the same version. */
    return !seen || strcmp(seen, "*") == 0 || strcmp(seen, now) == 0 || strcmp(seen, now + 2) == 0
               ? 0
               : iso_fault_set(fault, -ECANCELED, "the resource has changed meanwhile");
}

static int put_user(struct work *w, struct iso_fault *fault)
{
    struct scim_user before = {.active = false}, user;
    struct scim_row row = {.version = 0};
    int error = w->is_new ? 0 : hub__scim_user_load(w->store, &w->id, &before, &row, fault);

    error = error || w->is_new ? error : check_version(w, row.version, fault);
    if (error) {
        return error;
    }
    user = before;
    error = strcmp(w->request->method, "PATCH") == 0
                ? scim_user_patch(w->body, &user, fault)
                : scim_user_read(w->body, w->is_new ? NULL : &before, &user, fault);
    return error ? error : hub__scim_user_store(w->store, &w->id, &user, w->is_new, fault);
}

/* A copy whose members are its own. */
static int copy_group(const struct scim_group *from, struct scim_group *out,
                      struct iso_fault *fault)
{
    const struct scim_ids none = {.n = 0};

    *out = *from;
    return scim_ids_without(&from->members, &none, &out->members) ? no_memory(fault) : 0;
}

static int put_group(struct work *w, struct iso_fault *fault)
{
    struct scim_group before = {.display = ""}, group = {.display = ""};
    struct scim_row row = {.version = 0};
    int error = w->is_new ? 0 : hub__scim_group_load(w->store, &w->id, &before, &row, fault);

    error = error || w->is_new ? error : check_version(w, row.version, fault);
    if (!error && strcmp(w->request->method, "PATCH") == 0) {
        error = copy_group(&before, &group, fault);
        error = error ? error : scim_group_patch(w->body, &group, fault);
    } else if (!error) {
        error = scim_group_read(w->body, &group, fault);
    }
    error = error ? error
                  : hub__scim_group_store(w->store, &w->id, &group, w->is_new ? NULL : &before,
                                          fault);
    scim_ids_free(&group.members);
    scim_ids_free(&before.members);
    return error;
}

static int remove_one(struct work *w, struct iso_fault *fault)
{
    struct scim_user user;
    struct scim_group group = {.display = ""};
    struct scim_row row = {.version = 0};
    int error = w->is_group ? hub__scim_group_load(w->store, &w->id, &group, &row, fault)
                            : hub__scim_user_load(w->store, &w->id, &user, &row, fault);

    scim_ids_free(&group.members);
    error = error ? error : check_version(w, row.version, fault);
    if (error) {
        return error;
    }
    return w->is_group ? hub__scim_group_delete(w->store, &w->id, fault)
                       : hub__scim_user_delete(w->store, &w->id, fault);
}

static int change(void *context, struct iso_fault *fault)
{
    struct work *w = context;
    const bool removes = strcmp(w->request->method, "DELETE") == 0;
    int error = hub__scim_lock(w->store, fault);

    if (!error && removes) {
        error = remove_one(w, fault);
    } else if (!error) {
        error = w->is_group ? put_group(w, fault) : put_user(w, fault);
    }
    error = error ? error : hub__scim_guard(w->store, fault);
    json_decref(w->out);
    w->out = NULL;
    return error || removes ? error : show(w, fault);
}

static int change_all(struct work *w, struct iso_fault *fault)
{
    struct iso_fault ignored;
    const int error = hub_db_transaction(w->store->db, HUB_READ_COMMITTED, change, w, fault);

    if (error == -EPERM) {
        (void)!hub__scim_guard_record(w->store, fault->text, &ignored);
    }
    return error;
}

/* ---- paths ---- */

/* Reads "Users", "Users/ID" and the same of groups. False: it is another path. */
static bool read_path(struct work *w)
{
    const char *path = w->request->path;
    const size_t n = strcspn(path, "/");

    w->is_group = n == strlen("Groups") && strncasecmp(path, "Groups", n) == 0;
    w->has_id = path[n] == '/';
    return (w->is_group || (n == strlen("Users") && strncasecmp(path, "Users", n) == 0)) &&
           (!w->has_id || iso_fleet_id_read(path + n + 1, &w->id) == 0);
}

static int read_body(struct work *w, struct iso_fault *fault)
{
    w->body = json_loadb(w->request->body ? w->request->body : "", w->request->size,
                         JSON_REJECT_DUPLICATES, NULL);
    return json_is_object(w->body) ? 0
                                   : iso_fault_set(fault, -EBADMSG, "the body is no JSON object");
}

static int answer_resource(struct work *w, struct iso_fault *fault)
{
    const char *method = w->request->method;
    const bool puts = strcmp(method, "PUT") == 0 || strcmp(method, "PATCH") == 0;

    if (strcmp(method, "GET") == 0) {
        return w->has_id ? show(w, fault) : list(w, fault);
    }
    w->is_new = strcmp(method, "POST") == 0 && !w->has_id;
    if (w->is_new) {
        w->id = iso_fleet_id_random();
    } else if (!w->has_id || (!puts && strcmp(method, "DELETE") != 0)) {
        return iso_fault_set(fault, -EOPNOTSUPP, "this path has no method %.16s", method);
    }
    const int error = w->is_new || puts ? read_body(w, fault) : 0;
    return error ? error : change_all(w, fault);
}

static int answer_constant(struct work *w, struct iso_fault *fault)
{
    const char *path = w->request->path;
    char name[32];
    const size_t n = strcspn(path, "/");

    (void)snprintf(name, sizeof name, "%.*s", (int)(n < sizeof name ? n : 0), path);
    w->out = hub__scim_constant(name, path[n] ? path + n + 1 : "");
    if (!w->out) {
        return iso_fault_set(fault, -ENOENT, "there is nothing at this path");
    }
    return strcmp(w->request->method, "GET") == 0
               ? 0
               : iso_fault_set(fault, -EOPNOTSUPP, "this path can only be read");
}

static int answer(struct work *w, struct hub_scim_reply *reply, struct iso_fault *fault)
{
    int error = hub__scim_token_use(w->store, w->request->token, fault);

    reply->is_stranger = error == -EACCES;
    if (error) {
        return error;
    }
    return read_path(w) ? answer_resource(w, fault) : answer_constant(w, fault);
}

static void describe(struct work *w, struct hub_scim_reply *reply)
{
    const char *known = w->request->if_none_match;
    const char *location = json_string_value(
        json_object_get(json_object_get(w->out, "meta"), "location"));

    reply->status = w->is_new ? 201 : w->out ? 200 : 204;
    if (w->version > 0 && w->out) {
        (void)snprintf(reply->etag, sizeof reply->etag, "W/\"%" PRId64 "\"", w->version);
        (void)snprintf(reply->location, sizeof reply->location, "%s", location ? location : "");
    }
    if (known && *reply->etag && strcmp(known, reply->etag) == 0 &&
        !hub_scim_changes(w->request->method)) {
        reply->status = 304;
        return;
    }
    reply->text = w->out ? json_dumps(w->out, JSON_COMPACT) : NULL;
}

void hub_scim_answer(struct hub_store *store, const struct hub_scim_request *request,
                     struct hub_scim_reply *reply)
{
    struct work w = {.store = store, .request = request};
    struct iso_fault fault = {.text = ""};

    *reply = (struct hub_scim_reply){.status = 500};
    int error = answer(&w, reply, &fault);
    if (!error) {
        describe(&w, reply);
        error = w.out && reply->status != 304 && !reply->text ? no_memory(&fault) : 0;
    }
    if (error) {
        hub__scim_refuse(reply, error, &fault);
    }
    json_decref(w.body);
    json_decref(w.list);
    json_decref(w.out);
}
