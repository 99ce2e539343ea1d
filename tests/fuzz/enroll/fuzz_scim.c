/* What identity providers send by SCIM: filters, paths, and the bodies of PATCH, POST and PUT. */
#include <jansson.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/hub/scim/scim_group.h"
#include "enroll/hub/scim/scim_user.h"
#include "tests/fuzz/fuzz.h"

static struct iso_fault fault;

/* A text of a fixed size has an end. */
static void check_text(const char text[SCIM_TEXT_SIZE])
{
    fuzz_check(memchr(text, '\0', SCIM_TEXT_SIZE) != NULL, "a text has an end");
}

static void read_filter(const char *text)
{
    struct scim_filter filter;
    struct scim_path path;

    if (scim_filter_read(text, &filter, &fault) == 0) {
        fuzz_check(filter.n > 0 && filter.n <= SCIM_TERMS_MOST, "a filter has terms");
        for (size_t i = 0; i < filter.n; i++) {
            check_text(filter.terms[i].attribute);
            check_text(filter.terms[i].value);
            fuzz_check(*filter.terms[i].attribute != '\0', "a term has an attribute");
        }
    }
    if (scim_path_read(text, &path, &fault) == 0) {
        check_text(path.attribute);
        fuzz_check(*path.attribute != '\0', "a path has an attribute");
    }
}

/* A user is one that can be stored, and comes through its own description unchanged. */
static void check_user(const struct scim_user *user)
{
    char name[SCIM_TEXT_SIZE];
    struct scim_user again;

    check_text(user->user_name);
    check_text(user->display);
    fuzz_check(*user->user_name != '\0', "a user has a userName");
    fuzz_check(user->from_s >= 0 && user->until_s >= 0, "times are not before 1970");
    fuzz_check(user->until_s == 0 || user->until_s > user->from_s, "the end is behind the begin");
    fuzz_check(!user->active || scim_user_name(user, name, &fault) == 0,
               "an active user has a name");
    json_t *json = scim_user_json(user);
    fuzz_check(json != NULL, "a user has a description");
    fuzz_check(scim_user_read(json, NULL, &again, &fault) == 0, "which can be read");
    json_t *second = scim_user_json(&again);
    fuzz_check(json_equal(json, second), "and is that of the same user");
    json_decref(second);
    json_decref(json);
}

/* Whether an object has an attribute, with the URN of a core schema or without it. */
static bool has_attribute(const json_t *body, const char *wanted)
{
    char name[SCIM_TEXT_SIZE];
    const char *key;
    json_t *value;

    json_object_foreach((json_t *)(uintptr_t)body, key, value)
    {
        if (scim_attribute_take(key, strlen(key), name) == 0 && strcmp(name, wanted) == 0) {
            return true;
        }
    }
    return false;
}

static void change_user(const json_t *body)
{
    struct scim_user user = {.user_name = "ada", .active = false}, read;
    const struct scim_user before = user;

    if (scim_user_patch(body, &user, &fault)) {
        fuzz_check(memcmp(&before, &user, sizeof user) == 0, "a refused PATCH changes nothing");
    } else {
        check_user(&user);
    }
    if (scim_user_read(body, &before, &read, &fault) == 0) {
        check_user(&read);
        fuzz_check(!read.active || has_attribute(body, "active"),
                   "nobody is active who was not and is not said to be");
    }
}

static void check_ids(const struct scim_ids *ids)
{
    for (size_t i = 1; i < ids->n; i++) {
        fuzz_check(memcmp(&ids->ids[i - 1], &ids->ids[i], sizeof *ids->ids) < 0,
                   "members are in their order, each once");
    }
}

static void change_group(const json_t *body)
{
    struct scim_group group = {.display = "staff"}, read;

    group.members.ids = calloc(1, sizeof *group.members.ids);
    group.members.n = group.members.ids ? 1 : 0;
    if (scim_group_patch(body, &group, &fault) == 0) {
        check_ids(&group.members);
        fuzz_check(*group.display != '\0', "a group has a name");
    }
    scim_ids_free(&group.members);
    if (scim_group_read(body, &read, &fault) == 0) {
        check_ids(&read.members);
        scim_ids_free(&read.members);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char *text = (char *)fuzz_copy(data, size);
    json_t *body = json_loadb(text, size, JSON_REJECT_DUPLICATES, NULL);

    read_filter(text);
    if (json_is_object(body)) {
        change_user(body);
        change_group(body);
    }
    json_decref(body);
    free(text);
    return 0;
}
