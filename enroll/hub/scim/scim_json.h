/* Resources, lists and errors of SCIM as JSON. Internal to enroll/hub/scim. */
#ifndef ENROLL_HUB_SCIM_SCIM_JSON_H
#define ENROLL_HUB_SCIM_SCIM_JSON_H

#include "enroll/hub/scim/scim_rows.h"

#define SCIM_CORE "urn:ietf:params:scim:schemas:core:2.0:"

/* The text of scim.json, with a NUL at its end: what does not change. */
extern const unsigned char hub__scim_document[];

/* NULL: there is no memory. */
json_t *hub__scim_user_resource(const char *base, const struct scim_user *user,
                                const struct scim_row *row);
json_t *hub__scim_group_resource(const char *base, const struct scim_group *group,
                                 const struct scim_row *row, bool with_members);

/* A list; takes over `resources`. */
json_t *hub__scim_list(json_t *resources, int64_t total, int64_t start);

/* ServiceProviderConfig, ResourceTypes or Schemas; `id`: one of a list, or "". NULL: there is no
 * such thing. */
json_t *hub__scim_constant(const char *name, const char *id);

/* The error of a request: sets status, text and scimType. */
void hub__scim_refuse(struct hub_scim_reply *reply, int error, const struct iso_fault *fault);

#endif
