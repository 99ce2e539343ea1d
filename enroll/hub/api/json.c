/* What the API shows of zones, doors and people. */
#include <errno.h>
#include <string.h>

#include "enroll/hub/api/look.h"

enum { SILENT_S = 180 }; /* a door reports once a minute at least */

json_t *hub__json_zone(const struct hub_zone *zone)
{
    char id[ISO_FLEET_ID_TEXT_SIZE];

    return json_pack("{s:s, s:s, s:I, s:I, s:I, s:I, s:I, s:b, s:b, s:b, s:b, s:b}", "id",
                     iso_fleet_id_text(&zone->place.zone, id), "name", zone->name, "epoch",
                     (json_int_t)zone->place.epoch, "sequence", (json_int_t)zone->place.sequence,
                     "people", (json_int_t)zone->people, "doors", (json_int_t)zone->doors,
                     "lease_s", (json_int_t)zone->settings.lease_s, "local_people",
                     zone->settings.local_people, "approve_auto", zone->settings.approve_auto,
                     "lockdown", zone->lockdown, "behind", zone->behind, "published",
                     zone->published >= zone->place.sequence);
}

static json_t *zones_of_door(const struct hub_door *door, const struct hub_waits *waits,
                             bool *is_waiting)
{
    char id[ISO_FLEET_ID_TEXT_SIZE];
    json_t *zones = json_array();

    for (size_t i = 0; i < door->n_zones; i++) {
        const bool waiting = hub__waits_for(waits, &door->id, &door->zones[i]);
        *is_waiting |= waiting;
        (void)json_array_append_new(zones, json_pack("{s:s, s:s, s:b}", "id",
                                                     iso_fleet_id_text(&door->zones[i], id), "name",
                                                     door->zone_names[i], "confirmed",
                                                     !waiting && door->joined_s > 0));
    }
    return zones;
}

/* What a list shows of the health; the door's own page shows all of it. */
static json_t *short_health(const json_t *health)
{
    static const char *const keys[] = {"door-state", "tamper",       "sensor-state", "fault",
                                       "people",     "local-people", "lockdown"};
    json_t *out = json_object();

    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++) {
        json_t *value = json_object_get(health, keys[i]);
        if (value) {
            (void)json_object_set(out, keys[i], value);
        }
    }
    return out;
}

static bool says(const json_t *health, const char *key, const char *const *words)
{
    const char *text = json_string_value(json_object_get(health, key));

    while (text && *words && strcmp(*words, text) != 0) {
        words++;
    }
    return text && *words;
}

/* A number that is not 0, or true. */
static bool is_set(const json_t *health, const char *key)
{
    const json_t *value = json_object_get(health, key);

    return json_is_true(value) || json_integer_value(value) != 0;
}

/* Why somebody should look at the door: words of openapi.json. */
static json_t *attention(const struct hub_door *door, const json_t *health, bool is_waiting,
                         int64_t now_s)
{
    static const char *const bad_states[] = {"forced", "held-open", "fault", NULL};
    static const char *const bad_sensor[] = {"lost", "silent", "repeats", NULL};
    const char *fault = json_string_value(json_object_get(health, "fault"));
    const struct {
        bool holds;
        const char *word;
    } all[] = {
        {door->joined_s == 0 && door->code_until_s <= now_s, "code-ended"},
        {door->joined_s > 0 && !door->online, "offline"},
        {door->joined_s > 0 && door->online && now_s - door->reported_s > SILENT_S, "silent"},
        {door->joined_s > 0 && is_waiting, "unconfirmed"},
        {is_set(health, "hub-behind"), "hub-behind"},
        {says(health, "door-state", bad_states), "door-state"},
        {is_set(health, "tamper"), "tamper"},
        {says(health, "sensor-state", bad_sensor), "sensor"},
        {fault && *fault, "fault"},
    };
    json_t *words = json_array();

    for (size_t i = 0; door->expelled_s == 0 && i < sizeof all / sizeof *all; i++) {
        if (all[i].holds) {
            (void)json_array_append_new(words, json_string(all[i].word));
        }
    }
    return words;
}

