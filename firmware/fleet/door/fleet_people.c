/* Puts and removes people as the zones say. */
#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "firmware/fleet/door/fleet_batch.h"
#include "firmware/policy/credential/credential_json.h"

/* ---- a PUT ---- */

/* What becomes of a person. */
struct plan {
    const struct iso_fleet_person *person;
    const struct iso__fleet_entry *entry; /* the present one; NULL: none */
    int64_t replaced;                     /* the number of the person who is replaced; 0: none */
    const struct iso_person *holder;      /* another person who has the name; NULL: nobody */
    bool holder_is_local;                 /* the holder was enrolled here */
    char name[ISO_PERSON_NAME_SIZE];
    struct iso_person_name_key key;
    uint8_t digest[ISO_FLEET_DIGEST_BYTES];
};

static int make_plan(const struct iso__fleet_batch *batch, const struct iso_fleet_person *person,
                     struct plan *out, struct iso_fault *fault)
{
    const struct iso_fleet_store *store = &batch->fleet->options.store;
    *out = (struct plan){.person = person};
    if (person->name_length >= sizeof out->name) {
        return iso_fault_set(fault, -EINVAL, "the name is too long");
    }
    memcpy(out->name, person->name, person->name_length);
    const char *flaw = iso_person_name_flaw(out->name);
    if (flaw || person->revision == 0) {
        return iso_fault_set(fault, -EINVAL, "%s", flaw ? flaw : "the person has no revision");
    }
    if (iso_person_name_key(out->name, &out->key)) {
        return iso_fault_set(fault, -ENOMEM, "fleet: out of memory");
    }
    out->entry = iso__fleet_index_find(&batch->fleet->index, &person->id);
    out->replaced = out->entry ? out->entry->person : 0;
    const struct iso_person *holder = store->find(store->context, out->name);
    if (holder && holder->id != out->replaced) {
        struct iso_credential_record record = iso__fleet_credential(store, holder->id);
        const bool local = !iso_credential_is_of_fleet(&record);
        iso_credential_record_wipe(&record);
        if (local && !out->replaced) {
            out->replaced = holder->id;
        } else {
            out->holder = holder;
            out->holder_is_local = local;
        }
    }
    iso_fleet_templates_digest(person, out->digest);
    return 0;
}

/* The credential of a PUT. One that cannot be read is disabled: the person may not enter. */
static struct iso_credential_record credential_of(const struct iso_fleet_person *person)
{
    struct iso_credential_record record = iso_credential_record_new();
    char json[ISO_FLEET_CREDENTIAL_MAX + 1];
    const size_t n = person->credential_length;
    if (n == 0) {
        return record;
    }
    memcpy(json, person->credential, n);
    json[n] = '\0';
    if (iso_credential_patch(json, &record, NULL)) {
        record = iso_credential_record_new();
        record.enabled = false;
        (void)snprintf(record.disabled_reason, sizeof record.disabled_reason,
                       "not readable at this door");
    }
    sodium_memzero(json, sizeof json);
    return record;
}

static void put_row(const struct iso_fleet_person *person, const char *name, struct iso_person *out)
{
    *out = (struct iso_person){
        .enrolled_s = person->enrolled_s,
        .valid_from_s = person->valid_from_s,
        .valid_until_s = person->valid_until_s,
    };
    (void)snprintf(out->name, sizeof out->name, "%s", name);
}

/* Which templates the door keeps: at most as many as the gallery takes, those that it can search
 * first. */
static size_t choose_templates(const struct iso_fleet_person *person, uint32_t algorithm,
                               size_t chosen[ISO_GALLERY_TEMPLATES_MAX])
{
    size_t n = 0;
    for (int round = 0; round < 2; round++) {
        for (size_t i = 0; i < person->n && n < ISO_GALLERY_TEMPLATES_MAX; i++) {
            if ((person->templates[i].algorithm == algorithm) == (round == 0)) {
                chosen[n++] = i;
            }
        }
    }
    return n;
}

