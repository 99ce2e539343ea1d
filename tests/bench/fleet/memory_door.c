#include "tests/bench/fleet/memory_door.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "firmware/fleet/door/fleet.h"
#include "firmware/fleet/door/fleet_direct.h"
#include "tests/bench/fleet/memory_store.h"

struct memory_door {
    struct fleet_table_door *row;
    struct memory_store store;
    struct iso_fleet *fleet;
    struct iso_link_daemon daemon; /* of the fleet; memory_door's own calls these functions */
    struct link_door *link;
    uint64_t last_event, visits;
    uint64_t connections; /* at row->online_ns */
};

static _Noreturn void end_with(const char *what, const struct iso_fault *fault)
{
    fprintf(stderr, "fleet_crowd: %s: %s\n", what, fault->text);
    exit(4);
}

/* ---- the appliance around the fleet's part ---- */

static void get_keys(void *context, struct iso_fleet_signer *signer,
                     struct iso_fleet_receiver *receiver)
{
    const struct memory_door *door = context;
    *signer = door->row->signs;
    *receiver = door->row->receives;
}

static void get_clocks(void *context, struct iso_fleet_clocks *now)
{
    struct timespec boot;
    (void)context;
    (void)clock_gettime(CLOCK_BOOTTIME, &boot);
    *now = (struct iso_fleet_clocks){.boot_ns = boot.tv_sec * INT64_C(1000000000) + boot.tv_nsec,
                                     .date_s = time(NULL),
                                     .date_known = true};
}

static int record(void *context, const struct iso_audit_record *record, bool wait,
                  struct iso_fault *fault)
{
    struct memory_door *door = context;
    (void)record, (void)wait, (void)fault;
    door->last_event++;
    return 0;
}

static uint64_t last_event(void *context)
{
    const struct memory_door *door = context;
    return door->last_event;
}

/* Records as long as those of a visit. */
static int read_log(void *context, uint64_t from, uint32_t most,
                    int (*each)(void *context, const char *line), void *each_context)
{
    const struct memory_door *door = context;
    int error = 0;
    for (uint64_t n = from; !error && n <= door->last_event && n < from + most; n++) {
        char line[512];
        (void)snprintf(
            line, sizeof line,
            "{\"sequence\":%llu,\"time\":\"2026-11-26T09:%02llu:%02llu.250Z\","
            "\"monotonic_ns\":%llu,\"event\":\"visit\",\"person\":\"person %llu\","
            "\"verdict\":\"allow\",\"score\":7.3125,\"threshold\":6.0,\"frames\":5,"
            "\"attack_frames\":0,\"sensor\":\"started\",\"door\":\"unlocked\",\"grant\":%llu,"
            "\"chain\":\"0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef\"}",
            (unsigned long long)n, (unsigned long long)(n / 60 % 60), (unsigned long long)(n % 60),
            (unsigned long long)n * 1000000, (unsigned long long)(n % 1000), (unsigned long long)n);
        error = each(each_context, line);
    }
    return error;
}

/* ---- what the link asks: the functions of the fleet, and the time of each change ---- */

static void note_place(struct memory_door *door, int64_t now_ns)
{
    struct iso_fleet_status status;
    struct fleet_table_door *row = door->row;
    if (iso_fleet_get_status(door->fleet, &status, NULL) || status.n == 0) {
        return;
    }
    const uint64_t before = atomic_load(&row->sequence), now = status.places[0].sequence;
    for (uint64_t n = before + 1; n <= now && n < FLEET_TABLE_CHANGES_MOST; n++) {
        atomic_store(&row->applied_ns[n], now_ns);
    }
    if (now > before) {
        atomic_store(&row->sequence, now);
    }
}

static int get_status(void *context, struct iso_link_status *out, struct iso_fault *fault)
{
    const struct memory_door *door = context;
    return door->daemon.status(door->daemon.context, out, fault);
}

static int question(void *context, struct iso_fleet_bytes *out, struct iso_fault *fault)
{
    const struct memory_door *door = context;
    return door->daemon.question(door->daemon.context, out, fault);
}

static int receive(void *context, const void *bytes, size_t size, struct iso_link_outcome *out,
                   struct iso_fault *fault)
{
    struct memory_door *door = context;
    const int error = door->daemon.receive(door->daemon.context, bytes, size, out, fault);
    if (error || out->outcome == ISO_FLEET_REFUSED) {
        atomic_fetch_add(&door->row->faults, 1);
    } else if (out->outcome == ISO_FLEET_APPLIED) {
        note_place(door, fleet_table_now_ns());
    }
    return error;
}

static int fetch(void *context, const struct iso_fleet_id *zone, enum iso_fleet_wanted what,
                 struct iso_fleet_bytes *out, struct iso_fault *fault)
{
    const struct memory_door *door = context;
    return door->daemon.fetch(door->daemon.context, zone, what, out, fault);
}

