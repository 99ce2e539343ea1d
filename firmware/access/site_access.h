/* Who may enter at this door, by the policy that the site has stored (firmware/policy/policy.h).
 *
 *   gallery: access record of the site ----> policy document --.
 *            access record of a person ----> credential -------+--> iso_access_decide() --> answer
 *   configuration: which access point this door is ------------'
 *
 * Without a stored policy there is no more to ask than the limits of each person: whoever is
 * recognised and valid may enter. With a policy that cannot be used (the access point of this door
 * is not in it, a zone is not known on this machine) nobody may enter by it; `fault` says why.
 *
 * Who is in which area is known only from this door, only since the daemon was started. */
#ifndef ISO_FIRMWARE_ACCESS_SITE_ACCESS_H
#define ISO_FIRMWARE_ACCESS_SITE_ACCESS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "firmware/gallery/gallery.h"
#include "firmware/policy/credential/credential_record.h"
#include "firmware/policy/decide.h"
#include "firmware/policy/document/policy_document.h"

struct iso_site_access;

struct iso_site_access_options {
    const char *access_point; /* of this door; "": the only one of the policy */
    const struct iso_zone_source *zones;
};

/* Makes an object without a policy. The options are copied, except the names and zones, which must
 * outlive it. -ENOMEM. */
int iso_site_access_new(const struct iso_site_access_options *options, struct iso_site_access **out)
    __attribute__((warn_unused_result));
void iso_site_access_free(struct iso_site_access *access); /* NULL is accepted */

/* ---- the policy ---- */

/* Takes the policy that the gallery holds. Returns 0 also if it cannot be used (iso_site_access_
 * fault). -ENOMEM: then the earlier policy is still used. */
int iso_site_access_load(struct iso_site_access *access, const struct iso_gallery *gallery)
    __attribute__((warn_unused_result));

/* Whether there is a policy; and why it cannot be used: "" if it can, or if there is none. */
bool iso_site_access_has_policy(const struct iso_site_access *access);
const struct iso_fault *iso_site_access_fault(const struct iso_site_access *access);

/* The document in use, or NULL; its revision (0: none); and the access point of this door. */
const struct iso_policy_document *iso_site_access_document(const struct iso_site_access *access);
uint64_t iso_site_access_revision(const struct iso_site_access *access);
uint16_t iso_site_access_point(const struct iso_site_access *access);

/* The text of the stored policy, "" if there is none, also of one that cannot be used. The caller
 * frees it; NULL without memory. */
char *iso_site_access_text(const struct iso_gallery *gallery, size_t *size);

/* A policy that could be stored. */
struct iso_site_policy {
    struct iso_policy_document *document; /* NULL: the policy is removed */
    uint8_t *bytes;                       /* the access record of the site; malloc'd */
    size_t size;
};

/* Reads a document ("" removes the policy) and makes the record of it with a revision that is one
 * above the present one. -EINVAL with the line of policy_document.h, or the access point of this
 * door is not in it; -EFBIG, -ENOMEM. */
int iso_site_access_prepare(const struct iso_site_access *access, const char *json,
                            struct iso_site_policy *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));
void iso_site_policy_free(struct iso_site_policy *policy);

/* ---- a decision ---- */

/* The credential of a person: the stored record, or that of iso_credential_record_new(). A record
 * that cannot be read makes a disabled credential. */
struct iso_credential_record iso_site_access_credential(const struct iso_gallery *gallery,
                                                        int64_t person);

/* The person who has this card, or NULL: nobody, or more than one. */
const struct iso_person *iso_site_access_holder(const struct iso_gallery *gallery,
                                                const struct iso_card_number *card);

/* Whether somebody with this credential may be admitted at all, for a reason outside of the policy:
 * ISO_ACCESS_OTHER (yes), ISO_ACCESS_NO_LEASE or ISO_ACCESS_NOT_APPROVED. It is asked at every
 * decision, because a lease ends by itself. Without such a function nobody of a fleet is
 * admitted. */
typedef enum iso_access_reason (*iso_site_admission_fn)(void *context,
                                                        const struct iso_credential_record *record);
void iso_site_access_set_admission(struct iso_site_access *access, iso_site_admission_fn admission,
                                   void *context);
enum iso_access_reason iso_site_access_admission(const struct iso_site_access *access,
                                                 const struct iso_gallery *gallery, int64_t person);

struct iso_site_request {
    const char *access_point; /* NULL: this door */
    int64_t person;           /* 0: unknown */
    struct iso_shown shown;
    int64_t companion; /* a second person; 0: nobody */
    struct iso_shown companion_shown;
    int64_t time_s;  /* since 1970 UTC */
    bool time_known; /* false: the clock is not set, or was set back */
};

/* Nobody whose admission is refused (above) enters. Otherwise the answer of iso_access_decide().
 * Without a policy: ALLOW for a person whose credential is
 * enabled and who is valid at this time, if the face was shown. A policy that cannot be used, an
 * access point that it does not have, or a policy without a clock: DENY, ISO_ACCESS_OTHER. */
struct iso_access iso_site_access_decide(struct iso_site_access *access,
                                         const struct iso_gallery *gallery,
                                         const struct iso_site_request *request);

/* Calls `each` with one sentence for each finding of iso_policy_check() about the policy and all
 * people; ends and returns what `each` returns if that is not 0. Without a policy in use there are
 * none. -ENOMEM. */
int iso_site_access_check(const struct iso_site_access *access, const struct iso_gallery *gallery,
                          int64_t now_s, int (*each)(void *context, const char *sentence),
                          void *context);

/* The person was let in here and the door was used: the person is now in the area behind it.
 * -ENOMEM: it is not known where the person is. */
int iso_site_access_enter(struct iso_site_access *access, int64_t person, int64_t time_s)
    __attribute__((warn_unused_result));

/* Nothing is known any more about where the person is. */
void iso_site_access_forget(struct iso_site_access *access, int64_t person);

#endif
