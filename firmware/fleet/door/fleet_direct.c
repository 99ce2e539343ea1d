#include "firmware/fleet/door/fleet_direct.h"

#include <string.h>

static int get_status(void *context, struct iso_link_status *out, struct iso_fault *fault)
{
    struct iso_fleet_status status;
    const int error = iso_fleet_get_status(context, &status, fault);
    if (error) {
        return error;
    }
    *out = (struct iso_link_status){
        .door = status.member->door,
        .last_event = status.last_event,
        .acked = status.acked,
        .lease_s = status.lease_s,
        .n = status.n,
    };
    memcpy(out->hub_signs, status.member->hub_signs, sizeof out->hub_signs);
    memcpy(out->places, status.places, sizeof out->places);
    memcpy(out->wants_snapshot, status.wants_snapshot, sizeof out->wants_snapshot);
    return 0;
}

static int question(void *context, struct iso_fleet_bytes *out, struct iso_fault *fault)
{
    return iso_fleet_question(context, out, fault);
}

static int receive(void *context, const void *bytes, size_t size, struct iso_link_outcome *out,
                   struct iso_fault *fault)
{
    return iso_fleet_receive(context, bytes, size, &out->outcome, &out->zone, fault);
}

static int fetch(void *context, const struct iso_fleet_id *zone, enum iso_fleet_wanted what,
                 struct iso_fleet_bytes *out, struct iso_fault *fault)
{
    return iso_fleet_fetch(context, zone, what, out, fault);
}

static int snapshot(void *context, int fd, struct iso_link_outcome *out, struct iso_fault *fault)
{
    return iso_fleet_snapshot_file(context, fd, &out->outcome, &out->zone, fault);
}

static int get_events(void *context, uint64_t after, uint32_t most, struct iso_fleet_bytes *out,
                      uint64_t *last, struct iso_fault *fault)
{
    return iso_fleet_events(context, after, most, out, last, fault);
}

static int get_requests(void *context, void (*each)(void *context, const void *bytes, size_t size),
                        void *each_context, struct iso_fault *fault)
{
    return iso_fleet_requests(context, each, each_context, fault);
}

static int update(void *context, const struct iso_fleet_update_report *report, bool *busy,
                  struct iso_fault *fault)
{
    return iso_fleet_set_update(context, report, busy, fault);
}

static int fetch_update(void *context, const struct iso_fleet_id *rollout, uint64_t after,
                        struct iso_fleet_bytes *out, struct iso_fault *fault)
{
    return iso_fleet_fetch_update(context, rollout, after, out, fault);
}

struct iso_link_daemon iso_fleet_direct(struct iso_fleet *fleet)
{
    return (struct iso_link_daemon){
        .context = fleet,
        .status = get_status,
        .question = question,
        .receive = receive,
        .fetch = fetch,
        .snapshot = snapshot,
        .events = get_events,
        .requests = get_requests,
        .update = update,
        .fetch_update = fetch_update,
    };
}
