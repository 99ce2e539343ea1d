/* Users and groups in the database. Internal to enroll/hub/scim; all functions that change
 * something are called within a transaction behind hub__scim_lock(). */
#ifndef ENROLL_HUB_SCIM_SCIM_ROWS_H
#define ENROLL_HUB_SCIM_SCIM_ROWS_H

#include "enroll/hub/scim/hub_scim.h"
#include "enroll/hub/scim/scim_group.h"
#include "enroll/hub/scim/scim_user.h"

struct scim_row {
    struct iso_fleet_id id;
    int64_t version, made_s, changed_s;
    const char *related; /* JSON: the groups of a user, the members of a group; of the result */
};

/* Which rows of a list are wanted. */
struct scim_page {
    struct scim_filter filter;
    int64_t start, count; /* start from 1 on */
    bool related;         /* with the groups or the members */
};

/* ---- scim_lock.c: one change at a time, and the guard ---- */

/* Lets other changes wait until the end of the transaction. */
int hub__scim_lock(struct hub_store *store, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Whether a user has zones by what the directory says. */
int hub__scim_may_enter(struct hub_store *store, const struct iso_fleet_id *id, bool *out,
                        struct iso_fault *fault) __attribute__((warn_unused_result));

/* Counts somebody who has lost all zones. */
int hub__scim_lost(struct hub_store *store, const struct iso_fleet_id *id, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* -EPERM too many people have lost their zones. */
int hub__scim_guard(struct hub_store *store, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Records once an hour that the guard has stopped a change; outside of its transaction. */
int hub__scim_guard_record(struct hub_store *store, const char *why, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* ---- scim_users.c ---- */

/* Loads a user. -ENOENT. */
int hub__scim_user_load(struct hub_store *store, const struct iso_fleet_id *id,
                        struct scim_user *user, struct scim_row *row, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Stores a new user, or a new version of one, and brings its person to it. -EEXIST the userName is
 * taken, or another person has the name. */
int hub__scim_user_store(struct hub_store *store, const struct iso_fleet_id *id,
                         const struct scim_user *user, bool is_new, struct iso_fault *fault)
    __attribute__((warn_unused_result));

int hub__scim_user_delete(struct hub_store *store, const struct iso_fleet_id *id,
                          struct iso_fault *fault) __attribute__((warn_unused_result));

/* Brings the person of a user to its zones. `counts`: the guard counts whoever loses all of them.
 */
int hub__scim_user_spread(struct hub_store *store, const struct iso_fleet_id *id, bool counts,
                          struct iso_fault *fault) __attribute__((warn_unused_result));

/* The users of a page, and how many there are in all. -EDOM the filter is not understood. */
int hub__scim_users_each(struct hub_store *store, const struct scim_page *page, int64_t *total,
                         int (*each)(void *context, const struct scim_user *user,
                                     const struct scim_row *row),
                         void *context, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* ---- scim_groups.c ---- */

/* Loads a group with its members; the caller frees them. -ENOENT. */
int hub__scim_group_load(struct hub_store *store, const struct iso_fleet_id *id,
                         struct scim_group *group, struct scim_row *row, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Stores a new group (`before` NULL) or a new version of one, and brings to it whoever comes, goes,
 * or gets other zones by another name. -EEXIST the name is taken, -EINVAL a member is unknown. */
int hub__scim_group_store(struct hub_store *store, const struct iso_fleet_id *id,
                          const struct scim_group *group, const struct scim_group *before,
                          struct iso_fault *fault) __attribute__((warn_unused_result));

int hub__scim_group_delete(struct hub_store *store, const struct iso_fleet_id *id,
                           struct iso_fault *fault) __attribute__((warn_unused_result));

/* The groups of a page, without members in `group`. */
int hub__scim_groups_each(struct hub_store *store, const struct scim_page *page, int64_t *total,
                          int (*each)(void *context, const struct scim_group *group,
                                      const struct scim_row *row),
                          void *context, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* ---- scim_page.c: the lists of both ---- */

/* The first value that a filter compares an attribute with; NULL: none. */
const char *hub__scim_term(const struct scim_filter *filter, const char *attribute);

/* -EDOM a term names another attribute than these, or one twice; `names` ends with NULL. */
int hub__scim_check_terms(const struct scim_filter *filter, const char *const *names,
                          struct iso_fault *fault) __attribute__((warn_unused_result));

/* The common form of all spellings; the caller frees it. -EINVAL it is not UTF-8, -ENOMEM. */
int hub__scim_fold(const char *text, char **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The statements of a list. Both have the values of the filter; `select` has three more behind
 * them: how many rows are left out, how many are wanted, and whether those with the related ones.
 */
struct scim_page_query {
    const char *count, *select;
};

/* The rows of a page, which the caller clears, and how many there are in all. After an error there
 * are no rows. Appends to the values of the filter. */
int hub__scim_page_rows(struct hub_store *store, const struct scim_page *page,
                        const struct scim_page_query *query, struct hub_values *filter,
                        int64_t *total, PGresult **rows, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
