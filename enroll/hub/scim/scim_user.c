#include "enroll/hub/scim/scim_user.h"

#include <errno.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <time.h>

#include "firmware/contract/person_name.h"

#define EXTENSION_SMALL "urn:ietf:params:scim:schemas:extension:isotherm:2.0:user"

enum kind { TEXT, SWITCH, TIME };

static const struct attribute {
    const char *path; /* in small letters */
    enum kind kind;
    size_t at;
} attributes[] = {
    {"username", TEXT, offsetof(struct scim_user, user_name)},
    {"externalid", TEXT, offsetof(struct scim_user, external)},
    {"displayname", TEXT, offsetof(struct scim_user, display)},
    {"name.formatted", TEXT, offsetof(struct scim_user, formatted)},
    {"name.givenname", TEXT, offsetof(struct scim_user, given)},
    {"name.familyname", TEXT, offsetof(struct scim_user, family)},
    {"active", SWITCH, offsetof(struct scim_user, active)},
    {EXTENSION_SMALL ":validfrom", TIME, offsetof(struct scim_user, from_s)},
    {EXTENSION_SMALL ":validuntil", TIME, offsetof(struct scim_user, until_s)},
};

enum { ATTRIBUTES = sizeof attributes / sizeof *attributes };

/* What one description or one operation changes. */
struct change {
    struct scim_user *user;
    enum scim_op op;
    unsigned seen; /* bits of the attributes that it has named */
    struct iso_fault *fault;
};

static int bad_value(const struct change *c, const char *path, const char *what)
{
    return iso_fault_set(c->fault, -EINVAL, "%.80s has to be %s", path, what);
}

/* ---- values ---- */

static int set_text(const struct change *c, const char *path, char out[SCIM_TEXT_SIZE],
                    const json_t *value)
{
    if (!value || json_is_null(value)) {
        *out = '\0';
        return 0;
    }
    if (!json_is_string(value) || json_string_length(value) >= SCIM_TEXT_SIZE) {
        return bad_value(c, path, "a text of at most 256 bytes");
    }
    (void)snprintf(out, SCIM_TEXT_SIZE, "%s", json_string_value(value));
    return 0;
}

/* Entra ID sends "True" and "False" as texts. */
static int set_switch(const struct change *c, const char *path, bool *out, const json_t *value)
{
    const char *text = json_string_value(value);

    if (json_is_boolean(value) || !value || json_is_null(value)) {
        *out = json_is_true(value);
    } else if (text && (strcasecmp(text, "true") == 0 || strcasecmp(text, "false") == 0)) {
        *out = strcasecmp(text, "true") == 0;
    } else {
        return bad_value(c, path, "true or false");
    }
    return 0;
}

/* "Z", "+01:00", "-05:30". */
static bool zone_of(const char *text, int *seconds)
{
    int hours, minutes, end = 0;
    char sign;

    *seconds = 0;
    if (strcmp(text, "Z") == 0) {
        return true;
    }
    if (sscanf(text, "%c%2d:%2d%n", &sign, &hours, &minutes, &end) != 3 || text[end] ||
        (sign != '+' && sign != '-') || hours < 0 || hours > 23 || minutes < 0 || minutes > 59) {
        return false;
    }
    *seconds = (sign == '-' ? -1 : 1) * (hours * 3600 + minutes * 60);
    return true;
}

static int set_time(const struct change *c, const char *path, int64_t *out, const json_t *value)
{
    static const char what[] = "a time such as 2026-12-31T18:00:00Z";
    struct tm utc = {0};
    int east_s;

    if (!value || json_is_null(value)) {
        *out = 0;
        return 0;
    }
    const char *text = json_string_value(value);
    const char *rest = text ? strptime(text, "%Y-%m-%dT%H:%M:%S", &utc) : NULL;
    if (rest && *rest == '.') {
        rest += 1 + strspn(rest + 1, "0123456789");
    }
    if (!rest || utc.tm_year < 70 || utc.tm_year > 8099 || !zone_of(rest, &east_s)) {
        return bad_value(c, path, what);
    }
    const int64_t time_s = timegm(&utc) - east_s;
    if (time_s <= 0) {
        return bad_value(c, path, what);
    }
    *out = time_s;
    return 0;
}

static int set(struct change *c, const struct attribute *a, const json_t *value)
{
    const unsigned bit = 1U << (a - attributes);
    char *at = (char *)c->user + a->at;

    if (c->seen & bit) {
        return iso_fault_set(c->fault, -EBADMSG, "%s is named twice", a->path);
    }
    c->seen |= bit;
    value = c->op == SCIM_REMOVE ? NULL : value;
    switch (a->kind) {
    case TEXT:
        return set_text(c, a->path, at, value);
    case SWITCH:
        return set_switch(c, a->path, (bool *)(void *)at, value);
    case TIME:
        return set_time(c, a->path, (int64_t *)(void *)at, value);
    }
    return 0;
}

/* ---- paths ---- */

/* Whether `path` names an object that contains the attribute: "name", or the URN of the extension.
 */
static bool contains(const char *path, const char *attribute)
{
    const size_t n = strlen(path);

    return strncmp(path, attribute, n) == 0 && (attribute[n] == '.' || attribute[n] == ':') &&
           (strcmp(path, "name") == 0 || strcmp(path, EXTENSION_SMALL) == 0);
}

/* Sets what an object has below a path, or removes all of it. */
static int set_below(struct change *c, const char *path, const json_t *value)
{
    int error = 0;

    if (value && !json_is_object(value) && !json_is_null(value)) {
        return bad_value(c, path, "an object");
    }
    for (size_t i = 0; !error && i < ATTRIBUTES; i++) {
        const struct attribute *a = &attributes[i];
        if (contains(path, a->path)) {
            const json_t *member = scim_member(value, a->path + strlen(path) + 1);
            error = member || c->op == SCIM_REMOVE ? set(c, a, member) : 0;
        }
    }
    return error;
}

