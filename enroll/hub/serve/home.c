/* Announces the doors to Home Assistant. The leader compares what is published with the doors every
 * few seconds, and publishes what has changed. */
#include <sodium.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/hub/serve/home_text.h"
#include "enroll/hub/serve/service.h"
#include "enroll/hub/store/hub_zone.h"

enum { EVERY_S = 5 };

/* What the broker has of a door. */
struct hub_home_door {
    struct iso_fleet_id id;
    uint8_t digest[ISO_FLEET_DIGEST_BYTES];
};

struct pass {
    struct hub_service *service;
    struct iso_fleet_id *lockdowns;
    size_t n_lockdowns;
    size_t next;  /* where the entry of the next door probably is */
    bool is_lost; /* the broker or the memory */
};

static int remember_lockdown(void *context, const struct hub_zone *zone)
{
    struct pass *pass = context;

    if (!zone->lockdown) {
        return 0;
    }
    struct iso_fleet_id *larger = reallocarray(pass->lockdowns, pass->n_lockdowns + 1,
                                               sizeof *larger);
    if (!larger) {
        pass->is_lost = true;
        return 0;
    }
    larger[pass->n_lockdowns++] = zone->place.zone;
    pass->lockdowns = larger;
    return 0;
}

static bool is_in_lockdown(const struct pass *pass, const struct hub_door *door)
{
    for (size_t i = 0; i < pass->n_lockdowns; i++) {
        for (size_t j = 0; j < door->n_zones; j++) {
            if (iso_fleet_id_is_same(&pass->lockdowns[i], &door->zones[j])) {
                return true;
            }
        }
    }
    return false;
}

/* The entry of a door; a new one has a digest of zeros. NULL: no memory. The doors come in the same
 * order each time, so the search begins after the entry of the door before. */
static struct hub_home_door *entry_of(struct pass *pass, const struct iso_fleet_id *id)
{
    struct hub_service *service = pass->service;

    for (size_t i = 0; i < service->n_home; i++) {
        const size_t at = (pass->next + i) % service->n_home;
        if (iso_fleet_id_is_same(&service->home[at].id, id)) {
            pass->next = at + 1;
            return &service->home[at];
        }
    }
    struct hub_home_door *larger = reallocarray(service->home, service->n_home + 1,
                                                sizeof *service->home);
    if (!larger) {
        return NULL;
    }
    service->home = larger;
    larger[service->n_home] = (struct hub_home_door){.id = *id};
    return &larger[service->n_home++];
}

static bool put(struct hub_service *service, const char *topic, char *text)
{
    const bool ok = text && hub__emit(service, topic, text, strlen(text), true) == 0;

    free(text);
    return ok;
}

/* An expelled door is forgotten by empty messages. */
static bool put_door(struct hub_service *service, const struct hub_door *door, const char *state)
{
    char topic[HOME_TOPIC_SIZE];
    const bool is_gone = door->expelled_s != 0;
    bool ok = true;

    for (int part = 0; ok && part < HOME_PARTS; part++) {
        ok = put(service, home_topic_config(door, part, topic),
                 is_gone ? strdup("") : home_config(door, part, service->store.hub_name));
    }
    return ok && put(service, home_topic_state(door, topic), strdup(is_gone ? "" : state));
}

static int publish_door(void *context, const struct hub_door *door)
{
    struct pass *pass = context;
    struct hub_service *service = pass->service;
    uint8_t digest[ISO_FLEET_DIGEST_BYTES];
    crypto_generichash_state hash;

    if (door->joined_s == 0 || pass->is_lost) {
        return 0;
    }
    char *state = home_state(door, is_in_lockdown(pass, door));
    struct hub_home_door *entry = state ? entry_of(pass, &door->id) : NULL;
    if (!entry) {
        free(state);
        pass->is_lost = true;
        return 0;
    }
    const bool is_gone = door->expelled_s != 0;
    (void)crypto_generichash_init(&hash, NULL, 0, sizeof digest);
    (void)crypto_generichash_update(&hash, (const uint8_t *)&is_gone, sizeof is_gone);
    (void)crypto_generichash_update(&hash, (const uint8_t *)door->name, strlen(door->name));
    (void)crypto_generichash_update(&hash, (const uint8_t *)state, strlen(state));
    (void)crypto_generichash_final(&hash, digest, sizeof digest);
    if (memcmp(digest, entry->digest, sizeof digest) != 0) {
        if (put_door(service, door, state)) {
            memcpy(entry->digest, digest, sizeof digest);
        } else {
            pass->is_lost = true;
        }
    }
    free(state);
    return 0;
}

void hub__home_publish(struct hub_service *service, bool everything)
{
    const int64_t now_s = (int64_t)hub__clock_s();
    struct pass pass = {.service = service};

    if (everything) {
        service->n_home = 0;
        service->homed_s = 0;
    }
    if (!service->is_leader || !service->options->home_assistant ||
        !hub_mqtt_is_connected(service->mqtt) || now_s - service->homed_s < EVERY_S) {
        return;
    }
    service->homed_s = now_s;
    if (hub_zone_each(&service->store, remember_lockdown, &pass, NULL) == 0) {
        (void)!hub_door_each(&service->store, true, publish_door, &pass, NULL);
    }
    free(pass.lockdowns);
}
