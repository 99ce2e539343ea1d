#include "tests/firmware/fleet/door/door_rig.h"

#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/gallery_rig.h"
#include "tests/firmware/rigs/puppets.h"

/* ---- the host ---- */

static void keys(void *context, struct iso_fleet_signer *signer,
                 struct iso_fleet_receiver *receiver)
{
    const struct door_rig *rig = context;
    *signer = rig->door_signs;
    *receiver = rig->door_receives;
}

static void clocks(void *context, struct iso_fleet_clocks *now)
{
    *now = ((const struct door_rig *)context)->now;
}

static int record(void *context, const struct iso_audit_record *record, bool wait,
                  struct iso_fault *fault)
{
    struct door_rig *rig = context;
    (void)wait;
    if (rig->fails_notes) {
        return iso_fault_set(fault, -ENOSPC, "the log is full");
    }
    assert_true(rig->n_notes < DOOR_RIG_NOTES);
    (void)snprintf(rig->notes[rig->n_notes++], sizeof rig->notes[0], "%s %s %s -> %s (%s)",
                   record->reason, record->person ? record->person : "-",
                   record->before ? record->before : "-", record->after ? record->after : "-",
                   record->note ? record->note : "-");
    return 0;
}

static uint64_t last_event(void *context)
{
    return (uint64_t)((const struct door_rig *)context)->n_notes;
}

static int read_log(void *context, uint64_t from, uint32_t most,
                    int (*each)(void *context, const char *line), void *each_context)
{
    const struct door_rig *rig = context;
    int result = 0;
    for (uint64_t n = from; !result && n < from + most && n <= (uint64_t)rig->n_notes; n++) {
        char line[64];
        (void)snprintf(line, sizeof line, "{\"sequence\":%llu,\"event\":\"fleet\"}",
                       (unsigned long long)n);
        result = each(each_context, line);
    }
    return result;
}

static int set_policy(void *context, const char *json, const char *who, struct iso_fault *fault)
{
    struct door_rig *rig = context;
    (void)who;
    if (rig->policy_error) {
        return iso_fault_set(fault, rig->policy_error, "the policy has no access point \"front\"");
    }
    const int error = iso_gallery_set_access(rig->gallery, ISO_GALLERY_SITE, json, strlen(json),
                                             fault);
    (void)snprintf(rig->policy, sizeof rig->policy, "%s", json);
    rig->policies++;
    return error;
}

static int set_lockdown(void *context, bool on, struct iso_fault *fault)
{
    (void)fault;
    ((struct door_rig *)context)->lockdown = on;
    return 0;
}

/* The store of the gallery, whose n-th apply and all after it fail. */
static int apply(void *context, struct iso_gallery_change *changes, size_t n, const void *record,
                 size_t size, struct iso_fault *fault)
{
    struct door_rig *rig = context;
    rig->applies++;
    if (rig->fail_applies && rig->applies >= rig->fail_applies) {
        return iso_fault_set(fault, -EIO, "the disk has failed");
    }
    return rig->store.apply(rig->store.context, changes, n, record, size, fault);
}

static int state_of(void *context, struct iso_fault *fault)
{
    const struct door_rig *rig = context;
    return rig->store.state(rig->store.context, fault);
}

static struct iso_gallery_version version(void *context)
{
    const struct door_rig *rig = context;
    return rig->store.version(rig->store.context);
}

static const struct iso_person *people(void *context, size_t *n)
{
    const struct door_rig *rig = context;
    return rig->store.people(rig->store.context, n);
}

static const struct iso_person *find(void *context, const char *name)
{
    const struct door_rig *rig = context;
    return rig->store.find(rig->store.context, name);
}

static const struct iso_person *find_id(void *context, int64_t person)
{
    const struct door_rig *rig = context;
    return rig->store.find_id(rig->store.context, person);
}

static const void *access_of(void *context, int64_t id, size_t *size)
{
    const struct door_rig *rig = context;
    return rig->store.access(rig->store.context, id, size);
}

static int stage(void *context, const void *record, size_t size, struct iso_fault *fault)
{
    const struct door_rig *rig = context;
    return rig->store.stage(rig->store.context, record, size, fault);
}

static void unstage(void *context)
{
    const struct door_rig *rig = context;
    rig->store.unstage(rig->store.context);
}

static int templates(void *context, const struct iso_person *person,
                     int (*each)(void *context, const struct iso_gallery_item *item,
                                 struct iso_fault *fault),
                     void *each_context, struct iso_fault *fault)
{
    const struct door_rig *rig = context;
    return rig->store.templates(rig->store.context, person, each, each_context, fault);
}