/* Sets the attribute of a path; what the hub does not keep is left out. */
static int set_path(struct change *c, const char *path, const json_t *value)
{
    for (size_t i = 0; i < ATTRIBUTES; i++) {
        if (strcmp(attributes[i].path, path) == 0) {
            return set(c, &attributes[i], value);
        }
        if (contains(path, attributes[i].path)) {
            return set_below(c, path, value);
        }
    }
    return 0;
}

/* Sets the members of an object whose names are paths. */
static int set_all(struct change *c, const json_t *object)
{
    const char *key;
    json_t *value;
    char path[SCIM_TEXT_SIZE];
    int error = 0;

    json_object_foreach((json_t *)(uintptr_t)object, key, value)
    {
        if (!error && scim_attribute_take(key, strlen(key), path) == 0) {
            error = set_path(c, path, value);
        }
    }
    return error;
}

/* ---- whole descriptions ---- */

static int check(const struct scim_user *user, struct iso_fault *fault)
{
    char name[SCIM_TEXT_SIZE];

    if (!*user->user_name) {
        return iso_fault_set(fault, -EINVAL, "userName is missing");
    }
    if (user->until_s && user->until_s <= user->from_s) {
        return iso_fault_set(fault, -EINVAL, "validUntil is before validFrom");
    }
    /* Nothing may keep somebody from being disabled. */
    return user->active ? scim_user_name(user, name, fault) : 0;
}

int scim_user_read(const json_t *body, const struct scim_user *before, struct scim_user *out,
                   struct iso_fault *fault)
{
    struct scim_user user = {.active = before ? before->active : true};
    struct change c = {.user = &user, .op = SCIM_REPLACE, .fault = fault};
    int error = json_is_object(body) ? set_all(&c, body)
                                     : iso_fault_set(fault, -EBADMSG, "the body is no JSON object");

    error = error ? error : check(&user, fault);
    if (!error) {
        *out = user;
    }
    return error;
}

static int apply(void *context, const struct scim_operation *operation, struct iso_fault *fault)
{
    struct change c = {.user = context, .op = operation->op, .fault = fault};

    if (!operation->has_path) {
        return set_all(&c, operation->value);
    }
    if (operation->path.filter.n == 0) {
        return set_path(&c, operation->path.attribute, operation->value);
    }
    /* Only attributes with several values have a filter, and the hub keeps none of them. */
    for (size_t i = 0; i < ATTRIBUTES; i++) {
        if (strcmp(attributes[i].path, operation->path.attribute) == 0) {
            return iso_fault_set(fault, -ENXIO, "%s has one value", attributes[i].path);
        }
    }
    return 0;
}

int scim_user_patch(const json_t *body, struct scim_user *user, struct iso_fault *fault)
{
    struct scim_user changed = *user;
    int error = scim_patch_each(body, apply, &changed, fault);

    error = error ? error : check(&changed, fault);
    if (!error) {
        *user = changed;
    }
    return error;
}

int scim_user_name(const struct scim_user *user, char out[SCIM_TEXT_SIZE], struct iso_fault *fault)
{
    char both[2 * SCIM_TEXT_SIZE];
    const char *name = user->user_name;

    (void)snprintf(both, sizeof both, "%s%s%s", user->given,
                   *user->given && *user->family ? " " : "", user->family);
    if (*user->display) {
        name = user->display;
    } else if (*user->formatted) {
        name = user->formatted;
    } else if (*both) {
        name = both;
    }
    const char *flaw = iso_person_name_flaw(name);
    if (flaw) {
        return iso_fault_set(fault, -EINVAL, "the name of a person: %s", flaw);
    }
    /* A name without a flaw has at most 64 characters, so it fits. */
    memcpy(out, name, strlen(name) + 1);
    return 0;
}

/* ---- as JSON ---- */

static int put_text(json_t *object, const char *name, const char *text)
{
    return *text ? json_object_set_new(object, name, json_string(text)) : 0;
}

static int put_time(json_t *object, const char *name, int64_t time_s)
{
    const time_t time = time_s;
    struct tm utc;
    char text[32];

    if (time_s == 0 || !gmtime_r(&time, &utc) ||
        strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc) == 0) {
        return 0;
    }
    return put_text(object, name, text);
}

/* Puts an object into another one unless it is empty. */
static int put_object(json_t *object, const char *name, json_t *part)
{
    if (json_object_size(part) == 0) {
        json_decref(part);
        return 0;
    }
    return json_object_set_new(object, name, part);
}

json_t *scim_user_json(const struct scim_user *user)
{
    json_t *json = json_pack("{s:s, s:b}", "userName", user->user_name, "active", user->active);
    json_t *name = json_object(), *extension = json_object();
    bool ok = json && name && extension;

    ok = ok && put_text(json, "externalId", user->external) == 0 &&
         put_text(json, "displayName", user->display) == 0 &&
         put_text(name, "formatted", user->formatted) == 0 &&
         put_text(name, "givenName", user->given) == 0 &&
         put_text(name, "familyName", user->family) == 0 &&
         put_time(extension, "validFrom", user->from_s) == 0 &&
         put_time(extension, "validUntil", user->until_s) == 0;
    if (!ok) {
        json_decref(name);
        json_decref(extension);
        json_decref(json);
        return NULL;
    }
    const bool put = put_object(json, "name", name) == 0 &&
                     put_object(json, SCIM_EXTENSION_USER, extension) == 0;
    if (!put) {
        json_decref(json);
        return NULL;
    }
    return json;
}
