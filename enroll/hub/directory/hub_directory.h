/* People whom a directory names: who belongs to the fleet, in which zones, and until when. It has
 * no faces. The errors of hub_store.h.
 *
 * Somebody whom the directory names is first in a list of its own, as "must be enrolled"; a door
 * gets nothing, because a person without templates who replaces a local one of the same name would
 * take that person's face away. When a request from a door (hub_request.h) of this name is approved
 * after the directory has named the person, the next run links the two: from then on the directory
 * says the name, the validity and its zones of this person. A person of the fleet who is not linked
 * is never changed.
 *
 * Zones that somebody else has given to a linked person stay; the directory gives and takes its
 * own. Whom the directory disables or no longer names loses all zones, and keeps the templates: so
 * a mistake of a run can be undone. hub_person_revoke() removes them. */
#ifndef ISO_ENROLL_HUB_DIRECTORY_HUB_DIRECTORY_H
#define ISO_ENROLL_HUB_DIRECTORY_HUB_DIRECTORY_H

#include "enroll/hub/people/hub_person.h"

enum {
    HUB_EXTERNAL_SIZE = 129,    /* of an id in the directory */
    HUB_DIRECTORY_PERCENT = 20, /* a run that takes the zones of more people than this stops */
};

/* A person as the directory names it. */
struct hub_named {
    char external[HUB_EXTERNAL_SIZE];
    char name[ISO_FLEET_NAME_MAX + 1];
    bool active;
    int64_t from_s, until_s; /* 0: no limit */
    size_t n_zones;
    struct iso_fleet_id zones[HUB_PERSON_ZONES_MAX]; /* each once */
};

enum hub_directory_change {
    HUB_DIRECTORY_ADDED,   /* named for the first time */
    HUB_DIRECTORY_CHANGED, /* the name, the zones or the validity */
    HUB_DIRECTORY_LINKED,  /* has a face now */
    HUB_DIRECTORY_REMOVED, /* disabled, no longer named, or in no zone any more */
    HUB_DIRECTORY_FAILED,  /* could not be stored; the others were */
};

const char *hub_directory_change_word(enum hub_directory_change change);

struct hub_directory_run {
    const char *source; /* the name of the directory: "ldap" */
    bool dry_run;       /* nothing is changed */
    bool force;         /* however many people lose their zones */
    /* Is told each change; `why` is "", or why it failed. NULL: nobody is told. */
    void (*tell)(void *context, enum hub_directory_change change, const char *name,
                 const char *why);
    void *context;
};

struct hub_directory_counts {
    uint64_t named, added, changed, linked, removed, failed;
};

/* Brings the list to what the directory names, which are all of its people; each change is a
 * transaction of its own, so a run that was interrupted goes on with the next one. -EINVAL the same
 * id is named twice; -EPERM more than HUB_DIRECTORY_PERCENT of the active people would lose their
 * zones: nothing was changed. */
int hub_directory_sync(struct hub_store *store, const struct hub_directory_run *run,
                       const struct hub_named *named, size_t n, struct hub_directory_counts *out,
                       struct iso_fault *fault) __attribute__((warn_unused_result));

/* Stores one person as the directory names it now, for a directory that tells each change as it
 * happens. Whoever is not active loses all zones at once. -EEXIST another person of the fleet has
 * the name; -E2BIG there are too many zones. */
int hub_directory_put(struct hub_store *store, const char *source, const struct hub_named *named,
                      struct iso_fault *fault) __attribute__((warn_unused_result));

/* Takes one person out of the list, who loses all zones and keeps the templates; the link is
 * forgotten, so whoever gets the same name or account later does not get this face. -ENOENT. */
int hub_directory_remove(struct hub_store *store, const char *source, const char *external,
                         struct iso_fault *fault) __attribute__((warn_unused_result));

/* Does for such a directory what each run of hub_directory_sync() does besides: links people whose
 * requests were approved since, and brings back whom somebody has given other zones by hand.
 * *n: how many were changed. */
int hub_directory_mend(struct hub_store *store, const char *source, size_t *n,
                       struct iso_fault *fault) __attribute__((warn_unused_result));

/* Links by hand, for somebody who was in the fleet before the directory named the person. -ENOENT
 * there is no such id in the directory or no such person; -EEXIST one of them is linked already. */
int hub_directory_link(struct hub_store *store, const char *source, const char *external,
                       const struct iso_fleet_id *person, struct iso_fault *fault)
    __attribute__((warn_unused_result));

struct hub_directory_entry {
    const char *source;
    struct hub_named named; /* without zones */
    bool is_named;          /* the directory still names it */
    bool is_linked;         /* it has a face */
    struct iso_fleet_id person;
};

/* Everybody in the list, by name. */
int hub_directory_each(struct hub_store *store,
                       int (*each)(void *context, const struct hub_directory_entry *entry),
                       void *context, struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
