/* The list of a directory in the database. Internal to this room. */
#ifndef ISO_ENROLL_HUB_DIRECTORY_DIRECTORY_ROWS_H
#define ISO_ENROLL_HUB_DIRECTORY_DIRECTORY_ROWS_H

#include "enroll/hub/directory/hub_directory.h"

struct hub__listed {
    struct hub_named named; /* as it is stored */
    bool is_named;
    int64_t added_s;
    bool is_linked;
    struct iso_fleet_id person; /* if linked */
    bool has_face;              /* not linked, and somebody of the name was approved since */
    bool is_astray; /* linked, and not in the zones that the directory says: somebody has changed
                       them */
    bool seen;      /* of the caller */
};

/* Which rows of the list are read. */
enum hub__listed_which {
    HUB__LISTED_ALL,
    HUB__LISTED_DUE, /* who has a face and is not linked, or is astray */
};

/* Reads the list of a directory in the order of the ids. The caller frees *out. */
int hub__directory_load(struct hub_store *store, const char *source, enum hub__listed_which which,
                        struct hub__listed **out, size_t *n, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Whether what is stored differs from what is named. */
bool hub__directory_differs(const struct hub__listed *listed, const struct hub_named *named);

/* Stores what is named, and brings the linked person to it, in one transaction. `is_named` false:
 * the directory does not name it any more. *linked says whether a face was found for it. */
int hub__directory_apply(struct hub_store *store, const char *source, const struct hub_named *named,
                         bool is_named, bool *linked, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