static int snapshot(void *context, int fd, struct iso_link_outcome *out, struct iso_fault *fault)
{
    struct memory_door *door = context;
    const int error = door->daemon.snapshot(door->daemon.context, fd, out, fault);
    if (error) {
        atomic_fetch_add(&door->row->faults, 1);
    } else {
        note_place(door, fleet_table_now_ns());
    }
    return error;
}

static int get_events(void *context, uint64_t after, uint32_t most, struct iso_fleet_bytes *out,
                      uint64_t *last, struct iso_fault *fault)
{
    const struct memory_door *door = context;
    return door->daemon.events(door->daemon.context, after, most, out, last, fault);
}

static int get_requests(void *context, void (*each)(void *context, const void *bytes, size_t size),
                        void *each_context, struct iso_fault *fault)
{
    const struct memory_door *door = context;
    return door->daemon.requests(door->daemon.context, each, each_context, fault);
}

static struct iso_link_daemon daemon_of(struct memory_door *door)
{
    return (struct iso_link_daemon){
        .context = door,
        .status = get_status,
        .question = question,
        .receive = receive,
        .fetch = fetch,
        .snapshot = snapshot,
        .events = get_events,
        .requests = get_requests,
    };
}

/* ---- the door ---- */

static void note(void *context, const char *line)
{
    (void)context;
    if (getenv("FLEET_BENCH_LOUD")) {
        fprintf(stderr, "link: %s\n", line);
    }
}

struct memory_door *memory_door_new(const struct memory_door_setup *setup)
{
    struct iso_fault fault = {.text = ""};
    struct memory_door *door = calloc(1, sizeof *door);
    if (!door) {
        (void)snprintf(fault.text, sizeof fault.text, "out of memory");
        end_with("a door", &fault);
    }
    door->row = setup->row;
    const struct iso_fleet_options options = {
        .store = memory_store_table(&door->store),
        .host = {.context = door,
                 .keys = get_keys,
                 .clocks = get_clocks,
                 .record = record,
                 .last_event = last_event,
                 .read_log = read_log},
        .algorithm = 1,
    };
    if (iso_fleet_open(&options, &door->fleet, &fault) ||
        iso_fleet_join(door->fleet, setup->row->membership, setup->row->membership_size, "bench",
                       &fault)) {
        end_with("the fleet", &fault);
    }
    door->daemon = iso_fleet_direct(door->fleet);
    const struct link_setup link = {.event = setup->event,
                                    .daemon = daemon_of(door),
                                    .http = setup->http,
                                    .broker = setup->broker,
                                    .hub_url = setup->hub_url,
                                    .note = note};
    if (link_door_new(&link, &door->link, &fault)) {
        end_with("the link", &fault);
    }
    return door;
}

void memory_door_free(struct memory_door *door)
{
    link_door_free(door->link);
    iso_fleet_close(door->fleet);
    memory_store_done(&door->store);
    free(door);
}

/* The words of enum iso_fleet_work, as the daemon tells them over the bus. */
static void tell(struct memory_door *door, unsigned work)
{
    if (work & ISO_FLEET_WORK_EVENTS) {
        link_door_work(door->link, ISO_CONTRACT_FLEET_WORK_EVENTS);
    }
    if (work & ISO_FLEET_WORK_REQUESTS) {
        link_door_work(door->link, ISO_CONTRACT_FLEET_WORK_REQUESTS);
    }
    if (work & ISO_FLEET_WORK_PLACES) {
        link_door_work(door->link, ISO_CONTRACT_FLEET_WORK_PLACES);
    }
}

void memory_door_step(struct memory_door *door, uint64_t visits)
{
    struct fleet_table_door *row = door->row;
    int64_t due_ns = 0;
    if (door->visits < visits) {
        door->last_event += visits - door->visits;
        door->visits = visits;
    }
    tell(door, iso_fleet_time(door->fleet, &due_ns));
    const struct link_report report = link_door_report(door->link);
    /* Between two steps a connection may have been lost and made again. */
    if (report.phase != LINK_ONLINE) {
        atomic_store(&row->online_ns, 0);
    } else if (atomic_load(&row->online_ns) == 0 || door->connections != report.connections) {
        atomic_store(&row->online_ns, fleet_table_now_ns());
        door->connections = report.connections;
    }
    atomic_store(&row->phase, report.phase);
    atomic_store(&row->connections, report.connections);
    atomic_store(&row->questions, report.questions);
    atomic_store(&row->fetches, report.fetches);
    atomic_store(&row->failed_fetches, report.failed_fetches);
    atomic_store(&row->last_event, door->last_event);
    atomic_store(&row->events_acked, report.events_acked);
}
