/* Stores changes of people together, each on record before it is done. */
#include "firmware/fleet/door/fleet_batch.h"

#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "firmware/contract/validity.h"
#include "firmware/policy/credential/credential_json.h"

int iso__fleet_batch_new(struct iso_fleet *fleet, const struct iso_fleet_id *zone, uint8_t bit,
                         uint64_t sequence, uint32_t seen, struct iso__fleet_batch **out)
{
    struct iso__fleet_batch *batch = calloc(1, sizeof *batch);
    if (!batch) {
        return -ENOMEM;
    }
    batch->fleet = fleet;
    batch->zone = *zone;
    batch->bit = bit;
    batch->sequence = sequence;
    batch->seen = seen;
    *out = batch;
    return 0;
}

static void wipe_step(struct iso__fleet_change *step, struct iso_gallery_change *change)
{
    if (step->templates) {
        sodium_memzero(step->templates, step->templates_size);
        free(step->templates);
    }
    sodium_memzero(step, sizeof *step);
    sodium_memzero(change, sizeof *change);
}

void iso__fleet_batch_free(struct iso__fleet_batch *batch)
{
    if (batch) {
        for (size_t i = 0; i < batch->n; i++) {
            wipe_step(&batch->steps[i], &batch->changes[i]);
        }
        sodium_memzero(batch, sizeof *batch);
        free(batch);
    }
}

/* ---- records ---- */

static int write_note(struct iso__fleet_batch *batch, bool wait, struct iso_fault *fault)
{
    const struct iso__fleet_last_note *last = &batch->note;
    const struct iso__fleet_note note = {
        .reason = last->reason,
        .person = last->person,
        .before = *last->before ? last->before : NULL,
        .after = *last->after ? last->after : NULL,
        .zone = iso_fleet_id_is_zero(&batch->zone) ? NULL : &batch->zone,
        .sequence = batch->sequence,
    };
    batch->note.is = false;
    return last->reason ? iso__fleet_note(batch->fleet, &note, wait, fault) : 0;
}

int iso__fleet_batch_note(struct iso__fleet_batch *batch, const char *reason, const char *person,
                          const char *before, const char *after, struct iso_fault *fault)
{
    const int error = batch->note.is ? write_note(batch, false, fault) : 0;
    struct iso__fleet_last_note *last = &batch->note;
    last->is = true;
    last->reason = reason;
    (void)snprintf(last->person, sizeof last->person, "%s", person);
    (void)snprintf(last->before, sizeof last->before, "%s", before);
    (void)snprintf(last->after, sizeof last->after, "%s", after);
    return error;
}

void iso__fleet_describe(const struct iso_person *person,
                         const struct iso_credential_record *record,
                         char text[ISO__FLEET_TEXT_SIZE])
{
    const struct iso_validity validity = {person->valid_from_s, person->valid_until_s};
    char limits[ISO_VALIDITY_TEXT_SIZE];
    char *credential = iso_credential_text(record);
    iso_validity_text(&validity, limits);
    (void)snprintf(text, ISO__FLEET_TEXT_SIZE, "%s; %s; %s", person->name, limits,
                   credential ? credential : "");
    size_t n = strlen(text);
    if (n == ISO__FLEET_TEXT_SIZE - 1) {
        while (n > 0 && ((unsigned char)text[n - 1] & 0xc0) == 0x80) {
            n--;
        }
        text[n ? n - 1 : 0] = '\0';
    }
    free(credential);
}

/* ---- storing ---- */

/* An error that the contents of a change cause, and not the disk. */
static bool is_of_content(int error)
{
    return error == -EINVAL || error == -EDQUOT || error == -EFBIG || error == -EEXIST;
}

/* Does in the index what was stored. */
static void follow(struct iso_fleet *fleet, const struct iso_gallery_change *change,
                   const struct iso__fleet_change *step, const char *name)
{
    const struct iso_fleet_host *host = &fleet->options.host;
    if (change->person && host->changed) {
        host->changed(host->context, change->person, name, change->number);
    }
    if (!iso_fleet_id_is_zero(&step->dropped)) {
        iso__fleet_index_drop(&fleet->index, &step->dropped);
    }
    if (step->puts) {
        struct iso__fleet_entry entry = step->entry;
        entry.person = change->number;
        iso__fleet_index_put(&fleet->index, &entry);
    }
}

