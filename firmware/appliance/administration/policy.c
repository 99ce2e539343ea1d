/* The acts of an administrator that change the policy or a credential. Each is on record, with what
 * was before and what is after it, before it is done. */
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <syslog.h>

#include "firmware/appliance/administration/administration.h"
#include "firmware/appliance/appliance_access.h"
#include "firmware/appliance/appliance_calls.h"
#include "firmware/fleet/door/fleet.h"
#include "firmware/policy/credential/credential_json.h"

struct iso_site_access *iso_appliance_access(const struct iso_appliance *appliance)
{
    return appliance->access.site;
}

int64_t iso_appliance_date_s(const struct iso_appliance *appliance, bool *known)
{
    *known = iso__appliance_knows_date(appliance);
    return iso__appliance_date_s(appliance);
}

/* ---- records ---- */

/* Bytes of the text before and of the text after in one record of the log. A record of the policy
 * can be longer; its texts are then in several records, one part after the other. */
enum { PART = 480 };

struct recording {
    struct iso_appliance *appliance;
    int n; /* records so far */
    int error;
    struct iso_fault fault;
};

/* After so many records the log's writer is waited for: its queue is not longer (audit_writer.h).
 */
enum { RECORDS_AT_ONCE = 32 };

/* The end of a part: not within a character. */
static size_t part_of(const char *text)
{
    size_t n = strnlen(text, PART + 1);
    n = n > PART ? PART : n;
    while (n > 0 && ((unsigned char)text[n] & 0xc0) == 0x80) {
        n--;
    }
    return n;
}

static int record_difference(void *context, const char *kind, const char *token, const char *before,
                             const char *after)
{
    struct recording *recording = context;
    char name[160], from[PART + 1], to[PART + 1];
    (void)snprintf(name, sizeof name, "%s %.80s", kind, token);
    do {
        const size_t n_from = part_of(before), n_to = part_of(after);
        struct iso_audit_record record = iso_audit_record_of("policy");
        (void)snprintf(from, sizeof from, "%.*s", (int)n_from, before);
        (void)snprintf(to, sizeof to, "%.*s", (int)n_to, after);
        before += n_from;
        after += n_to;
        record.reason = "changes";
        record.note = name;
        record.before = from;
        record.after = to;
        recording->error = ++recording->n % RECORDS_AT_ONCE
                               ? iso_audit_writer_post(recording->appliance->log, &record,
                                                       &recording->fault)
                               : iso__appliance_record_first(recording->appliance, &record,
                                                             &recording->fault);
    } while (!recording->error && (*before || *after));
    return recording->error;
}

/* Records every difference, and at the end, waiting for the disk, the change itself: the records
 * are written in their order, so then all are on the disk. */
static int record_policy(struct iso_appliance *appliance, const struct iso_site_policy *policy,
                         const char *who, struct iso_fault *fault)
{
    const struct iso_site_access *site = appliance->access.site;
    const uint64_t revision = iso_site_access_revision(site);
    struct recording recording = {.appliance = appliance, .fault = {.text = ""}};
    struct iso_audit_record record = iso_audit_record_of("policy");
    char before[40], after[40];
    const int error = iso_policy_document_compare(iso_site_access_document(site), policy->document,
                                                  record_difference, &recording);
    if (error) {
        record.reason = "failed"; /* some differences may be on record already */
        (void)iso__appliance_note(appliance, &record);
        iso__appliance_note_storage(appliance, error, &recording.fault);
        return iso_fault_set_code(fault, recording.fault.code, error,
                                  "the change of the policy could not be recorded: %.160s",
                                  *recording.fault.text ? recording.fault.text : strerror(-error));
    }
    (void)snprintf(before, sizeof before, "revision %" PRIu64, revision);
    (void)snprintf(after, sizeof after, "revision %" PRIu64, policy->document ? revision + 1 : 0);
    record.before = before;
    record.after = after;
    record.note = who;
    return iso__appliance_record_first(appliance, &record, fault);
}

/* ---- the policy ---- */

static int check_revision(const struct iso_appliance *appliance, uint64_t based_on,
                          struct iso_fault *fault)
{
    const uint64_t revision = iso_site_access_revision(appliance->access.site);
    return revision == based_on
               ? 0
               : iso_fault_set(fault, -ECANCELED,
                               "the policy was changed meanwhile: revision %" PRIu64
                               " is stored, and the change is based on %" PRIu64,
                               revision, based_on);
}

static int store_policy(struct iso_appliance *appliance, const struct iso_site_policy *policy,
                        const char *who, struct iso_fault *fault)
{
    struct iso_audit_record record = iso_audit_record_of("policy");
    struct iso_fault own = {.text = ""};
    int error = record_policy(appliance, policy, who, fault);
    if (error) {
        return error;
    }
    error = iso_gallery_set_access(appliance->borrowed.gallery, 0, policy->bytes, policy->size,
                                   &own);
    if (!error) {
        error = iso__appliance_load_policy(appliance);
    }
    iso__appliance_conclude_change(appliance, &record, error, &own);
    return error ? iso_fault_set_code(fault, own.code, error, "%s", own.text) : 0;
}

