/* A REQUEST has the templates of a person, so that those of a whole gallery are some megabytes.
 * They are sent in rounds, the next one when the broker has the last one, so that they are never
 * all in memory. */
#include <stdlib.h>
#include <string.h>

#include "firmware/fleet/link/link_inner.h"

/* A hub that is started anew loses what it has not stored, and nobody acknowledges a REQUEST. So
 * all are sent again after this time, as long as somebody waits for approval. */
enum { ROUND_BYTES = 1 << 20, AGAIN_S = 600, UNHEARD_S = 5 };

void link_requests_free(struct link_door *door)
{
    free(door->requests.sent);
    door->requests = (struct link_requests){.sent = NULL};
}

void link_requests_start(struct link_door *door)
{
    link_requests_free(door);
    link_in(door, LINK_DUE_REQUESTS, 0);
}

/* The person of a REQUEST of the daemon, which is its second field. */
static bool read_person(const void *bytes, size_t size, struct iso_fleet_id *person)
{
    struct iso_fleet_reader in = {.bytes = bytes, .left = size};

    (void)iso_fleet_take(&in, ISO_FLEET_HEADER_BYTES + ISO_FLEET_ID_BYTES);
    iso_fleet_take_bytes(&in, person->bytes, sizeof person->bytes);
    return !in.bad;
}

static bool is_sent(const struct link_requests *requests, const struct iso_fleet_id *person)
{
    for (size_t i = 0; i < requests->n; i++) {
        if (iso_fleet_id_is_same(&requests->sent[i], person)) {
            return true;
        }
    }
    return false;
}

static bool remember(struct link_requests *requests, const struct iso_fleet_id *person)
{
    if (requests->n == requests->capacity) {
        const size_t capacity = requests->capacity ? 2 * requests->capacity : 16;
        struct iso_fleet_id *grown = reallocarray(requests->sent, capacity, sizeof *requests->sent);
        if (!grown) {
            return false;
        }
        requests->sent = grown;
        requests->capacity = capacity;
    }
    requests->sent[requests->n++] = *person;
    return true;
}

static void send_one(void *context, const void *bytes, size_t size)
{
    struct link_door *door = context;
    struct link_requests *requests = &door->requests;
    struct iso_fleet_id person;

    if (!read_person(bytes, size, &person) || is_sent(requests, &person)) {
        return;
    }
    if (requests->round_bytes >= ROUND_BYTES) {
        requests->is_cut = true;
        return;
    }
    if (link_mqtt_publish(door->mqtt, door->topic_out, bytes, size, false, &requests->round_id) ==
            0 &&
        remember(requests, &person)) {
        requests->round_bytes += size;
        door->report.requests++;
    }
}

void link_requests_send(struct link_door *door)
{
    struct iso_fault fault = {.text = ""};

    if (!door->has_daemon || !door->has_lease) {
        return;
    }
    if (door->requests.again_us && link_now_us(door) >= door->requests.again_us) {
        link_requests_free(door);
    }
    door->requests.round_bytes = 0;
    door->requests.is_cut = false;
    (void)link_daemon_minor_result(
        door, door->daemon.requests(door->daemon.context, send_one, door, &fault), &fault);
    if (door->requests.n > 0 && !door->requests.again_us) {
        door->requests.again_us = link_now_us(door) + AGAIN_S * LINK_S_US;
    }
    if (door->requests.n > 0 && !door->requests.is_cut) {
        link_at(door, LINK_DUE_REQUESTS, door->requests.again_us);
    }
}

void link_requests_unheard(struct link_door *door)
{
    if (door->requests.n > 0) {
        link_requests_free(door);
        link_in(door, LINK_DUE_REQUESTS, UNHEARD_S * LINK_S_US);
    }
}

void link_requests_published(struct link_door *door, int id)
{
    if (door->requests.is_cut && id == door->requests.round_id) {
        link_in(door, LINK_DUE_REQUESTS, 0);
    }
}