static int copy_templates(const struct iso_fleet_person *person, uint32_t algorithm,
                          struct iso__fleet_change *step, struct iso_gallery_change *change)
{
    size_t chosen[ISO_GALLERY_TEMPLATES_MAX], size = 0;
    const size_t n = choose_templates(person, algorithm, chosen);
    for (size_t i = 0; i < n; i++) {
        size += person->templates[chosen[i]].size;
    }
    step->templates = malloc(size ? size : 1);
    step->templates_size = size;
    if (!step->templates) {
        return -ENOMEM;
    }
    uint8_t *at = step->templates;
    for (size_t i = 0; i < n; i++) {
        const struct iso_fleet_template *own = &person->templates[chosen[i]];
        memcpy(at, own->bytes, own->size);
        change->item.templates[i].algorithm = own->algorithm;
        change->item.templates[i].bytes = at;
        change->item.templates[i].size = own->size;
        at += own->size;
    }
    change->item.n = n;
    return 0;
}

/* Takes the credential into a change, and into the entry after it. */
static void put_credential(const struct iso_credential_record *record, uint32_t seen,
                           struct iso__fleet_change *step, struct iso_gallery_change *change)
{
    change->access_size = iso_credential_record_put(record, step->access);
    change->access = step->access;
    step->puts = true;
    step->entry = iso__fleet_entry_of(record, 0);
    step->entry.seen = seen;
}

/* Somebody of the fleet whose name another one gets goes by the id until a PUT brings the new name:
 * the zone that has it was slower. */
static int add_nameless(struct iso__fleet_batch *batch, const struct iso_person *person,
                        struct iso_fault *fault)
{
    const struct iso_fleet_store *store = &batch->fleet->options.store;
    struct iso_gallery_change *change = &batch->changes[batch->n];
    struct iso__fleet_change *step = &batch->steps[batch->n];
    char text[ISO_FLEET_ID_TEXT_SIZE];
    struct iso_credential_record record = iso__fleet_credential(store, person->id);
    const struct iso__fleet_entry entry = iso__fleet_entry_of(&record, person->id);
    const struct iso__fleet_entry *own = iso__fleet_index_find(&batch->fleet->index, &entry.id);
    change->person = person->id;
    change->keep = true;
    change->item.person = *person;
    put_credential(&record, own ? own->seen : 0, step, change);
    (void)snprintf(change->item.person.name, sizeof change->item.person.name, "%s",
                   iso_fleet_id_text(&entry.id, text));
    iso_credential_record_wipe(&record);
    const int error = iso_person_name_key(change->item.person.name, &step->key);
    batch->n++;
    return error ? iso_fault_set(fault, -ENOMEM, "fleet: out of memory")
                 : iso__fleet_batch_note(batch, "renamed", person->name, person->name,
                                         change->item.person.name, fault);
}

static int add_removal(struct iso__fleet_batch *batch, const struct iso__fleet_entry *entry,
                       struct iso_fault *fault)
{
    const struct iso_fleet_store *store = &batch->fleet->options.store;
    const struct iso_person *person = store->find_id(store->context, entry->person);
    struct iso_credential_record record = iso__fleet_credential(store, entry->person);
    char before[ISO__FLEET_TEXT_SIZE] = "";
    iso__fleet_describe(person, &record, before);
    iso_credential_record_wipe(&record);
    batch->changes[batch->n] = (struct iso_gallery_change){.person = entry->person, .remove = true};
    batch->steps[batch->n].dropped = entry->id;
    const int error = iso__fleet_batch_note(batch, "removed", person->name, before, "", fault);
    batch->n++;
    sodium_memzero(before, sizeof before);
    return error;
}

/* The id of somebody who was enrolled here. */
static struct iso_fleet_id local_id(const struct iso_fleet *fleet, int64_t person)
{
    const struct iso_fleet_store *store = &fleet->options.store;
    const struct iso_gallery_version version = store->version(store->context);
    return iso_fleet_request_id(&fleet->record.member.door, version.gallery, person);
}

/* Takes the name of a PUT from the person who has it: somebody who was enrolled here leaves. */
static int free_name(struct iso__fleet_batch *batch, const struct plan *plan,
                     struct iso_fault *fault)
{
    if (!plan->holder_is_local) {
        return add_nameless(batch, plan->holder, fault);
    }
    const struct iso__fleet_entry entry = {.id = local_id(batch->fleet, plan->holder->id),
                                           .person = plan->holder->id};
    return add_removal(batch, &entry, fault);
}

