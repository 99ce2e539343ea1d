#include <errno.h>
#include <string.h>

#include "firmware/fleet/link/link_inner.h"

struct link_zone *link_zone_of(struct link_door *door, const struct iso_fleet_id *id)
{
    for (size_t i = 0; i < door->zone_count; i++) {
        if (iso_fleet_id_is_same(&door->zones[i].mine.zone, id)) {
            return &door->zones[i];
        }
    }
    return NULL;
}

bool link_zone_lacks_all(const struct link_zone *zone)
{
    return zone->is_whole_wanted || zone->is_whole_due;
}

bool link_zone_lacks(const struct link_zone *zone)
{
    return link_zone_lacks_all(zone) || zone->target > zone->mine.sequence;
}

void link_zone_aim(struct link_door *door, struct link_zone *zone, uint64_t target)
{
    zone->target = target;
    if (link_zone_lacks(zone)) {
        link_in(door, LINK_DUE_FETCH, 0);
    }
}

/* The zones as the daemon has them; what the link knows of them besides is kept. */
static void take_zones(struct link_door *door, const struct iso_link_status *status)
{
    struct link_zone zones[ISO_FLEET_ZONES_MAX] = {{.target = 0}};

    for (size_t i = 0; i < status->n; i++) {
        const struct link_zone *known = link_zone_of(door, &status->places[i].zone);
        if (known) {
            zones[i] = *known;
        }
        zones[i].mine = status->places[i];
        zones[i].is_whole_wanted = status->wants_snapshot[i];
    }
    memcpy(door->zones, zones, sizeof zones);
    door->zone_count = status->n;
    for (size_t i = 0; i < door->zone_count; i++) {
        link_zone_aim(door, &door->zones[i], door->zones[i].target);
    }
}

int link_zones_read(struct link_door *door)
{
    struct iso_link_status status = {.n = 0};
    struct iso_fault fault = {.text = ""};
    int r = door->daemon.status(door->daemon.context, &status, &fault);

    if (r == 0 && status.n > ISO_FLEET_ZONES_MAX) {
        r = iso_fault_set(&fault, -EPROTO, "the daemon names %zu zones", status.n);
    }
    if (link_daemon_result(door, r, &fault) < 0) {
        return r;
    }
    door->status = status;
    take_zones(door, &status);
    return 0;
}

/* ---- the subscriptions ---- */

struct topics {
    char texts[2 * ISO_FLEET_ZONES_MAX + 1][ISO_FLEET_TOPIC_SIZE];
    const char *list[2 * ISO_FLEET_ZONES_MAX + 1];
    int n;
};

static void add_zone(struct topics *topics, const struct iso_fleet_id *zone)
{
    topics->list[topics->n] = iso_fleet_topic_delta(zone, topics->texts[topics->n]);
    topics->n++;
    topics->list[topics->n] = iso_fleet_topic_head(zone, topics->texts[topics->n]);
    topics->n++;
}

static bool is_subscribed(const struct link_door *door, const struct iso_fleet_id *zone)
{
    for (size_t i = 0; i < door->subscribed_count; i++) {
        if (iso_fleet_id_is_same(&door->subscribed[i], zone)) {
            return true;
        }
    }
    return false;
}

static void leave_lost_zones(struct link_door *door)
{
    struct topics topics = {.n = 0};

    for (size_t i = 0; i < door->subscribed_count; i++) {
        if (!link_zone_of(door, &door->subscribed[i])) {
            add_zone(&topics, &door->subscribed[i]);
        }
    }
    if (topics.n && link_mqtt_unsubscribe(door->mqtt, topics.list, topics.n) < 0) {
        link_note(door, "the topics of a lost zone stay subscribed");
    }
}

void link_zones_subscribe(struct link_door *door, bool all)
{
    struct topics topics = {.n = 0};

    if (!door->mqtt || !link_mqtt_is_connected(door->mqtt)) {
        return;
    }
    if (all) {
        door->subscribed_count = 0;
        topics.list[topics.n++] = door->topic_in;
    }
    leave_lost_zones(door);
    for (size_t i = 0; i < door->zone_count; i++) {
        if (!is_subscribed(door, &door->zones[i].mine.zone)) {
            add_zone(&topics, &door->zones[i].mine.zone);
        }
    }
    for (size_t i = 0; i < door->zone_count; i++) {
        door->subscribed[i] = door->zones[i].mine.zone;
    }
    door->subscribed_count = door->zone_count;
    if (topics.n) {
        door->is_subscribed = false;
        const int r = link_mqtt_subscribe(door->mqtt, topics.list, topics.n, &door->subscription);
        if (r < 0 && r != -ENOTCONN) {
            /* Without subscriptions the connection is worth nothing. */
            link_note(door, "the topics cannot be subscribed: %s", strerror(-r));
            link_mqtt_renew(door->mqtt);
        }
    }
}
