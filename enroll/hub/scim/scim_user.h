/* A user as an identity provider describes it (RFC 7643, section 4.1): the attributes that the hub
 * keeps. All others (addresses, telephones, photos, managers) are accepted and forgotten at once:
 * the doors do not need them, and a photo never becomes a face. Pure.
 *
 *   userName, externalId, displayName, name.formatted, name.givenName, name.familyName, active, and
 *   validFrom and validUntil of SCIM_EXTENSION_USER: times such as "2026-12-31T18:00:00Z" */
#ifndef ENROLL_HUB_SCIM_SCIM_USER_H
#define ENROLL_HUB_SCIM_SCIM_USER_H

#include <stdint.h>

#include "enroll/hub/scim/scim_patch.h"

struct scim_user {
    char user_name[SCIM_TEXT_SIZE], external[SCIM_TEXT_SIZE];
    char display[SCIM_TEXT_SIZE], formatted[SCIM_TEXT_SIZE];
    char given[SCIM_TEXT_SIZE], family[SCIM_TEXT_SIZE];
    bool active;
    int64_t from_s, until_s; /* since 1970; 0: no limit */
};

/* Takes the whole description of a POST or PUT. `before`: whom a PUT replaces; NULL: it is a POST.
 * A PUT that does not say whether the user is active leaves that as it is, and a POST makes an
 * active one. -EINVAL a value is not allowed; -EBADMSG it is no such description. */
int scim_user_read(const json_t *body, const struct scim_user *before, struct scim_user *out,
                   struct iso_fault *fault) __attribute__((warn_unused_result));

/* Changes a user by the body of a PATCH. A user whose "active" is removed is not active. Besides
 * -ENXIO a path. After an error *user is untouched. */
int scim_user_patch(const json_t *body, struct scim_user *user, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The name by which the doors know the person: the first of displayName, name.formatted, given and
 * family name, userName. -EINVAL it cannot be a person's name. */
int scim_user_name(const struct scim_user *user, char out[SCIM_TEXT_SIZE], struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The attributes as JSON, without "id", "meta" and "groups". NULL: there is no memory. */
json_t *scim_user_json(const struct scim_user *user);

#endif