/* Fills in a change that brings new contents. */
static int fill_new(struct iso__fleet_batch *batch, const struct plan *plan,
                    struct iso_credential_record *record, struct iso_fault *fault)
{
    struct iso_gallery_change *change = &batch->changes[batch->n];
    struct iso__fleet_change *step = &batch->steps[batch->n];
    const struct iso_fleet_person *person = plan->person;
    const bool of_fleet = plan->entry && plan->entry->revision;
    *record = credential_of(person);
    memcpy(record->fleet.person, person->id.bytes, sizeof record->fleet.person);
    record->fleet.revision = person->revision;
    record->fleet.zones = (uint8_t)((of_fleet ? plan->entry->zones : 0) | batch->bit);
    record->fleet.offline_ok = person->offline_ok;
    memcpy(record->fleet.templates, plan->digest, sizeof record->fleet.templates);
    put_row(person, plan->name, &change->item.person);
    change->keep = of_fleet && memcmp(plan->entry->templates, record->fleet.templates,
                                      sizeof record->fleet.templates) == 0;
    step->key = plan->key;
    return change->keep || !copy_templates(person, batch->fleet->options.algorithm, step, change)
               ? 0
               : iso_fault_set(fault, -ENOMEM, "fleet: out of memory");
}

/* Adds the change of a plan. */
static int add_put(struct iso__fleet_batch *batch, const struct plan *plan, struct iso_fault *fault)
{
    const struct iso_fleet_store *store = &batch->fleet->options.store;
    struct iso_gallery_change *change = &batch->changes[batch->n];
    struct iso__fleet_change *step = &batch->steps[batch->n];
    const struct iso_person *known = store->find_id(store->context, plan->replaced);
    struct iso_credential_record earlier = iso__fleet_credential(store, plan->replaced);
    struct iso_credential_record record;
    char before[ISO__FLEET_TEXT_SIZE] = "", after[ISO__FLEET_TEXT_SIZE] = "";
    int error = fill_new(batch, plan, &record, fault);
    if (error) {
        iso_credential_record_wipe(&earlier);
        iso_credential_record_wipe(&record);
        return error;
    }
    change->person = plan->replaced;
    if (known && !plan->entry) { /* by name: the entry of the local person goes */
        step->dropped = local_id(batch->fleet, plan->replaced);
    }
    put_credential(&record, batch->seen, step, change);
    if (known) {
        iso__fleet_describe(known, &earlier, before);
    }
    iso__fleet_describe(&change->item.person, &record, after);
    const bool local = known && !iso_credential_is_of_fleet(&earlier);
    error = iso__fleet_batch_note(batch, local ? "replaced" : "put",
                                  known ? known->name : plan->name, before, after, fault);
    batch->n++;
    iso_credential_record_wipe(&earlier);
    iso_credential_record_wipe(&record);
    sodium_memzero(before, sizeof before);
    sodium_memzero(after, sizeof after);
    return error;
}

/* The content that is here stays, and only the zones that grant are others. */
static int add_zones(struct iso__fleet_batch *batch, const struct iso__fleet_entry *entry,
                     uint8_t zones)
{
    const struct iso_fleet_store *store = &batch->fleet->options.store;
    struct iso_gallery_change *change = &batch->changes[batch->n];
    struct iso__fleet_change *step = &batch->steps[batch->n];
    const struct iso_person *person = store->find_id(store->context, entry->person);
    struct iso_credential_record record = iso__fleet_credential(store, entry->person);
    record.fleet.zones = zones;
    change->person = entry->person;
    change->keep = true;
    change->item.person = *person;
    step->key = person->key;
    put_credential(&record, batch->seen, step, change);
    iso_credential_record_wipe(&record);
    batch->n++;
    return 0;
}

/* Two places: a PUT may also take a name from another person. */
static int make_room(struct iso__fleet_batch *batch, struct iso_fault *fault)
{
    return batch->n + 2 <= ISO__FLEET_BATCH
               ? 0
               : iso__fleet_batch_flush(batch, &batch->fleet->record, fault);
}

