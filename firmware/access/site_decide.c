/* The decision of one request, and what a credential is made of. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "firmware/access/site_access_state.h"

struct iso_credential_record iso_site_access_credential(const struct iso_gallery *gallery,
                                                        int64_t person)
{
    size_t size = 0;
    const void *bytes = iso_gallery_access(gallery, person, &size);
    struct iso_credential_record record = iso_credential_record_new();
    if (bytes && iso_credential_record_get(bytes, size, &record)) {
        record.enabled = false;
        (void)snprintf(record.disabled_reason, sizeof record.disabled_reason, "of a newer version");
    }
    return record;
}

const struct iso_person *iso_site_access_holder(const struct iso_gallery *gallery,
                                                const struct iso_card_number *card)
{
    size_t n = 0;
    const struct iso_person *holder = NULL;
    const struct iso_person *people = iso_gallery_people(gallery, &n);
    for (size_t i = 0; i < n; i++) {
        struct iso_credential_record record = iso_site_access_credential(gallery, people[i].id);
        const bool has = iso_credential_record_has_card(&record, card);
        iso_credential_record_wipe(&record);
        if (has && holder) {
            return NULL;
        }
        holder = has ? &people[i] : holder;
    }
    return holder;
}

void iso__site_credential(const struct iso_policy_document *document,
                          const struct iso_person *person,
                          const struct iso_credential_record *record, struct iso_credential *out)
{
    *out = (struct iso_credential){
        .enabled = record->enabled,
        .no_antipassback = record->no_antipassback,
        .needs_escort = record->needs_escort,
        .two_person_class = record->two_person_class,
        .identifiers = (uint8_t)(ISO_RECOGNITION_FACE |
                                 (record->n_cards > 0 ? ISO_RECOGNITION_CARD : 0) |
                                 (record->pin ? ISO_RECOGNITION_PIN : 0)),
        .pin = record->pin,
        .duress_pin = record->duress_pin,
        .valid_from_s = person->valid_from_s,
        /* The limit of a person is the last second, that of ONVIF the first one after it. */
        .valid_to_s = person->valid_until_s ? person->valid_until_s + 1 : 0,
    };
    (void)snprintf(out->token, sizeof out->token, "%lld", (long long)person->id);
    (void)snprintf(out->disabled_reason, sizeof out->disabled_reason, "%s",
                   record->disabled_reason);
    for (int i = 0; i < record->n_profiles; i++) {
        const uint16_t profile = iso_policy_document_access_profile(document, record->profiles[i]);
        if (profile != ISO_INDEX_NONE) {
            out->profiles[out->n_profiles++] = profile;
        }
    }
    const uint16_t standard = iso_policy_document_default_profile(document);
    if (record->n_profiles == 0 && standard != ISO_INDEX_NONE) {
        out->profiles[out->n_profiles++] = standard;
    }
}

/* Makes the credential of a person in the array; ISO_CREDENTIAL_NONE: nobody has this number. */
static uint32_t add_credential(const struct iso_policy_document *document,
                               const struct iso_gallery *gallery, int64_t id,
                               struct iso_credential *credentials, uint32_t *n)
{
    const struct iso_person *person = id ? iso_gallery_find_id(gallery, id) : NULL;
    if (!person) {
        return ISO_CREDENTIAL_NONE;
    }
    struct iso_credential_record record = iso_site_access_credential(gallery, id);
    iso__site_credential(document, person, &record, &credentials[*n]);
    iso_credential_record_wipe(&record);
    return (*n)++;
}

