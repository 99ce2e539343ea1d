#include "firmware/fleet/door/fleet.h"

#include <errno.h>
#include <sodium.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <syslog.h>

#include "firmware/contract/validity.h"
#include "firmware/fleet/door/fleet_state.h"

/* ---- opening ---- */

/* Reads the record. One that cannot be read keeps the people of the fleet out. */
static void load(struct iso_fleet *fleet)
{
    const struct iso_fleet_store *store = &fleet->options.store;
    size_t size = 0;
    const void *bytes = store->access(store->context, ISO_GALLERY_FLEET, &size);
    struct iso__fleet_record record = {.acked = 0};
    fleet->unreadable = bytes && iso__fleet_record_get(bytes, size, &record) != 0;
    sodium_memzero(&fleet->record, sizeof fleet->record);
    if (bytes && !fleet->unreadable) {
        fleet->record = record;
    }
    sodium_memzero(&record, sizeof record);
    fleet->stored_term = fleet->record.term;
    fleet->reload = false;
}

int iso_fleet_open(const struct iso_fleet_options *options, struct iso_fleet **out,
                   struct iso_fault *fault)
{
    int error = iso_fleet_start(fault);
    if (!error) {
        error = options->store.state(options->store.context, fault);
    }
    if (error) {
        return error;
    }
    struct iso_fleet *fleet = calloc(1, sizeof *fleet);
    if (!fleet) {
        return iso_fault_set(fault, -ENOMEM, "fleet: out of memory");
    }
    fleet->options = *options;
    load(fleet);
    const struct iso_fleet_clocks now = iso__fleet_now(fleet);
    fleet->lease_held = iso_fleet_term_left_ns(&fleet->record.term, &now) > 0;
    fleet->work = ISO_FLEET_WORK_EVENTS | ISO_FLEET_WORK_REQUESTS;
    *out = fleet;
    return 0;
}

void iso_fleet_close(struct iso_fleet *fleet)
{
    if (fleet) {
        iso__fleet_index_done(&fleet->index);
        sodium_memzero(fleet, sizeof *fleet);
        free(fleet);
    }
}

/* ---- common ---- */

struct iso_fleet_clocks iso__fleet_now(const struct iso_fleet *fleet)
{
    struct iso_fleet_clocks now = {.boot_ns = 0};
    fleet->options.host.clocks(fleet->options.host.context, &now);
    return now;
}

bool iso_fleet_is_member(const struct iso_fleet *fleet)
{
    return fleet->unreadable || fleet->record.membership_size > 0;
}

const char *iso_fleet_hub_name(const struct iso_fleet *fleet)
{
    return fleet->record.member.hub_name;
}

bool iso_fleet_has_policy(const struct iso_fleet *fleet)
{
    return fleet->record.membership_size > 0 && fleet->record.has_policy;
}

/* The newest lease of this run is not lost with an error of the disk. */
static void reload(struct iso_fleet *fleet)
{
    const struct iso_fleet_term term = fleet->record.term;
    const uint64_t acked = fleet->record.acked;
    load(fleet);
    if (iso_fleet_is_member(fleet) && !fleet->unreadable) {
        fleet->record.term = term;
        fleet->record.acked = acked;
    }
}

int iso__fleet_ready(struct iso_fleet *fleet, struct iso_fault *fault)
{
    const struct iso_fleet_store *store = &fleet->options.store;
    bool changed = false;
    const int error = store->state(store->context, fault);
    if (error) {
        return error;
    }
    if (fleet->reload) {
        reload(fleet);
    }
    if (fleet->unreadable) {
        return iso_fault_set(fault, -EPROTONOSUPPORT,
                             "what is stored of the fleet was written by a newer version");
    }
    if (!iso_fleet_is_member(fleet)) {
        return iso_fault_set(fault, -ENOENT, "this door belongs to no fleet");
    }
    if (iso__fleet_index_refresh(&fleet->index, store, &fleet->record.member.door, &changed)) {
        return iso_fault_set(fault, -ENOMEM, "fleet: out of memory");
    }
    if (changed && fleet->index.n_local > 0) {
        fleet->work |= ISO_FLEET_WORK_REQUESTS;
    }
    return 0;
}

static bool has_other_places(const struct iso__fleet_record *a, const struct iso__fleet_record *b)
{
    for (int i = 0; i < ISO_FLEET_ZONES_MAX; i++) {
        const struct iso__fleet_zone *one = &a->zones[i], *other = &b->zones[i];
        if (one->used != other->used ||
            memcmp(&one->place, &other->place, sizeof one->place) != 0) {
            return true;
        }
    }
    return false;
}

