/* People of the fleet. Each change of a person goes as a delta into every zone in which the person
 * is, and gets a revision that is higher than all before it. The errors of hub_store.h. */
#ifndef ISO_ENROLL_HUB_PEOPLE_HUB_PERSON_H
#define ISO_ENROLL_HUB_PEOPLE_HUB_PERSON_H

#include "enroll/hub/store/hub_store.h"
#include "firmware/fleet/message/change.h"

enum { HUB_PERSON_ZONES_MAX = 64 };

struct hub_person {
    struct iso_fleet_id id;
    uint64_t revision;
    char name[ISO_FLEET_NAME_MAX + 1];
    int64_t valid_from_s, valid_until_s, enrolled_s; /* limits: 0 means none */
    bool offline_ok;
    uint32_t templates;
    size_t n_zones;
    struct iso_fleet_id zones[HUB_PERSON_ZONES_MAX];
    char zone_names[HUB_PERSON_ZONES_MAX][HUB_NAME_SIZE]; /* by name */
};

/* Puts a person with templates into zones: a new one, or new contents of the person with this id.
 * The revision in `person` is ignored. Of a person who exists, templates of algorithms that are not
 * in `person` stay. -EEXIST another person has the name. */
int hub_person_put(struct hub_store *store, const struct iso_fleet_person *person,
                   const struct iso_fleet_id *zones, size_t n_zones, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Changes of one thing. Credentials are checked as credential_json.h reads them ("": the default).
 */
int hub_person_set_validity(struct hub_store *store, const struct iso_fleet_id *person,
                            int64_t from_s, int64_t until_s, struct iso_fault *fault)
    __attribute__((warn_unused_result));
int hub_person_set_offline(struct hub_store *store, const struct iso_fleet_id *person, bool ok,
                           struct iso_fault *fault) __attribute__((warn_unused_result));
int hub_person_set_credential(struct hub_store *store, const struct iso_fleet_id *person,
                              const char *json, struct iso_fault *fault)
    __attribute__((warn_unused_result));
int hub_person_rename(struct hub_store *store, const struct iso_fleet_id *person, const char *name,
                      struct iso_fault *fault) __attribute__((warn_unused_result));

/* At least one zone. Zones that the person leaves get a REMOVE. */
int hub_person_set_zones(struct hub_store *store, const struct iso_fleet_id *person,
                         const struct iso_fleet_id *zones, size_t n_zones, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Deletes a person; all zones of the person get a REMOVE in the same transaction. */
int hub_person_revoke(struct hub_store *store, const struct iso_fleet_id *person,
                      struct iso_fault *fault) __attribute__((warn_unused_result));

/* Finds a person by any spelling of the name (firmware/contract/name_folding.h) or by the id. */
int hub_person_find(struct hub_store *store, const char *name_or_id, struct hub_person *out,
                    struct iso_fault *fault) __attribute__((warn_unused_result));

struct hub_person_filter {
    const char *part;                /* of the name, in any spelling; NULL: all */
    const struct iso_fleet_id *zone; /* NULL: all */
    bool unseen; /* only people without a template of an algorithm that a door of their zones uses:
                  * they must be seen again */
    uint32_t most;     /* 0: all */
    const char *after; /* only people whose name comes after this one, which need not exist any
                        * more: the next page of a list; NULL: from the beginning */
};

/* People by name. */
int hub_person_each(struct hub_store *store, const struct hub_person_filter *filter,
                    int (*each)(void *context, const struct hub_person *person), void *context,
                    struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
