/* The body of a PATCH (RFC 7644, section 3.5.2). Pure. */
#ifndef ENROLL_HUB_SCIM_SCIM_PATCH_H
#define ENROLL_HUB_SCIM_SCIM_PATCH_H

#include <jansson.h>
#include <stdbool.h>

#include "enroll/hub/scim/scim_filter.h"

#define SCIM_EXTENSION_USER "urn:ietf:params:scim:schemas:extension:isotherm:2.0:User"

enum { SCIM_OPERATIONS_MOST = 1000 };

enum scim_op { SCIM_ADD, SCIM_REPLACE, SCIM_REMOVE };

struct scim_operation {
    enum scim_op op;
    bool has_path;
    struct scim_path path;
    const json_t *value; /* of the body; NULL: none */
};

/* The member of an object by its name in capital or small letters; NULL: there is none. */
const json_t *scim_member(const json_t *object, const char *name);

/* Passes each operation to `each`, whose error ends it. -EBADMSG it is no such body; -ENXIO a path
 * cannot be read. */
int scim_patch_each(const json_t *body,
                    int (*each)(void *context, const struct scim_operation *operation,
                                struct iso_fault *fault),
                    void *context, struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
