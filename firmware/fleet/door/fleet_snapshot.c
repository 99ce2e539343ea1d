/* Everything of a zone at once: puts what is new or newer, and removes what the zone no longer
 * grants. */
#include <errno.h>
#include <fcntl.h>
#include <sodium.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "firmware/fleet/door/fleet_state.h"
#include "firmware/fleet/message/snapshot.h"

/* What of a snapshot is not about people. */
struct rules {
    char *policy;
    size_t policy_length;
    bool lockdown;
};

struct reading {
    struct iso__fleet_batch *batch;
    struct rules rules;
    struct iso_fault *fault;
    int error; /* of storing; not of the file */
};

static int take_change(void *context, const struct iso_fleet_change *change)
{
    struct reading *reading = context;
    switch (change->kind) {
    case ISO_FLEET_PUT:
        reading->error = iso__fleet_put(reading->batch, &change->person, reading->fault);
        return reading->error;
    case ISO_FLEET_POLICY:
        free(reading->rules.policy);
        reading->rules.policy = strndup(change->policy, change->policy_length);
        reading->rules.policy_length = change->policy_length;
        reading->error = reading->rules.policy ? 0 : -ENOMEM;
        return reading->error;
    case ISO_FLEET_LOCKDOWN:
        reading->rules.lockdown = change->lockdown;
        return 0;
    default:
        return -EBADMSG;
    }
}

/* Says what a verified snapshot is for a zone. APPLIED: it can be taken, with *key. */
static enum iso_fleet_outcome judge(const struct iso__fleet_zone *zone,
                                    const struct iso_fleet_place *place,
                                    const struct iso_fleet_zone_key **key)
{
    const struct iso_fleet_place *here = &zone->place;
    if (zone->has_next && place->epoch == zone->next.base.epoch) {
        *key = &zone->next.key;
        return place->sequence >= zone->next.base.sequence ? ISO_FLEET_APPLIED : ISO_FLEET_REFUSED;
    }
    if (place->epoch != here->epoch || here->epoch == 0) {
        return place->epoch > here->epoch ? ISO_FLEET_NO_KEY : ISO_FLEET_REFUSED;
    }
    if (zone->has_next && zone->next.reset) {
        return ISO_FLEET_REFUSED; /* of the history that the hub has given up */
    }
    const bool is_here = place->sequence == here->sequence;
    const bool is_same = memcmp(place->digest, here->digest, sizeof here->digest) == 0;
    *key = &zone->key;
    if (is_here && !is_same) {
        return ISO_FLEET_REFUSED;
    }
    return place->sequence < here->sequence || (is_here && !zone->wants_snapshot)
               ? ISO_FLEET_KNOWN
               : ISO_FLEET_APPLIED;
}

/* The zone of a draft at the place of the snapshot. */
static void arrive(struct iso__fleet_zone *zone, const struct iso_fleet_place *place)
{
    if (zone->has_next && place->epoch == zone->next.base.epoch) {
        zone->key = zone->next.key;
        zone->has_next = false;
        sodium_memzero(&zone->next, sizeof zone->next);
    }
    zone->place = *place;
    zone->wants_snapshot = zone->behind = false;
    iso__fleet_advance(zone);
}

/* Policy and lockdown come first, each with the present place, and then the people and the place:
 * so the place says that everything is done. */
static int take_rules(struct iso_fleet *fleet, const struct iso_fleet_id *id,
                      const struct rules *rules, struct iso_fault *fault)
{
    struct iso__fleet_record draft = fleet->record;
    struct iso__fleet_zone *zone = iso__fleet_zone_of(&draft, id);
    int error = 0;
    if (zone->lockdown != rules->lockdown) {
        error = iso__fleet_take_lockdown(fleet, &draft, zone, rules->lockdown, fault);
    }
    if (!error) {
        error = iso__fleet_take_policy(fleet, &draft, zone, rules->policy ? rules->policy : "",
                                       rules->policy_length, fault);
    }
    sodium_memzero(&draft, sizeof draft);
    return error;
}

static int take_people(struct iso_fleet *fleet, struct reading *reading,
                       const struct iso_fleet_place *place, struct iso_fault *fault)
{
    struct iso__fleet_record draft = fleet->record;
    arrive(iso__fleet_zone_of(&draft, &place->zone), place);
    const int error = iso__fleet_withdraw_all(reading->batch, &draft, fault);
    sodium_memzero(&draft, sizeof draft);
    return error;
}

/* An error of the file, which is verified, means that the hub made it wrong or that its key is
 * another one: it is refused. An error of storing goes to the caller. */
