/* Getting a reply: which zone, when, and what becomes of a failure. */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "firmware/fleet/link/link_inner.h"

enum {
    DELTAS_TIME_S = 120,
    SNAPSHOT_TIME_S = 3600,
    STATUS_OK = 200,
    STATUS_NOT_FOUND = 404,
    STATUS_GONE = 410,
};

#define DELTAS_MOST_BYTES   (UINT64_C(256) << 20)
#define SNAPSHOT_MOST_BYTES (UINT64_C(8) << 30)

static const char path[] = "/fleet/v1/fetch";

static bool is_fetching(const struct link_door *door)
{
    return door->fetch.request || door->fetch.fd >= 0;
}

static struct link_zone *next_zone(struct link_door *door)
{
    for (size_t i = 0; i < door->zone_count; i++) {
        struct link_zone *zone = &door->zones[(door->fetch.turn + i) % door->zone_count];
        if (link_zone_lacks(zone)) {
            return zone;
        }
    }
    return NULL;
}

/* ---- the end ---- */

static void close_reply(struct link_fetch *fetch)
{
    if (fetch->fd >= 0) {
        (void)close(fetch->fd);
    }
    fetch->fd = -1;
}

void link_fetch_cancel(struct link_door *door)
{
    link_http_cancel(door->fetch.request);
    door->fetch.request = NULL;
    close_reply(&door->fetch);
    link_never(door, LINK_DUE_APPLY);
    link_never(door, LINK_DUE_FETCH);
}

static void wait_longer(struct link_door *door, uint32_t least_s)
{
    const uint64_t wait = link_backoff_next_us(&door->fetch.backoff, link_random());
    const uint64_t least = least_s * LINK_S_US;

    door->report.failed_fetches++;
    door->fetch.turn++;
    door->fetch.not_before_us = link_now_us(door) + (wait > least ? wait : least);
}

void link_fetch_end(struct link_door *door, bool has_failed, uint32_t least_s)
{
    struct link_fetch *fetch = &door->fetch;

    close_reply(fetch);
    link_never(door, LINK_DUE_APPLY);
    if (link_zones_read(door) < 0) {
        return;
    }
    struct link_zone *zone = link_zone_of(door, &fetch->zone);
    const bool still_lacks = zone && link_zone_lacks(zone);
    if (has_failed || (still_lacks && !fetch->has_news)) {
        wait_longer(door, least_s);
        link_ask(door);
    } else {
        link_backoff_reset(&fetch->backoff);
    }
    if (next_zone(door)) {
        link_in(door, LINK_DUE_FETCH, 0);
    }
}

/* ---- the reply ---- */

/* The hub may not have the deltas any more: then it has a snapshot. */
static bool is_gone(const struct link_fetch *fetch, int status)
{
    return fetch->what == ISO_FLEET_WANT_DELTAS &&
           (status == STATUS_GONE || status == STATUS_NOT_FOUND);
}

static void on_reply(void *context, const struct link_http_reply *reply)
{
    struct link_door *door = context;
    struct link_fetch *fetch = &door->fetch;

    fetch->request = NULL;
    if (reply->error == 0 && reply->status == STATUS_OK) {
        fetch->fd = reply->fd;
        fetch->size = reply->size;
        fetch->offset = 0;
        door->report.fetches++;
        link_in(door, LINK_DUE_APPLY, 0);
        return;
    }
    if (reply->fd >= 0) {
        (void)close(reply->fd);
    }
    struct link_zone *zone = link_zone_of(door, &fetch->zone);
    if (reply->error == 0 && zone && is_gone(fetch, reply->status)) {
        zone->is_whole_due = true;
        fetch->has_news = true;
        link_fetch_end(door, false, 0);
        return;
    }
    link_note(door, "%s%s: %s (status %d)", door->hub_url, path,
              reply->error ? reply->why : "the hub refuses", reply->status);
    link_fetch_end(door, true, reply->retry_after_s);
}

static int post(struct link_door *door, const struct iso_fleet_bytes *body, struct iso_fault *fault)
{
    char url[512];
    const bool is_whole = door->fetch.what == ISO_FLEET_WANT_SNAPSHOT;

    (void)snprintf(url, sizeof url, "%s%s", door->hub_url, path);
    const struct link_http_setup setup = {
        .url = url,
        .ca_file = door->broker.ca_file,
        .type = "application/octet-stream",
        .body = body->bytes,
        .size = body->size,
        .most_bytes = is_whole ? SNAPSHOT_MOST_BYTES : DELTAS_MOST_BYTES,
        .time_s = is_whole ? SNAPSHOT_TIME_S : DELTAS_TIME_S,
        .folder = door->folder,
    };
    return link_http_post(door->http, &setup, on_reply, door, &door->fetch.request, fault);
}

void link_fetch_next(struct link_door *door)
{
    struct link_fetch *fetch = &door->fetch;
    struct iso_fleet_bytes body = {.bytes = NULL};
    struct iso_fault fault = {.text = ""};

    if (is_fetching(door) || !door->has_daemon) {
        return;
    }
    if (link_now_us(door) < fetch->not_before_us) {
        link_at(door, LINK_DUE_FETCH, fetch->not_before_us);
        return;
    }
    struct link_zone *zone = next_zone(door);
    if (!zone) {
        return;
    }
    fetch->zone = zone->mine.zone;
    fetch->what = link_zone_lacks_all(zone) ? ISO_FLEET_WANT_SNAPSHOT : ISO_FLEET_WANT_DELTAS;
    fetch->has_news = false;
    int r = door->daemon.fetch(door->daemon.context, &fetch->zone, fetch->what, &body, &fault);
    r = link_daemon_minor_result(door, r, &fault);
    if (r == 0) {
        r = post(door, &body, &fault);
        iso_fleet_bytes_free(&body);
        if (r < 0) {
            link_note(door, "%s", fault.text);
        }
    }
    if (r < 0 && door->has_daemon) {
        link_fetch_end(door, true, 0);
    }
}