int iso__fleet_store(struct iso_fleet *fleet, const struct iso__fleet_record *draft,
                     struct iso_gallery_change *changes, size_t n, struct iso_fault *fault)
{
    const struct iso_fleet_store *store = &fleet->options.store;
    struct iso_fleet_bytes bytes = {.bytes = NULL};
    if (draft->membership_size > 0) {
        iso__fleet_record_put(draft, &bytes);
    }
    int error = bytes.error
                    ? iso_fault_set(fault, -ENOMEM, "fleet: out of memory")
                    : store->apply(store->context, changes, n, bytes.bytes, bytes.size, fault);
    iso_fleet_bytes_free(&bytes);
    if (error) {
        fleet->reload = true; /* a store that was out of service may have it all the same */
        return error;
    }
    if (has_other_places(&fleet->record, draft)) {
        fleet->work |= ISO_FLEET_WORK_PLACES;
    }
    if (draft != &fleet->record) {
        fleet->record = *draft;
    }
    fleet->stored_term = draft->term;
    fleet->index.version = store->version(store->context);
    iso__fleet_level(fleet);
    return 0;
}

int iso__fleet_note(struct iso_fleet *fleet, const struct iso__fleet_note *note, bool wait,
                    struct iso_fault *fault)
{
    char text[160], zone[ISO_FLEET_ID_TEXT_SIZE];
    struct iso_audit_record record = iso_audit_record_of("fleet");
    const char *hub = fleet->record.member.hub_name;
    if (note->zone && note->sequence) {
        (void)snprintf(text, sizeof text, "hub %s, zone %.8s, change %llu", hub,
                       iso_fleet_id_text(note->zone, zone), (unsigned long long)note->sequence);
    } else if (note->zone) {
        (void)snprintf(text, sizeof text, "hub %s, zone %.8s", hub,
                       iso_fleet_id_text(note->zone, zone));
    } else {
        (void)snprintf(text, sizeof text, "hub %s", hub);
    }
    record.reason = note->reason;
    record.person = note->person;
    record.before = note->before;
    record.after = note->after;
    record.note = text;
    return fleet->options.host.record(fleet->options.host.context, &record, wait, fault);
}

void iso__fleet_complain(struct iso_fleet *fleet, const struct iso_fault *fault)
{
    fleet->fault = *fault;
}

void iso__fleet_complain_of_newer(struct iso_fleet *fleet)
{
    static const char text[] = "the hub sends messages that this version does not know; upgrade "
                               "isotherm on this door";
    struct iso_fault why;
    if (strcmp(fleet->fault.text, text) == 0) {
        return; /* the same message comes again and again */
    }
    (void)iso_fault_set(&why, -EPROTONOSUPPORT, "%s", text);
    iso__fleet_complain(fleet, &why);
    iso__fleet_say(fleet, LOG_ERR, "fleet: %s; it keeps what it has", text);
}

void iso__fleet_say(const struct iso_fleet *fleet, int priority, const char *format, ...)
{
    char line[256];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    if (fleet->options.host.say) {
        fleet->options.host.say(fleet->options.host.context, priority, line);
    }
}

/* ---- belonging to a fleet ---- */

static int check_door(const struct iso_fleet *fleet, const struct iso__fleet_record *draft,
                      struct iso_fault *fault)
{
    struct iso_fleet_signer signer;
    struct iso_fleet_receiver receiver;
    fleet->options.host.keys(fleet->options.host.context, &signer, &receiver);
    const bool is_own = memcmp(draft->member.door_signs, signer.public, sizeof signer.public) == 0;
    sodium_memzero(&signer, sizeof signer);
    sodium_memzero(&receiver, sizeof receiver);
    if (!is_own) {
        return iso_fault_set(fault, -EKEYREJECTED, "the membership is for another door");
    }
    const struct iso_fleet_membership *now = &fleet->record.member;
    const bool is_other = fleet->unreadable ||
                          (iso_fleet_is_member(fleet) &&
                           memcmp(now->hub_signs, draft->member.hub_signs, sizeof now->hub_signs));
    return is_other
               ? iso_fault_set(fault, -EEXIST,
                               "this door belongs to the hub %s: let it leave first", now->hub_name)
               : 0;
}

/* A door that joins the same hub again is another door there, and begins anew with its lease. */
static void begin_anew(struct iso_fleet *fleet, struct iso__fleet_record *draft)
{
    draft->acked = 0;
    draft->term = (struct iso_fleet_term){.length_s = 0};
    fleet->n_questions = 0;
    fleet->waiting.length_s = 0;
    fleet->index.version = (struct iso_gallery_version){.changes = 0}; /* ids have the door's */
}

int iso_fleet_join(struct iso_fleet *fleet, const void *bytes, size_t size, const char *who,
                   struct iso_fault *fault)
{
    struct iso__fleet_record draft = fleet->record;
    struct iso_audit_record record = iso_audit_record_of("fleet");
    int error = fleet->options.store.state(fleet->options.store.context, fault);
    if (error) {
        return error;
    }
    error = iso__fleet_record_join(&draft, bytes, size);
    if (error) {
        return iso_fault_set(fault, error, "this is no membership of a fleet, or it was changed");
    }
    error = check_door(fleet, &draft, fault);
    record.reason = "joined";
    record.after = draft.member.hub_name;
    record.note = who;
    if (!error) {
        error = fleet->options.host.record(fleet->options.host.context, &record, true, fault);
    }
    if (!error) {
        begin_anew(fleet, &draft);
        error = iso__fleet_store(fleet, &draft, NULL, 0, fault);
        fleet->index.version = (struct iso_gallery_version){.changes = 0};
    }
    sodium_memzero(&draft, sizeof draft);
    return error;
}

