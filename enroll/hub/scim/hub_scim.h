/* The hub as a service provider of SCIM 2.0 (RFC 7643, RFC 7644): identity providers such as Entra
 * ID, Okta or Keycloak tell it, as it happens, who belongs to the fleet, in which groups, and until
 * when. It has no faces: they neither come in nor go out.
 *
 * A user is a person of the directory (enroll/hub/directory) with the source "scim". Groups get
 * zones by their names (hub_scim_zones_set). Whoever is disabled or deleted loses all zones in the
 * same transaction. At most one change of SCIM is made at a time, whichever process makes it.
 *
 * A guard stops mistakes that take the zones from many: within an hour HUB_SCIM_LOSSES_FREE people
 * may lose them, or HUB_DIRECTORY_PERCENT of those who have some. A request that goes beyond is
 * refused as a whole with 429, so the provider repeats it later; hub_scim_allow() lets it pass.
 * Each change is an act of "scim:TOKEN". */
#ifndef ENROLL_HUB_SCIM_HUB_SCIM_H
#define ENROLL_HUB_SCIM_HUB_SCIM_H

#include <stdbool.h>

#include "enroll/hub/people/hub_person.h"
#include "enroll/hub/store/hub_store.h"

#define HUB_SCIM_SOURCE "scim"
#define HUB_SCIM_TYPE   "application/scim+json"

enum {
    HUB_SCIM_BODY_MOST = 256 << 10,
    HUB_SCIM_PAGE_MOST = 500, /* resources in one answer */
    HUB_SCIM_LOSSES_FREE = 10,
    HUB_SCIM_LOSSES_S = 3600, /* the time within which losses count */
    HUB_SCIM_NAME_SIZE = 49,  /* of a token */
    HUB_SCIM_TOKEN_SIZE = 65,
    HUB_SCIM_DIGEST_BYTES = 32,
};

/* ---- requests ---- */

struct hub_scim_request {
    const char *method;
    const char *path; /* below the base, decoded: "Users/0190..." */
    const char *base; /* "https://hub.example.org:8443/scim/v2" */
    /* A parameter of the query; NULL: there is none. */
    const char *(*query)(const void *context, const char *name);
    const void *context;
    const char *body; /* of `size` bytes */
    size_t size;
    const char *if_match, *if_none_match; /* headers, or NULL */
    uint8_t token[HUB_SCIM_DIGEST_BYTES]; /* the digest of the token */
};

struct hub_scim_reply {
    unsigned status;
    char *text;                   /* of HUB_SCIM_TYPE, which the caller frees; NULL: none */
    char etag[40], location[320]; /* headers, or "" */
    unsigned retry_s;             /* the header Retry-After; 0: none */
    bool is_stranger;             /* the token is unknown */
    struct iso_fault trouble; /* what the log of the hub has to say; its text is "" for nothing */
};

/* Answers a request; every error is an answer, too. Sets store->actor. */
void hub_scim_answer(struct hub_store *store, const struct hub_scim_request *request,
                     struct hub_scim_reply *reply);

/* Whether the path is that of changes: it needs the lane of changes. */
bool hub_scim_changes(const char *method);

/* ---- what administrators set; errors of hub_store.h ---- */

/* Makes a token, which is shown once; the database has its digest alone. -EINVAL the name is not
 * allowed, -EEXIST. */
int hub_scim_token_make(struct hub_store *store, const char *name, char token[HUB_SCIM_TOKEN_SIZE],
                        struct iso_fault *fault) __attribute__((warn_unused_result));

/* The digest of a token as a client sends it. */
void hub_scim_token_digest(const char *token, size_t length, uint8_t out[HUB_SCIM_DIGEST_BYTES]);

/* -ENOENT there is no such token. */
int hub_scim_token_revoke(struct hub_store *store, const char *name, struct iso_fault *fault)
    __attribute__((warn_unused_result));

struct hub_scim_token {
    const char *name;
    int64_t added_s, used_s; /* used: to a minute; 0: never */
};
int hub_scim_token_each(struct hub_store *store,
                        int (*each)(void *context, const struct hub_scim_token *token),
                        void *context, struct iso_fault *fault) __attribute__((warn_unused_result));

/* Sets which zones the members of a group get; the group need not exist yet. No zones: none. The
 * members change at once; the guard does not count them. */
int hub_scim_zones_set(struct hub_store *store, const char *group, const struct iso_fleet_id *zones,
                       size_t n, struct iso_fault *fault) __attribute__((warn_unused_result));

/* Each group that exists or has a zone, by name; a group with several zones comes once for each. */
struct hub_scim_group_zone {
    const char *group, *zone; /* zone "": none */
    bool exists;              /* an identity provider has the group */
    int64_t members;
};
int hub_scim_zones_each(struct hub_store *store,
                        int (*each)(void *context, const struct hub_scim_group_zone *entry),
                        void *context, struct iso_fault *fault) __attribute__((warn_unused_result));

/* Lets the guard pass everything for an hour. */
int hub_scim_allow(struct hub_store *store, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
