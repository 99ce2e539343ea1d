/* Handing over what was fetched. A reply may have thousands of deltas, so that a part of it is
 * handed over in each turn of the event loop. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "firmware/fleet/link/link_inner.h"
#include "firmware/fleet/message/delta.h"
#include "firmware/fleet/message/snapshot.h"

enum { PART = 16, LENGTH_BYTES = 4 };

static bool read_at(const struct link_fetch *fetch, uint64_t offset, void *out, size_t n)
{
    size_t done = 0;

    if (n > fetch->size || offset > fetch->size - n) {
        return false;
    }
    while (done < n) {
        const ssize_t r = pread(fetch->fd, (uint8_t *)out + done, n - done, (off_t)(offset + done));
        if (r == 0 || (r < 0 && errno != EINTR)) {
            return false;
        }
        done += r > 0 ? (size_t)r : 0;
    }
    return true;
}

/* The next delta of the reply, which the caller frees; NULL: the reply is bad. */
static uint8_t *next_delta(struct link_fetch *fetch, size_t *size)
{
    uint8_t length[LENGTH_BYTES];

    if (!read_at(fetch, fetch->offset, length, sizeof length)) {
        return NULL;
    }
    struct iso_fleet_reader in = {.bytes = length, .left = sizeof length};
    *size = iso_fleet_take_u32(&in);
    if (*size == 0 || *size > ISO_FLEET_MESSAGE_MAX) {
        return NULL;
    }
    uint8_t *bytes = malloc(*size);
    if (bytes && !read_at(fetch, fetch->offset + LENGTH_BYTES, bytes, *size)) {
        free(bytes);
        return NULL;
    }
    fetch->offset += LENGTH_BYTES + *size;
    return bytes;
}

/* Whether the next delta may follow. */
static bool hand_delta(struct link_door *door, const void *bytes, size_t size)
{
    struct iso_link_outcome outcome = {.outcome = ISO_FLEET_REFUSED};
    struct iso_fault fault = {.text = ""};
    struct iso_fleet_delta delta;
    int r = iso_fleet_read_delta(bytes, size, door->status.hub_signs, &delta);

    if (r == -EPROTONOSUPPORT) {
        link_hand_newer(door, bytes, size);
        return false;
    }
    if (r < 0 || !iso_fleet_id_is_same(&delta.place.zone, &door->fetch.zone)) {
        door->report.forged++;
        link_note(door, "%s: a delta that the hub has not made: %s", door->hub_url,
                  strerror(r < 0 ? -r : EBADMSG));
        return false;
    }
    r = door->daemon.receive(door->daemon.context, bytes, size, &outcome, &fault);
    if (link_daemon_result(door, r, &fault) < 0) {
        return false;
    }
    struct link_zone *zone = link_zone_of(door, &delta.place.zone);
    if (outcome.outcome == ISO_FLEET_APPLIED && zone) {
        zone->mine.sequence = delta.place.sequence;
        door->fetch.has_news = true;
    }
    if (outcome.outcome == ISO_FLEET_WHOLE) {
        /* The next fetch is another one, so it need not wait. */
        door->fetch.has_news = true;
    }
    link_act(door, ISO_FLEET_DELTA, &outcome);
    return outcome.outcome == ISO_FLEET_APPLIED || outcome.outcome == ISO_FLEET_KNOWN;
}

/* The link verifies the file before the daemon gets it, and the daemon verifies it again. One of a
 * newer version goes to the daemon, too, which refuses it and keeps why. */
static bool verify_snapshot(struct link_door *door)
{
    struct link_fetch *fetch = &door->fetch;
    struct iso_fleet_place place = {.sequence = 0};
    void *bytes = mmap(NULL, (size_t)fetch->size, PROT_READ, MAP_PRIVATE, fetch->fd, 0);

    if (bytes == MAP_FAILED) {
        link_note(door, "a snapshot cannot be read: %s", strerror(errno));
        return false;
    }
    const int r = iso_fleet_snapshot_verify(bytes, (size_t)fetch->size, door->status.hub_signs,
                                            &place);
    (void)munmap(bytes, (size_t)fetch->size);
    if (r == -EPROTONOSUPPORT) {
        link_note(door, "%s: a snapshot of a newer version; upgrade isotherm on this door",
                  door->hub_url);
        return true;
    }
    if (r < 0 || !iso_fleet_id_is_same(&place.zone, &fetch->zone)) {
        door->report.forged++;
        link_note(door, "%s: a snapshot that the hub has not made: %s", door->hub_url,
                  strerror(r < 0 ? -r : EBADMSG));
        return false;
    }
    return true;
}

static void apply_snapshot(struct link_door *door)
{
    struct iso_link_outcome outcome = {.outcome = ISO_FLEET_REFUSED};
    struct iso_fault fault = {.text = ""};
    bool has_failed = !verify_snapshot(door);

    if (!has_failed) {
        const int r = door->daemon.snapshot(door->daemon.context, door->fetch.fd, &outcome, &fault);
        if (link_daemon_minor_result(door, r, &fault) == 0) {
            door->fetch.has_news = outcome.outcome == ISO_FLEET_APPLIED;
            has_failed = outcome.outcome != ISO_FLEET_APPLIED && outcome.outcome != ISO_FLEET_KNOWN;
            link_act(door, ISO_FLEET_SNAPSHOT, &outcome);
        } else if (door->has_daemon) {
            has_failed = true; /* the disk is full, for example; the file is long */
        } else {
            return;
        }
    }
    link_fetch_end(door, has_failed, 0);
}

static bool is_snapshot(const struct link_fetch *fetch)
{
    uint8_t start[ISO_FLEET_HEADER_BYTES + ISO_FLEET_SIGNATURE_BYTES]; /* the shortest message */
    enum iso_fleet_kind kind = ISO_FLEET_DELTA;

    /* The first four bytes of a message would be a length that is too large. */
    if (!read_at(fetch, 0, start, sizeof start)) {
        return false;
    }
    const int r = iso_fleet_kind_of(start, sizeof start, &kind);
    return r == -EPROTONOSUPPORT || (r == 0 && kind == ISO_FLEET_SNAPSHOT);
}

void link_fetch_apply(struct link_door *door)
{
    struct link_fetch *fetch = &door->fetch;

    if (fetch->fd < 0 || !door->has_daemon) {
        return;
    }
    if (fetch->offset == 0 && is_snapshot(fetch)) {
        apply_snapshot(door);
        return;
    }
    for (int i = 0; i < PART && fetch->offset < fetch->size; i++) {
        size_t size = 0;
        uint8_t *bytes = next_delta(fetch, &size);
        const bool fits = bytes && hand_delta(door, bytes, size);
        if (!bytes) {
            link_note(door, "%s: a reply that is no list of deltas", door->hub_url);
        }
        free(bytes);
        if (!door->has_daemon) {
            return;
        }
        if (!fits) {
            link_fetch_end(door, true, 0);
            return;
        }
    }
    if (fetch->offset < fetch->size) {
        link_in(door, LINK_DUE_APPLY, 0);
    } else {
        link_fetch_end(door, false, 0);
    }
}