static struct iso_access decide_by_policy(const struct iso_site_access *access,
                                          const struct iso_gallery *gallery,
                                          const struct iso_site_request *request, uint16_t point)
{
    /* The decision looks at nobody but these two. */
    struct iso_credential credentials[2];
    struct iso_policy policy = *iso_policy_document_policy(access->document);
    const struct iso_presence presences[2] = {
        iso__site_presence(access, request->person),
        iso__site_presence(access, request->companion),
    };
    const struct iso_occupancy occupancy = {.presences = presences, .n = 2};
    policy.credentials = credentials;
    policy.n_credentials = 0;
    const struct iso_access_request asked = {
        .access_point = point,
        .credential = add_credential(access->document, gallery, request->person, credentials,
                                     &policy.n_credentials),
        .shown = request->shown,
        .companion = add_credential(access->document, gallery, request->companion, credentials,
                                    &policy.n_credentials),
        .companion_shown = request->companion_shown,
        .time_s = request->time_s,
    };
    const struct iso_access answer = iso_access_decide(&policy, &occupancy, &asked);
    explicit_bzero(credentials, sizeof credentials);
    return answer;
}

static struct iso_access refusal(enum iso_access_reason reason)
{
    return (struct iso_access){.outcome = ISO_ACCESS_DENY, .reason = reason};
}

static struct iso_access decide_without_policy(const struct iso_gallery *gallery,
                                               const struct iso_site_request *request)
{
    const struct iso_person *person = iso_gallery_find_id(gallery, request->person);
    if (!person) {
        return refusal(ISO_ACCESS_NOT_FOUND);
    }
    struct iso_credential_record record = iso_site_access_credential(gallery, person->id);
    const bool enabled = record.enabled;
    iso_credential_record_wipe(&record);
    if (!enabled) {
        return refusal(ISO_ACCESS_NOT_ENABLED);
    }
    if (!iso_person_is_valid(person, request->time_known, request->time_s)) {
        return refusal(request->time_known && request->time_s < person->valid_from_s
                           ? ISO_ACCESS_NOT_ACTIVE
                           : ISO_ACCESS_EXPIRED);
    }
    return request->shown.matched & ISO_RECOGNITION_FACE
               ? (struct iso_access){.outcome = ISO_ACCESS_ALLOW}
               : (struct iso_access){.outcome = ISO_ACCESS_WANT, .wanted = ISO_RECOGNITION_FACE};
}

/* ---- a fleet ---- */

void iso_site_access_set_admission(struct iso_site_access *access, iso_site_admission_fn admission,
                                   void *context)
{
    access->admission = admission;
    access->admission_context = context;
}

enum iso_access_reason iso_site_access_admission(const struct iso_site_access *access,
                                                 const struct iso_gallery *gallery, int64_t person)
{
    if (person == 0) {
        return ISO_ACCESS_OTHER;
    }
    struct iso_credential_record record = iso_site_access_credential(gallery, person);
    enum iso_access_reason reason = iso_credential_is_of_fleet(&record) ? ISO_ACCESS_NO_LEASE
                                                                        : ISO_ACCESS_OTHER;
    if (access->admission) {
        reason = access->admission(access->admission_context, &record);
    }
    iso_credential_record_wipe(&record);
    return reason;
}

struct iso_access iso_site_access_decide(struct iso_site_access *access,
                                         const struct iso_gallery *gallery,
                                         const struct iso_site_request *request)
{
    uint16_t point = access->point;
    const enum iso_access_reason first = iso_site_access_admission(access, gallery,
                                                                   request->person);
    const enum iso_access_reason second = iso_site_access_admission(access, gallery,
                                                                    request->companion);
    if (first != ISO_ACCESS_OTHER || second != ISO_ACCESS_OTHER) {
        struct iso_access answer = refusal(first != ISO_ACCESS_OTHER ? first : second);
        answer.of_companion = first == ISO_ACCESS_OTHER;
        return answer;
    }
    if (!access->has_policy) {
        return decide_without_policy(gallery, request);
    }
    if (!access->document || !request->time_known) {
        return refusal(ISO_ACCESS_OTHER);
    }
    if (request->access_point) {
        point = iso_policy_document_access_point(access->document, request->access_point);
    }
    return point == ISO_INDEX_NONE ? refusal(ISO_ACCESS_OTHER)
                                   : decide_by_policy(access, gallery, request, point);
}