json_t *hub__json_door(const struct hub_door *door, const struct hub_waits *waits, int64_t now_s,
                       bool whole)
{
    char id[ISO_FLEET_ID_TEXT_SIZE];
    bool is_waiting = false;
    json_t *health = json_loads(door->health, JSON_REJECT_DUPLICATES, NULL);
    json_t *zones = zones_of_door(door, waits, &is_waiting);
    json_t *out = json_pack("{s:s, s:s, s:s, s:b, s:I, s:I, s:I, s:I, s:I, s:I, s:o, s:o, s:o}",
                            "id", iso_fleet_id_text(&door->id, id), "name", door->name, "state",
                            door->expelled_s ? "expelled"
                            : door->joined_s ? "joined"
                                             : "waiting",
                            "online", door->online, "joined_s", (json_int_t)door->joined_s,
                            "code_until_s", (json_int_t)door->code_until_s, "reported_s",
                            (json_int_t)door->reported_s, "door_time_s",
                            (json_int_t)door->door_time_s, "last_event",
                            (json_int_t)door->last_event, "stored_events", (json_int_t)door->acked,
                            "zones", zones, "attention", attention(door, health, is_waiting, now_s),
                            "health", whole && health ? json_incref(health) : short_health(health));

    json_decref(health);
    return out;
}

json_t *hub__json_person(const struct hub_person *person)
{
    char id[ISO_FLEET_ID_TEXT_SIZE];
    json_t *zones = json_array();

    for (size_t i = 0; i < person->n_zones; i++) {
        char zone[ISO_FLEET_ID_TEXT_SIZE];
        (void)json_array_append_new(zones, json_pack("{s:s, s:s}", "id",
                                                     iso_fleet_id_text(&person->zones[i], zone),
                                                     "name", person->zone_names[i]));
    }
    return json_pack("{s:s, s:s, s:I, s:I, s:I, s:b, s:I, s:o}", "id",
                     iso_fleet_id_text(&person->id, id), "name", person->name, "enrolled_s",
                     (json_int_t)person->enrolled_s, "valid_from_s",
                     (json_int_t)person->valid_from_s, "valid_until_s",
                     (json_int_t)person->valid_until_s, "offline_ok", person->offline_ok,
                     "templates", (json_int_t)person->templates, "zones", zones);
}

static int append_behind(void *list, const struct hub_behind *door)
{
    char id[ISO_FLEET_ID_TEXT_SIZE];

    return json_array_append_new(list, json_pack("{s:s, s:s, s:b, s:I}", "id",
                                                 iso_fleet_id_text(&door->door, id), "name",
                                                 door->name, "online", door->online, "reported_s",
                                                 (json_int_t)door->reported_s))
               ? -ENOMEM
               : 0;
}

int hub__json_unconfirmed(struct hub_store *store, const struct iso_fleet_id *zone, json_t **out,
                          struct iso_fault *fault)
{
    json_t *list = json_array();
    const int error = hub_doors_behind(store, zone, append_behind, list, fault);

    if (error) {
        json_decref(list);
        return error == -ENOMEM ? hub__no_memory(fault) : error;
    }
    *out = list;
    return 0;
}

int hub__json_zones_waiting(struct hub_store *store, const struct iso_fleet_id *zones, size_t n,
                            json_t **out, struct iso_fault *fault)
{
    json_t *list = json_array();
    int error = list ? 0 : hub__no_memory(fault);

    for (size_t i = 0; !error && i < n; i++) {
        char id[ISO_FLEET_ID_TEXT_SIZE];
        struct hub_zone zone;
        json_t *doors = NULL;
        error = hub_zone_find(store, iso_fleet_id_text(&zones[i], id), &zone, fault);
        error = error ? error : hub__json_unconfirmed(store, &zones[i], &doors, fault);
        if (!error && json_array_append_new(list, json_pack("{s:s, s:s, s:b, s:o}", "id", id,
                                                            "name", zone.name, "lockdown",
                                                            zone.lockdown, "unconfirmed", doors))) {
            error = hub__no_memory(fault);
        }
    }
    if (error) {
        json_decref(list);
        return error;
    }
    *out = list;
    return 0;
}