static void open_door(struct door_rig *rig)
{
    rig->gallery = gallery_rig_open(rig->directory);
    rig->store = iso_fleet_gallery_store(rig->gallery);
    const struct iso_fleet_options options = {
        .store = {rig, state_of, version, people, find, find_id, access_of, apply, stage, unstage,
                  templates},
        .host = {.context = rig,
                 .keys = keys,
                 .clocks = clocks,
                 .record = record,
                 .last_event = last_event,
                 .read_log = read_log,
                 .policy = set_policy,
                 .lockdown = set_lockdown},
        .algorithm = PUPPET_ALGORITHM,
    };
    assert_int_equal(iso_fleet_open(&options, &rig->fleet, NULL), 0);
}

void door_rig_restart(struct door_rig *rig)
{
    iso_fleet_close(rig->fleet);
    iso_gallery_close(rig->gallery);
    rig->fail_applies = 0;
    open_door(rig);
}

struct iso_fleet_bytes door_rig_membership(const struct door_rig *rig)
{
    struct iso_fleet_bytes out = {.bytes = NULL};
    struct iso_fleet_membership membership = {
        .door = rig->door, .hub_name = "HQ", .door_name = "front"};
    memcpy(membership.hub_signs, rig->hub.public, sizeof membership.hub_signs);
    memcpy(membership.hub_receives, rig->hub_receives.public, sizeof membership.hub_receives);
    memcpy(membership.door_signs, rig->door_signs.public, sizeof membership.door_signs);
    assert_int_equal(iso_fleet_make_membership(&membership, &rig->hub, &out), 0);
    return out;
}

void door_rig_make_hub(struct door_rig *rig)
{
    assert_int_equal(iso_fleet_start(NULL), 0);
    (void)crypto_sign_keypair(rig->hub.public, rig->hub.secret);
    (void)crypto_box_keypair(rig->hub_receives.public, rig->hub_receives.secret);
    rig->door = iso_fleet_id_random();
    rig->lease_s = 3600;
    for (int i = 0; i < 3; i++) {
        rig->zone[i].place.zone = rig->zone[i].base.zone = iso_fleet_id_random();
        rig->zone[i].place.epoch = rig->zone[i].base.epoch = 1;
        randombytes_buf(&rig->zone[i].key, sizeof rig->zone[i].key);
    }
}

void door_rig_join(struct door_rig *rig)
{
    struct iso_fleet_bytes membership = door_rig_membership(rig);
    assert_int_equal(iso_fleet_join(rig->fleet, membership.bytes, membership.size, "user 0", NULL),
                     0);
    iso_fleet_bytes_free(&membership);
}

static int setup(struct door_rig *rig)
{
    void *directory = NULL;
    if (stores_setup(&directory)) {
        return -1;
    }
    rig->directory = directory;
    gallery_rig_capacity = 100;
    door_rig_make_hub(rig);
    (void)crypto_sign_keypair(rig->door_signs.public, rig->door_signs.secret);
    (void)crypto_box_keypair(rig->door_receives.public, rig->door_receives.secret);
    rig->now = (struct iso_fleet_clocks){
        .boot_ns = 1000000000, .boot_id = {1}, .date_s = 1800000000, .date_known = true};
    open_door(rig);
    door_rig_join(rig);
    return 0;
}

int door_rig_setup(void **state)
{
    struct door_rig *rig = calloc(1, sizeof *rig);
    *state = rig;
    return setup(rig);
}

int door_rig_teardown(void **state)
{
    struct door_rig *rig = *state;
    void *directory = (void *)(uintptr_t)rig->directory;
    iso_fleet_close(rig->fleet);
    iso_gallery_close(rig->gallery);
    free(rig);
    gallery_rig_capacity = 3;
    return stores_teardown(&directory);
}

/* ---- what the door has ---- */

int64_t door_rig_person(const struct door_rig *rig, const char *name)
{
    const struct iso_person *person = iso_gallery_find(rig->gallery, name);
    return person ? person->id : 0;
}

struct iso_credential_record door_rig_credential(const struct door_rig *rig, const char *name)
{
    size_t size = 0;
    struct iso_credential_record record = iso_credential_record_new();
    const void *bytes = iso_gallery_access(rig->gallery, door_rig_person(rig, name), &size);
    if (bytes) {
        assert_int_equal(iso_credential_record_get(bytes, size, &record), 0);
    }
    return record;
}

enum iso_fleet_admission door_rig_admission(const struct door_rig *rig, const char *name)
{
    const struct iso_credential_record record = door_rig_credential(rig, name);
    return iso_fleet_admission(rig->fleet, &record);
}

struct iso_fleet_status door_rig_status(struct door_rig *rig)
{
    struct iso_fleet_status out;
    assert_int_equal(iso_fleet_get_status(rig->fleet, &out, NULL), 0);
    return out;
}

bool door_rig_noted(const struct door_rig *rig, const char *text)
{
    for (int i = 0; i < rig->n_notes; i++) {
        if (strstr(rig->notes[i], text)) {
            return true;
        }
    }
    return false;
}