/* A PUT that this door cannot take at all: whoever was here under this id leaves. */
static int refuse_put(struct iso__fleet_batch *batch, const struct iso_fleet_person *person,
                      const struct iso_fault *why, struct iso_fault *fault)
{
    char text[ISO_FLEET_ID_TEXT_SIZE];
    const struct iso__fleet_note refused = {
        .reason = "refused",
        .person = iso_fleet_id_text(&person->id, text),
        .after = why->text,
        .zone = &batch->zone,
        .sequence = batch->sequence,
    };
    const int error = iso__fleet_note(batch->fleet, &refused, true, fault);
    iso__fleet_complain(batch->fleet, why);
    return error ? error : iso__fleet_withdraw(batch, &person->id, fault);
}

int iso__fleet_put(struct iso__fleet_batch *batch, const struct iso_fleet_person *person,
                   struct iso_fault *fault)
{
    struct plan plan;
    struct iso_fault why = {.text = ""};
    int error = make_plan(batch, person, &plan, &why);
    if (error == -EINVAL) {
        return refuse_put(batch, person, &why, fault);
    }
    const int64_t holder = plan.holder ? plan.holder->id : 0;
    if (!error && (iso__fleet_batch_has(batch, plan.replaced, &plan.key) ||
                   iso__fleet_batch_has(batch, holder, NULL) || batch->n + 2 > ISO__FLEET_BATCH)) {
        error = iso__fleet_batch_flush(batch, &batch->fleet->record, fault);
        return error ? error : iso__fleet_put(batch, person, fault); /* people may be others now */
    }
    if (error) {
        return iso_fault_set_code(fault, why.code, error, "%s", why.text);
    }
    if (plan.entry && plan.entry->revision >= person->revision) {
        struct iso__fleet_entry *own = iso__fleet_index_find(&batch->fleet->index, &person->id);
        const uint8_t zones = own->zones | batch->bit;
        own->seen = batch->seen;
        return zones == own->zones ? 0 : add_zones(batch, own, zones);
    }
    error = plan.holder ? free_name(batch, &plan, fault) : 0;
    return error ? error : add_put(batch, &plan, fault);
}

/* ---- a REMOVE ---- */

int iso__fleet_withdraw(struct iso__fleet_batch *batch, const struct iso_fleet_id *person,
                        struct iso_fault *fault)
{
    int error = make_room(batch, fault);
    const struct iso__fleet_entry *entry = iso__fleet_index_find(&batch->fleet->index, person);
    if (!error && entry && iso__fleet_batch_has(batch, entry->person, NULL)) {
        error = iso__fleet_batch_flush(batch, &batch->fleet->record, fault);
        entry = iso__fleet_index_find(&batch->fleet->index, person);
    }
    if (error || !entry) {
        return error;
    }
    const uint8_t zones = entry->zones & (uint8_t)~batch->bit;
    if (entry->revision && zones == entry->zones && entry->zones) {
        return 0; /* this zone has not granted */
    }
    return zones ? add_zones(batch, entry, zones) : add_removal(batch, entry, fault);
}

/* ---- all of a zone ---- */

/* Collects the ids of people of the fleet who have a grant of the batch's zones, or no grant at
 * all, and whom the snapshot did not have. */
static struct iso_fleet_id *collect(const struct iso__fleet_batch *batch, size_t *n)
{
    const struct iso__fleet_index *index = &batch->fleet->index;
    struct iso_fleet_id *ids = calloc(index->n ? index->n : 1, sizeof *ids);
    *n = 0;
    for (size_t i = 0; ids && i < index->n; i++) {
        const struct iso__fleet_entry *entry = &index->entries[i];
        const bool has_grant = (entry->zones & batch->bit) || entry->zones == 0;
        if (entry->revision && has_grant && (batch->seen == 0 || entry->seen != batch->seen)) {
            ids[(*n)++] = entry->id;
        }
    }
    return ids;
}

int iso__fleet_withdraw_all(struct iso__fleet_batch *batch, const struct iso__fleet_record *draft,
                            struct iso_fault *fault)
{
    size_t n = 0;
    /* First, so that the index says whom the snapshot had. */
    int error = iso__fleet_batch_flush(batch, &batch->fleet->record, fault);
    struct iso_fleet_id *ids = error ? NULL : collect(batch, &n);
    if (!error && !ids) {
        return iso_fault_set(fault, -ENOMEM, "fleet: out of memory");
    }
    for (size_t i = 0; !error && i < n; i++) {
        error = iso__fleet_withdraw(batch, &ids[i], fault);
    }
    free(ids);
    return error ? error : iso__fleet_batch_end(batch, draft, fault);
}