int iso__appliance_take_policy(struct iso_appliance *appliance, const char *json, const char *who,
                               struct iso_fault *fault)
{
    struct iso_site_policy policy = {.document = NULL};
    int error = iso_site_access_prepare(appliance->access.site, json, &policy, fault);
    if (!error) {
        error = store_policy(appliance, &policy, who, fault);
    }
    iso_site_policy_free(&policy);
    return error;
}

/* A policy that came from the hub is changed there. */
static int may_set_policy(const struct iso_appliance *appliance, struct iso_fault *fault)
{
    const struct iso_fleet *fleet = appliance->fleet.door;
    return fleet && iso_fleet_has_policy(fleet)
               ? iso_fault_set(fault, -EINVAL, "the policy is managed by the hub %s",
                               iso_fleet_hub_name(fleet))
               : iso__appliance_may_begin(appliance, fault);
}

int iso_appliance_set_policy(struct iso_appliance *appliance, const char *json, uint64_t based_on,
                             const char *who, uint64_t *revision, struct iso_fault *fault)
{
    if (iso_gallery_state(appliance->borrowed.gallery, fault)) {
        return -EIO;
    }
    int error = check_revision(appliance, based_on, fault);
    if (!error) {
        error = may_set_policy(appliance, fault);
    }
    if (!error) {
        error = iso__appliance_take_policy(appliance, json, who, fault);
    }
    if (!error) {
        *revision = iso_site_access_revision(appliance->access.site);
    }
    return error;
}

/* ---- a credential ---- */

/* A card belongs to one person: otherwise it would not tell who comes. */
static int check_cards(const struct iso_appliance *appliance, int64_t person,
                       const struct iso_credential_record *record, struct iso_fault *fault)
{
    char text[ISO_CARD_NUMBER_TEXT_SIZE];
    for (int i = 0; i < record->n_cards; i++) {
        const struct iso_person *holder = iso_site_access_holder(appliance->borrowed.gallery,
                                                                 &record->cards[i]);
        if (holder && holder->id != person) {
            return iso_fault_set(fault, -EEXIST, "card %s belongs to %s",
                                 iso_card_number_text(&record->cards[i], text), holder->name);
        }
    }
    return 0;
}

static int store_credential(struct iso_appliance *appliance, int64_t person,
                            const struct iso_credential_record *record, struct iso_fault *fault)
{
    uint8_t bytes[ISO_CREDENTIAL_BYTES_MAX];
    const size_t size = iso_credential_record_put(record, bytes);
    const int error = iso_gallery_set_access(appliance->borrowed.gallery, person, bytes, size,
                                             fault);
    explicit_bzero(bytes, sizeof bytes);
    return error;
}

static int change_credential(struct iso_appliance *appliance, const struct iso_person *person,
                             const struct iso_credential_record *record, const char *before,
                             const char *after, const char *who, struct iso_fault *fault)
{
    struct iso_audit_record entry = iso_audit_record_of("credential");
    struct iso_fault own = {.text = ""};
    if (!before || !after) {
        return iso_fault_set(fault, -ENOMEM, "credential: out of memory");
    }
    entry.person = person->name;
    entry.before = before;
    entry.after = after;
    entry.note = who;
    int error = iso__appliance_record_change(appliance, &entry, fault);
    if (error) {
        return error;
    }
    error = store_credential(appliance, person->id, record, &own);
    iso__appliance_conclude_change(appliance, &entry, error, &own);
    return error ? iso_fault_set_code(fault, own.code, error, "%s", own.text) : 0;
}

int iso_appliance_set_credential(struct iso_appliance *appliance, const char *person,
                                 const char *patch, const char *who, struct iso_fault *fault)
{
    const struct iso_gallery *gallery = appliance->borrowed.gallery;
    const struct iso_person *known = iso_gallery_find(gallery, person);
    if (iso_gallery_state(gallery, fault)) {
        return -EIO;
    }
    if (!known) {
        return iso_fault_set(fault, -ENOENT, "%s: no such person", person);
    }
    struct iso_credential_record record = iso_site_access_credential(gallery, known->id);
    const iso_pin pin = record.pin, duress_pin = record.duress_pin;
    char *before = iso_credential_text(&record);
    int error = iso__appliance_may_change(appliance, known, fault);
    if (!error) {
        error = iso_credential_patch(patch, &record, fault);
    }
    if (!error) {
        error = check_cards(appliance, known->id, &record, fault);
    }
    if (!error) {
        /* The texts do not show that one PIN replaces another. */
        char note[96];
        char *after = iso_credential_text(&record);
        (void)snprintf(note, sizeof note, "%.48s%s%s", who,
                       record.pin != pin ? ", PIN changed" : "",
                       record.duress_pin != duress_pin ? ", duress PIN changed" : "");
        iso__appliance_end_wait(appliance); /* for a card or a PIN that may not hold any more */
        error = change_credential(appliance, known, &record, before, after, note, fault);
        free(after);
    }
    iso_credential_record_wipe(&record);
    free(before);
    return error;
}
