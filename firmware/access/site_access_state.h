/* The state of iso_site_access. Internal to firmware/access. */
#ifndef ISO_FIRMWARE_ACCESS_SITE_ACCESS_STATE_H
#define ISO_FIRMWARE_ACCESS_SITE_ACCESS_STATE_H

#include "firmware/access/site_access.h"

/* Where a person is. */
struct iso__site_presence {
    int64_t person;
    struct iso_presence presence;
};

struct iso_site_access {
    struct iso_site_access_options options;
    bool has_policy;
    uint64_t revision;
    struct iso_policy_document *document; /* NULL: none, or it cannot be used */
    uint16_t point;                       /* the access point of this door */
    struct iso_fault fault;
    iso_site_admission_fn admission; /* NULL: nobody of a fleet is admitted */
    void *admission_context;
    struct iso__site_presence *presences; /* in the order of entering */
    size_t n_presences, presences_capacity;
};

/* Makes ONVIF's credential of a person from the stored record. Profiles that the policy does not
 * have are left out: they give nothing. */
void iso__site_credential(const struct iso_policy_document *document,
                          const struct iso_person *person,
                          const struct iso_credential_record *record, struct iso_credential *out);

/* Where a person is, as far as is known. (site_access.c) */
struct iso_presence iso__site_presence(const struct iso_site_access *access, int64_t person);

#endif
