/* What the door sends to the hub unasked: its log, and the people who were enrolled at it. */
#include <errno.h>
#include <sodium.h>
#include <stdlib.h>
#include <string.h>

#include "firmware/fleet/door/fleet_state.h"
#include "firmware/policy/credential/credential_json.h"

enum {
    EVENTS_BYTES = 256 << 10, /* of the lines of one message */
    REQUESTS_BYTES = 8 << 20, /* of one call */
};

/* ---- the log ---- */

/* The lines of one message. */
struct lines {
    struct iso_fleet_bytes bytes;
    uint64_t first, last;
};

/* A record of the log begins with its number (firmware/audit/audit.h). */
static uint64_t number_of(const char *line)
{
    static const char key[] = "{\"sequence\":";
    return strncmp(line, key, strlen(key)) == 0 ? strtoull(line + strlen(key), NULL, 10) : 0;
}

/* Returns 1 when the message is full. */
static int add_line(void *context, const char *line)
{
    struct lines *lines = context;
    const uint64_t number = number_of(line);
    const size_t length = strlen(line);
    if (lines->bytes.size > 0 && lines->bytes.size + length + 1 > EVENTS_BYTES) {
        return 1;
    }
    iso_fleet_put(&lines->bytes, line, length);
    iso_fleet_put(&lines->bytes, "\n", 1);
    lines->first = lines->first ? lines->first : number;
    lines->last = number;
    return lines->bytes.error;
}

static int seal_lines(const struct iso_fleet *fleet, const struct lines *lines,
                      struct iso_fleet_bytes *out)
{
    const struct iso_fleet_host *host = &fleet->options.host;
    const struct iso_fleet_membership *member = &fleet->record.member;
    const struct iso_fleet_events events = {member->door, lines->first, lines->last};
    struct iso_fleet_signer signer;
    struct iso_fleet_receiver receiver;
    host->keys(host->context, &signer, &receiver);
    const int error = iso_fleet_make_events(&events, (const char *)lines->bytes.bytes,
                                            lines->bytes.size, member->hub_receives, &signer, out);
    sodium_memzero(&signer, sizeof signer);
    sodium_memzero(&receiver, sizeof receiver);
    return error;
}

int iso_fleet_events(struct iso_fleet *fleet, uint64_t after, uint32_t most,
                     struct iso_fleet_bytes *out, uint64_t *last, struct iso_fault *fault)
{
    const struct iso_fleet_host *host = &fleet->options.host;
    struct lines lines = {.first = 0};
    int error = iso__fleet_ready(fleet, fault);
    if (error) {
        return error;
    }
    if (after >= host->last_event(host->context) || most == 0) {
        *last = 0;
        return 0;
    }
    error = host->read_log(host->context, after + 1, most, add_line, &lines);
    if (error > 0) {
        error = 0;
    }
    if (!error && lines.last > 0) {
        /* Records that the log has deleted since are in none of the messages. The hub learns by
         * this number that they will not come. */
        lines.first = after + 1;
        error = seal_lines(fleet, &lines, out);
    }
    if (!error) {
        *last = lines.last;
        fleet->events_given = lines.last > fleet->events_given ? lines.last : fleet->events_given;
    }
    iso_fleet_bytes_free(&lines.bytes);
    return error ? iso_fault_set(fault, error, "the log cannot be read: %s", strerror(-error)) : 0;
}

/* ---- people who were enrolled here ---- */

struct requesting {
    struct iso_fleet *fleet;
    const struct iso_fleet_id *id;
    void (*each)(void *context, const void *bytes, size_t size);
    void *each_context;
    size_t bytes; /* so far */
};

static int make_request(struct requesting *requesting, const struct iso_fleet_person *person)
{
    const struct iso_fleet_host *host = &requesting->fleet->options.host;
    const struct iso_fleet_membership *member = &requesting->fleet->record.member;
    struct iso_fleet_bytes message = {.bytes = NULL};
    struct iso_fleet_signer signer;
    struct iso_fleet_receiver receiver;
    host->keys(host->context, &signer, &receiver);
    const int error = iso_fleet_make_request(&member->door, person, member->hub_receives, &signer,
                                             &message);
    sodium_memzero(&signer, sizeof signer);
    sodium_memzero(&receiver, sizeof receiver);
    if (!error) {
        requesting->each(requesting->each_context, message.bytes, message.size);
        requesting->bytes += message.size;
    }
    iso_fleet_bytes_free(&message);
    return error;
}

static int request(void *context, const struct iso_gallery_item *item, struct iso_fault *fault)
{
    struct requesting *requesting = context;
    const struct iso_fleet_store *store = &requesting->fleet->options.store;
    struct iso_credential_record record = iso__fleet_credential(store, item->person.id);
    char *credential = iso_credential_patch_text(&record);
    struct iso_fleet_person person = {
        .id = *requesting->id,
        .valid_from_s = item->person.valid_from_s,
        .valid_until_s = item->person.valid_until_s,
        .enrolled_s = item->person.enrolled_s,
        .name = item->person.name,
        .name_length = strlen(item->person.name),
        .credential = credential,
        .credential_length = credential ? strlen(credential) : 0,
        .n = item->n,
    };
    for (size_t i = 0; i < item->n; i++) {
        person.templates[i] = (struct iso_fleet_template){item->templates[i].algorithm,
                                                          (uint32_t)item->templates[i].size,
                                                          item->templates[i].bytes};
    }
    const int error = credential ? make_request(requesting, &person) : -ENOMEM;
    iso_credential_record_wipe(&record);
    if (credential) {
        explicit_bzero(credential, strlen(credential));
        free(credential);
    }
    return error ? iso_fault_set(fault, error, "fleet: out of memory") : 0;
}

_Static_assert((int)ISO_GALLERY_TEMPLATES_MAX <= (int)ISO_FLEET_TEMPLATES_MAX,
               "a request has room for everybody's templates");

/* The person who was enrolled here with the lowest number above `after`; NULL: nobody. */
static const struct iso__fleet_entry *next_local(const struct iso_fleet *fleet, int64_t after)
{
    const struct iso__fleet_entry *next = NULL;
    for (size_t i = 0; fleet->index.n_local > 0 && i < fleet->index.n; i++) {
        const struct iso__fleet_entry *entry = &fleet->index.entries[i];
        if (entry->revision == 0 && entry->person > after &&
            (!next || entry->person < next->person)) {
            next = entry;
        }
    }
    return next;
}

int iso_fleet_requests(struct iso_fleet *fleet,
                       void (*each)(void *context, const void *bytes, size_t size),
                       void *each_context, struct iso_fault *fault)
{
    const struct iso_fleet_store *store = &fleet->options.store;
    struct requesting requesting = {.fleet = fleet, .each = each, .each_context = each_context};
    int error = iso__fleet_ready(fleet, fault);
    const struct iso__fleet_entry *entry = NULL;
    while (!error && (entry = next_local(fleet, fleet->requests_after))) {
        if (requesting.bytes > REQUESTS_BYTES) {
            fleet->work |= ISO_FLEET_WORK_REQUESTS;
            return 0;
        }
        requesting.id = &entry->id;
        const struct iso_person *person = store->find_id(store->context, entry->person);
        error = person->templates == 0
                    ? request(&requesting, &(struct iso_gallery_item){.person = *person}, fault)
                    : store->templates(store->context, person, request, &requesting, fault);
        fleet->requests_after = error ? fleet->requests_after : entry->person;
    }
    if (!error) {
        fleet->requests_after = 0; /* the next call begins again */
    }
    return error;
}