int iso_fleet_leave(struct iso_fleet *fleet, const char *who, struct iso_fault *fault)
{
    static const struct iso_fleet_id no_zone;
    const struct iso__fleet_record nothing = {.acked = 0};
    struct iso_audit_record record = iso_audit_record_of("fleet");
    struct iso__fleet_batch *batch = NULL;
    char hub[ISO_FLEET_TITLE_SIZE];
    int error = iso__fleet_ready(fleet, fault);
    if (error) {
        return error;
    }
    (void)snprintf(hub, sizeof hub, "%s", fleet->record.member.hub_name);
    record.reason = "left";
    record.before = hub;
    record.note = who;
    error = fleet->options.host.record(fleet->options.host.context, &record, true, fault);
    if (!error && iso__fleet_batch_new(fleet, &no_zone, UINT8_MAX, 0, 0, &batch)) {
        error = iso_fault_set(fault, -ENOMEM, "fleet: out of memory");
    }
    if (!error) {
        error = iso__fleet_withdraw_all(batch, &nothing, fault);
    }
    iso__fleet_batch_free(batch);
    if (!error) {
        fleet->n_questions = 0;
        fleet->waiting.length_s = 0;
        fleet->lease_held = false;
        fleet->fault.text[0] = '\0';
    }
    return error;
}

/* ---- state ---- */

int iso_fleet_get_status(struct iso_fleet *fleet, struct iso_fleet_status *out,
                         struct iso_fault *fault)
{
    const struct iso__fleet_zone *zones[ISO_FLEET_ZONES_MAX];
    const struct iso_fleet_clocks now = iso__fleet_now(fleet);
    const int error = iso__fleet_ready(fleet, fault);
    if (error) {
        return error;
    }
    const struct iso__fleet_record *record = &fleet->record;
    *out = (struct iso_fleet_status){
        .member = &record->member,
        .last_event = fleet->options.host.last_event(fleet->options.host.context),
        .acked = record->acked,
        .lease_given = iso_fleet_term_was_given(&record->term),
        .lease_left_ns = iso_fleet_term_left_ns(&record->term, &now),
        .lease_s = record->lease_s,
        .local_people = record->local_people,
        .n = iso__fleet_zones(record, zones),
        .pending = (uint32_t)fleet->index.n_local,
        .people = (uint32_t)(fleet->index.n - fleet->index.n_local),
        .fault = fleet->fault.text,
    };
    for (size_t i = 0; i < out->n; i++) {
        out->places[i] = zones[i]->place;
        out->wants_snapshot[i] = zones[i]->wants_snapshot;
        out->behind |= zones[i]->behind;
    }
    return 0;
}

enum iso_fleet_admission iso_fleet_admission(const struct iso_fleet *fleet,
                                             const struct iso_credential_record *record)
{
    if (!iso_credential_is_of_fleet(record)) {
        return iso_fleet_is_member(fleet) && !fleet->record.local_people ? ISO_FLEET_NOT_APPROVED
                                                                         : ISO_FLEET_MAY_ENTER;
    }
    if (record->fleet.offline_ok && iso_fleet_is_member(fleet) && !fleet->unreadable) {
        return ISO_FLEET_MAY_ENTER;
    }
    const struct iso_fleet_clocks now = iso__fleet_now(fleet);
    return iso_fleet_term_left_ns(&fleet->record.term, &now) > 0 ? ISO_FLEET_MAY_ENTER
                                                                 : ISO_FLEET_NO_LEASE;
}

const char *iso_fleet_why(const struct iso_fleet *fleet, char text[ISO_FLEET_WHY_SIZE])
{
    const struct iso_fleet_term *term = &fleet->record.term;
    const struct iso_fleet_clocks now = iso__fleet_now(fleet);
    char date[ISO_VALIDITY_DATE_SIZE];
    text[0] = '\0';
    if (iso_fleet_term_left_ns(term, &now) > 0) {
        return text;
    }
    if (!iso_fleet_term_was_given(term)) {
        (void)snprintf(text, ISO_FLEET_WHY_SIZE,
                       "no lease: the hub has not answered since this door started or joined");
    } else if (term->begin.date_known) {
        (void)snprintf(text, ISO_FLEET_WHY_SIZE, "no lease: the hub has not answered since %s",
                       iso_validity_date(term->begin.date_s, date));
    } else {
        (void)snprintf(text, ISO_FLEET_WHY_SIZE,
                       "no lease: the hub has not answered for more than %lld s",
                       (long long)term->length_s);
    }
    return text;
}