static int apply(struct iso_fleet *fleet, const uint8_t *bytes, size_t size,
                 const struct iso_fleet_place *place, const struct iso_fleet_zone_key *with,
                 enum iso_fleet_outcome *outcome, struct iso_fault *fault)
{
    struct iso_fleet_zone_key key = *with; /* that of the record may move to another place */
    const struct iso__fleet_note note = {
        .reason = "snapshot", .zone = &place->zone, .sequence = place->sequence};
    const struct iso__fleet_zone *zone = iso__fleet_zone_of(&fleet->record, &place->zone);
    struct reading reading = {.fault = fault};
    fleet->snapshots++;
    int error = iso__fleet_note(fleet, &note, true, fault);
    if (!error &&
        iso__fleet_batch_new(fleet, &place->zone, iso__fleet_zone_bit(&fleet->record, zone),
                             place->sequence, fleet->snapshots, &reading.batch)) {
        error = iso_fault_set(fault, -ENOMEM, "fleet: out of memory");
    }
    if (!error) {
        error = iso_fleet_snapshot_each(bytes, size, &key, take_change, &reading);
        if (error && !reading.error && error != -ENOMEM) {
            if (error == -EPROTONOSUPPORT) {
                iso__fleet_complain_of_newer(fleet);
            }
            *outcome = ISO_FLEET_REFUSED;
            error = 0;
        } else if (!error) {
            error = take_rules(fleet, &place->zone, &reading.rules, fault);
            error = error ? error : take_people(fleet, &reading, place, fault);
            *outcome = ISO_FLEET_APPLIED;
        }
    }
    iso__fleet_batch_free(reading.batch);
    free(reading.rules.policy);
    sodium_memzero(&key, sizeof key);
    return error;
}

int iso_fleet_snapshot(struct iso_fleet *fleet, const uint8_t *bytes, size_t size,
                       enum iso_fleet_outcome *outcome, struct iso_fleet_id *zone,
                       struct iso_fault *fault)
{
    struct iso_fleet_place place;
    const struct iso_fleet_zone_key *key = NULL;
    enum iso_fleet_outcome result = ISO_FLEET_REFUSED;
    struct iso_fleet_id id = {.bytes = {0}};
    int error = iso__fleet_ready(fleet, fault);
    if (error) {
        return error;
    }
    const int found = iso_fleet_snapshot_verify(bytes, size, fleet->record.member.hub_signs,
                                                &place);
    if (found == -EPROTONOSUPPORT) {
        iso__fleet_complain_of_newer(fleet);
    } else if (found == 0) {
        const struct iso__fleet_zone *own = iso__fleet_zone_of(&fleet->record, &place.zone);
        if (own) {
            id = place.zone;
            result = judge(own, &place, &key);
        }
        if (result == ISO_FLEET_APPLIED) {
            error = apply(fleet, bytes, size, &place, key, &result, fault);
        }
    }
    if (!error) {
        *outcome = result;
        *zone = id;
    }
    return error;
}

/* Copies a file, because whoever can shorten it while it is mapped ends the process. */
static int copy_file(int fd, size_t size, uint8_t **out, struct iso_fault *fault)
{
    size_t done = 0;
    uint8_t *bytes = malloc(size);
    if (!bytes) {
        return iso_fault_set(fault, -ENOMEM, "fleet: out of memory");
    }
    while (done < size) {
        const ssize_t n = pread(fd, bytes + done, size - done, (off_t)done);
        if (n <= 0) {
            free(bytes);
            return iso_fault_set(fault, -EIO, "the snapshot cannot be read: %s",
                                 n < 0 ? strerror(errno) : "it is shorter than it was");
        }
        done += (size_t)n;
    }
    *out = bytes;
    return 0;
}

int iso_fleet_snapshot_file(struct iso_fleet *fleet, int fd, enum iso_fleet_outcome *outcome,
                            struct iso_fleet_id *zone, struct iso_fault *fault)
{
    struct stat status;
    uint8_t *bytes = NULL;
    if (fstat(fd, &status) || !S_ISREG(status.st_mode)) {
        return iso_fault_set(fault, -EINVAL, "the snapshot is not a file");
    }
    if (status.st_size > ISO_FLEET_SNAPSHOT_MAX) {
        return iso_fault_set(fault, -EFBIG, "the snapshot is larger than %d MiB",
                             ISO_FLEET_SNAPSHOT_MAX >> 20);
    }
    if (status.st_size == 0) {
        return iso_fleet_snapshot(fleet, (const uint8_t *)"", 0, outcome, zone, fault);
    }
    const size_t size = (size_t)status.st_size;
    const int seals = fcntl(fd, F_GET_SEALS);
    if (seals < 0 || !(seals & F_SEAL_SHRINK)) {
        const int error = copy_file(fd, size, &bytes, fault);
        if (error) {
            return error;
        }
        const int result = iso_fleet_snapshot(fleet, bytes, size, outcome, zone, fault);
        free(bytes);
        return result;
    }
    void *mapped = mmap(NULL, size, PROT_READ, MAP_PRIVATE, fd, 0);
    if (mapped == MAP_FAILED) {
        return iso_fault_set(fault, -errno, "the snapshot cannot be read: %m");
    }
    const int error = iso_fleet_snapshot(fleet, mapped, size, outcome, zone, fault);
    (void)munmap(mapped, size);
    return error;
}