/* The names of those who are changed, before they are. */
struct names {
    char text[ISO__FLEET_BATCH][ISO_PERSON_NAME_SIZE];
};

static void note_names(const struct iso__fleet_batch *batch, struct names *names)
{
    const struct iso_fleet_store *store = &batch->fleet->options.store;
    for (size_t i = 0; i < batch->n; i++) {
        const struct iso_person *person = store->find_id(store->context, batch->changes[i].person);
        (void)snprintf(names->text[i], sizeof names->text[i], "%s", person ? person->name : "");
    }
}

static int store_steps(struct iso__fleet_batch *batch, const struct iso__fleet_record *draft,
                       size_t first, size_t n, struct iso_fault *fault)
{
    struct names *names = calloc(1, sizeof *names);
    if (!names || iso__fleet_index_reserve(&batch->fleet->index, n)) {
        free(names);
        return iso_fault_set(fault, -ENOMEM, "fleet: out of memory");
    }
    note_names(batch, names);
    const int error = iso__fleet_store(batch->fleet, draft, batch->changes + first, n, fault);
    for (size_t i = first; !error && i < first + n; i++) {
        follow(batch->fleet, &batch->changes[i], &batch->steps[i], names->text[i]);
    }
    sodium_memzero(names, sizeof *names);
    free(names);
    return error;
}

/* A person whom this door cannot store as the hub wants is not left as before: nobody keeps rights
 * that the hub has changed. */
static int store_refused(struct iso__fleet_batch *batch, size_t i, const struct iso_fault *why,
                         struct iso_fault *fault)
{
    struct iso_gallery_change *change = &batch->changes[i];
    struct iso__fleet_change *step = &batch->steps[i];
    const struct iso__fleet_note refused = {
        .reason = "refused",
        .person = change->item.person.name,
        .after = why->text,
        .zone = &batch->zone,
        .sequence = batch->sequence,
    };
    int error = iso__fleet_note(batch->fleet, &refused, true, fault);
    iso__fleet_complain(batch->fleet, why);
    if (error || !change->person) {
        return error;
    }
    step->dropped = step->entry.id;
    step->puts = false;
    change->remove = true;
    change->keep = false;
    return store_steps(batch, &batch->fleet->record, i, 1, fault);
}

/* Stores the changes of the batch one by one. It is called when the store has refused the whole
 * batch because of the contents of one change. */
static int store_singly(struct iso__fleet_batch *batch, struct iso_fault *fault)
{
    int error = 0;
    for (size_t i = 0; !error && i < batch->n; i++) {
        struct iso_fault why = {.text = ""};
        error = store_steps(batch, &batch->fleet->record, i, 1, &why);
        if (is_of_content(error)) {
            error = store_refused(batch, i, &why, fault);
        } else if (error) {
            (void)iso_fault_set_code(fault, why.code, error, "%s", why.text);
        }
    }
    return error;
}

int iso__fleet_batch_flush(struct iso__fleet_batch *batch, const struct iso__fleet_record *draft,
                           struct iso_fault *fault)
{
    int error = batch->note.is ? write_note(batch, true, fault) : 0;
    if (!error && (batch->n > 0 || draft != &batch->fleet->record)) {
        error = store_steps(batch, draft, 0, batch->n, fault);
        if (is_of_content(error) && batch->n > 0) {
            error = store_singly(batch, fault);
            error = error ? error : iso__fleet_store(batch->fleet, draft, NULL, 0, fault);
        }
    }
    for (size_t i = 0; i < batch->n; i++) {
        wipe_step(&batch->steps[i], &batch->changes[i]);
    }
    batch->n = 0;
    return error;
}

int iso__fleet_batch_end(struct iso__fleet_batch *batch, const struct iso__fleet_record *draft,
                         struct iso_fault *fault)
{
    return iso__fleet_batch_flush(batch, draft, fault);
}

bool iso__fleet_batch_has(const struct iso__fleet_batch *batch, int64_t person,
                          const struct iso_person_name_key *key)
{
    for (size_t i = 0; i < batch->n; i++) {
        if ((person && batch->changes[i].person == person) ||
            (key && iso_person_name_key_is_same(&batch->steps[i].key, key))) {
            return true;
        }
    }
    return false;
}
