/* A group as an identity provider describes it (RFC 7643, section 4.2): its name and its members,
 * which are users. Pure. */
#ifndef ENROLL_HUB_SCIM_SCIM_GROUP_H
#define ENROLL_HUB_SCIM_SCIM_GROUP_H

#include "enroll/hub/scim/scim_patch.h"
#include "firmware/fleet/message/fleet_id.h"

enum { SCIM_MEMBERS_MOST = 100000 };

/* Ids in their order, each once. All zero is empty. */
struct scim_ids {
    struct iso_fleet_id *ids;
    size_t n;
};

void scim_ids_free(struct scim_ids *ids);

/* The ids of `a` that are not in `b`. -ENOMEM. */
int scim_ids_without(const struct scim_ids *a, const struct scim_ids *b, struct scim_ids *out)
    __attribute__((warn_unused_result));

/* Brings ids into their order, each once. */
void scim_ids_order(struct scim_ids *ids);

struct scim_group {
    char display[SCIM_TEXT_SIZE], external[SCIM_TEXT_SIZE];
    struct scim_ids members; /* the owner of the group frees them */
};

/* Takes the whole description of a POST or PUT; without "members" there are none. -EINVAL a value
 * is not allowed, or a member is no user; -EBADMSG it is no such description; -ENOMEM. */
int scim_group_read(const json_t *body, struct scim_group *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Changes a group by the body of a PATCH. Besides -ENXIO a path. After an error the group is to be
 * thrown away. A "remove" of members whose value names some of them removes only these, as Entra ID
 * means it. */
int scim_group_patch(const json_t *body, struct scim_group *group, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
