#include "enroll/hub/scim/scim_patch.h"

#include <errno.h>
#include <stdint.h>
#include <string.h>
#include <strings.h>

const json_t *scim_member(const json_t *object, const char *name)
{
    const char *key;
    json_t *value;

    json_object_foreach((json_t *)(uintptr_t)object, key, value)
    {
        if (strcasecmp(key, name) == 0) {
            return value;
        }
    }
    return NULL;
}

static int take_op(const json_t *item, enum scim_op *out, struct iso_fault *fault)
{
    static const char *const words[] = {"add", "replace", "remove"};
    const char *word = json_string_value(scim_member(item, "op"));

    for (size_t i = 0; word && i < sizeof words / sizeof *words; i++) {
        if (strcasecmp(word, words[i]) == 0) {
            *out = (enum scim_op)i;
            return 0;
        }
    }
    return iso_fault_set(fault, -EBADMSG, "an operation is add, replace or remove");
}

static int take_operation(const json_t *item, struct scim_operation *out, struct iso_fault *fault)
{
    const json_t *path = scim_member(item, "path");
    int error = take_op(item, &out->op, fault);

    out->value = scim_member(item, "value");
    out->has_path = path && !json_is_null(path);
    if (!error && out->has_path) {
        error = json_is_string(path) ? scim_path_read(json_string_value(path), &out->path, fault)
                                     : iso_fault_set(fault, -ENXIO, "a path has to be a text");
    }
    if (!error && !out->has_path && (out->op == SCIM_REMOVE || !json_is_object(out->value))) {
        error = iso_fault_set(fault, -EBADMSG,
                              "an operation without a path has an object as its value");
    }
    return error;
}

int scim_patch_each(const json_t *body,
                    int (*each)(void *context, const struct scim_operation *operation,
                                struct iso_fault *fault),
                    void *context, struct iso_fault *fault)
{
    const json_t *operations = scim_member(body, "Operations");
    const size_t n = json_array_size(operations);
    int error = 0;

    if (n == 0 || n > SCIM_OPERATIONS_MOST) {
        return iso_fault_set(fault, -EBADMSG, "Operations has to be a list of 1 to %d operations",
                             SCIM_OPERATIONS_MOST);
    }
    for (size_t i = 0; !error && i < n; i++) {
        struct scim_operation operation = {.value = NULL};
        error = take_operation(json_array_get(operations, i), &operation, fault);
        error = error ? error : each(context, &operation, fault);
    }
    return error;
}
