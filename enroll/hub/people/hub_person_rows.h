/* People with their templates, as the database has them. Internal to the hub. */
#ifndef ISO_ENROLL_HUB_PEOPLE_HUB_PERSON_ROWS_H
#define ISO_ENROLL_HUB_PEOPLE_HUB_PERSON_ROWS_H

#include "enroll/hub/people/hub_person.h"

/* A person whose texts and templates were opened. The owner frees it, which wipes them. */
struct hub__person {
    struct iso_fleet_person person; /* points to the members below */
    char name[ISO_FLEET_NAME_MAX + 1];
    struct iso_fleet_bytes credential, templates[ISO_FLEET_TEMPLATES_MAX];
};

void hub__person_free(struct hub__person *person);

/* The columns that hub__person_take reads: of a person p and its templates t, which are NULL if it
 * has none. The rows of one person stand together. */
#define HUB__PERSON_COLUMNS                                                                   \
    "p.id, p.revision, p.name, p.valid_from_s, p.valid_until_s, p.enrolled_s, p.offline_ok, " \
    "p.credential, t.algorithm, t.sealed "

/* Takes the person at *row from all its rows, and moves *row behind them. -EBADMSG the key file
 * does not belong to the database; -E2BIG it has too many templates. */
int hub__person_take(struct hub_store *store, const PGresult *rows, int *row,
                     struct hub__person *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Loads one person. -ENOENT. */
int hub__person_load(struct hub_store *store, const struct iso_fleet_id *id,
                     struct hub__person *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Stores a person; *is_new says whether the id was unknown. The revision and the zones stay.
 * -EEXIST the name is taken, -E2BIG. */
int hub__person_store(struct hub_store *store, const struct iso_fleet_person *person, bool *is_new,
                      struct iso_fault *fault) __attribute__((warn_unused_result));

/* A name that another person has. */
int hub__person_name_taken(const char *name, struct iso_fault *fault);

/* Seals a credential as it is stored. */
int hub__credential_seal(struct hub_store *store, const struct iso_fleet_id *person,
                         const char *json, size_t length, struct iso_fleet_bytes *sealed,
                         struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
