/* The fleet to which the door belongs: what it needs of the appliance, and what it asks for. */
#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>
#include <syslog.h>
#include <time.h>

#include "drivers/base/restart_hours.h"
#include "firmware/appliance/administration/administration.h"
#include "firmware/appliance/appliance_access.h"
#include "firmware/appliance/appliance_calls.h"
#include "firmware/appliance/appliance_claim.h"
#include "firmware/fleet/door/fleet.h"

_Static_assert((int)ISO__APPLIANCE_WHY_SIZE >= (int)ISO_FLEET_WHY_SIZE, "the text fits");

struct iso_fleet *iso_appliance_fleet(const struct iso_appliance *appliance)
{
    return appliance->fleet.door;
}

/* ---- what the fleet asks for ---- */

static void get_keys(void *context, struct iso_fleet_signer *signer,
                     struct iso_fleet_receiver *receiver)
{
    const struct iso_appliance *appliance = context;
    struct iso_transfer_keys keys;
    iso_transfer_get_keys(appliance->borrowed.ring, &keys);
    memcpy(signer->public, keys.signs, sizeof signer->public);
    memcpy(signer->secret, keys.sign_secret, sizeof signer->secret);
    memcpy(receiver->public, keys.receives, sizeof receiver->public);
    memcpy(receiver->secret, keys.receive_secret, sizeof receiver->secret);
    sodium_memzero(&keys, sizeof keys);
}

static void get_clocks(void *context, struct iso_fleet_clocks *now)
{
    const struct iso_appliance *appliance = context;
    now->boot_ns = iso_times_boot_ns(&appliance->borrowed.times);
    memcpy(now->boot_id, appliance->borrowed.boot_id, sizeof now->boot_id);
    now->date_known = iso__appliance_knows_date(appliance);
    now->date_s = iso__appliance_date_s(appliance);
}

static int record(void *context, const struct iso_audit_record *record, bool wait,
                  struct iso_fault *fault)
{
    struct iso_appliance *appliance = context;
    return wait ? iso__appliance_record_first(appliance, record, fault)
                : iso_audit_writer_post(appliance->log, record, fault);
}

static uint64_t last_event(void *context)
{
    const struct iso_appliance *appliance = context;
    return iso_audit_writer_last(appliance->log);
}

static int read_log(void *context, uint64_t from, uint32_t most,
                    int (*each)(void *context, const char *line), void *each_context)
{
    const struct iso_appliance *appliance = context;
    struct iso_audit *log = iso_audit_writer_hold(appliance->log);
    const int result = iso_audit_read(log, from, most, each, each_context);
    iso_audit_writer_release(appliance->log);
    return result;
}

static int take_policy(void *context, const char *json, const char *who, struct iso_fault *fault)
{
    return iso__appliance_take_policy(context, json, who, fault);
}

static int take_lockdown(void *context, bool on, struct iso_fault *fault)
{
    return iso_appliance_lockdown(context, on, fault);
}

/* A card or a PIN of this person may not hold any more. */
static void changed(void *context, int64_t person, const char *name, int64_t now)
{
    struct iso_appliance *appliance = context;
    const struct iso_factor_wait *wait = &appliance->access.wait;
    if (wait->person == person || wait->companion == person) {
        iso__appliance_end_wait(appliance);
    }
    if (now != person) {
        iso_site_access_forget(appliance->access.site, person);
        iso__appliance_forget_person(appliance, name);
    }
}

static void write_health(void *context, struct iso_json_line *line)
{
    const struct iso_appliance *appliance = context;
    const struct iso_appliance_status status = iso_appliance_status(appliance);
    const struct iso_door_look door = iso_door_guard_look(appliance->door);
    iso_json_line_string(line, "version", ISOTHERM_VERSION);
    iso_json_line_string(line, "door-state", iso_door_state_name(door.state));
    iso_json_line_integer(line, "tamper", door.tamper);
    iso_json_line_string(line, "sensor-state", status.sensor_state);
    iso_json_line_string(line, "sensor-fault", status.sensor_fault);
    iso_json_line_string(line, "door-fault", status.door_fault);
    iso_json_line_string(line, "storage-fault", status.storage_fault);
    iso_json_line_string(line, "clock-fault", status.clock_fault);
    iso_json_line_string(line, "policy-fault", iso_site_access_fault(appliance->access.site)->text);
    iso_json_line_integer(line, "lockdown", status.lockdown);
    iso_json_line_integer(line, "uptime-s", status.uptime_ns / ISO_NS_PER_S);
}

/* Somebody is at the door, passes through it, or has the camera. */
static bool is_busy(void *context)
{
    const struct iso_appliance *appliance = context;
    const struct iso_door_look door = iso_door_guard_look(appliance->door);
    return appliance->mode != ISO_APPLIANCE_WATCH || door.state == ISO_DOOR_UNLOCKED ||
           door.state == ISO_DOOR_OPENED || appliance->visit.decision.state != ISO_DECISION_IDLE;
}

/* A clock that cannot be read allows nothing. */
static bool may_restart(void *context)
{
    const struct iso_appliance *appliance = context;
    const char *text = appliance->borrowed.config->fleet.restart_hours;
    const time_t now = (time_t)(iso_times_wall_ns(&appliance->borrowed.times) / ISO_NS_PER_S);
    struct iso_restart_hours hours;
    struct tm local;
    return !*text || (iso_restart_hours_read(text, &hours) == 0 && localtime_r(&now, &local) &&
                      iso_restart_hours_have(&hours, local.tm_hour));
}

static void say(void *context, int priority, const char *line)
{
    iso__appliance_say(context, priority, "%s", line);
}

/* ---- the decision ---- */

/* Until it is known whether the door belongs to a fleet, nobody is admitted. */
static enum iso_access_reason admission(void *context, const struct iso_credential_record *record)
{
    const struct iso_appliance *appliance = context;
    if (!appliance->fleet.door) {
        return ISO_ACCESS_NO_LEASE;
    }
    switch (iso_fleet_admission(appliance->fleet.door, record)) {
    case ISO_FLEET_MAY_ENTER:
        return ISO_ACCESS_OTHER;
    case ISO_FLEET_NOT_APPROVED:
        return ISO_ACCESS_NOT_APPROVED;
    default:
        return ISO_ACCESS_NO_LEASE;
    }
}

void iso__appliance_why_no_lease(const struct iso_appliance *appliance,
                                 char text[ISO__APPLIANCE_WHY_SIZE])
{
    if (appliance->fleet.door) {
        (void)iso_fleet_why(appliance->fleet.door, text);
    } else {
        (void)snprintf(text, ISO__APPLIANCE_WHY_SIZE, "the fleet of the door is not known yet");
    }
}

int iso__appliance_fleet_admits(const struct iso_appliance *appliance, int64_t person,
                                struct iso_fault *fault)
{
    const struct iso_gallery *gallery = appliance->borrowed.gallery;
    const struct iso_person *known = iso_gallery_find_id(gallery, person);
    const char *name = known ? known->name : "";
    char why[ISO__APPLIANCE_WHY_SIZE];
    switch (iso_site_access_admission(appliance->access.site, gallery, person)) {
    case ISO_ACCESS_NO_LEASE:
        iso__appliance_why_no_lease(appliance, why);
        return iso_fault_set(fault, -EPERM, "%.100s: %s", name, why);
    case ISO_ACCESS_NOT_APPROVED:
        return iso_fault_set(fault, -EPERM, "%.100s: not approved by the hub yet", name);
    default:
        return 0;
    }
}

int iso__appliance_may_change(const struct iso_appliance *appliance,
                              const struct iso_person *person, struct iso_fault *fault)
{
    if (!person) {
        return 0;
    }
    struct iso_credential_record record = iso_site_access_credential(appliance->borrowed.gallery,
                                                                     person->id);
    const bool of_fleet = iso_credential_is_of_fleet(&record);
    iso_credential_record_wipe(&record);
    const struct iso_fleet *fleet = appliance->fleet.door;
    if (!of_fleet || (fleet && !iso_fleet_is_member(fleet))) {
        return 0;
    }
    return iso_fault_set(fault, -EINVAL, "%s is managed by the hub %.64s", person->name,
                         fleet ? iso_fleet_hub_name(fleet) : "");
}

int iso__appliance_may_replace(const struct iso_appliance *appliance,
                               const struct iso_gallery_item *items, size_t n, bool replace,
                               struct iso_fault *fault)
{
    int error = 0;
    for (size_t i = 0; replace && !error && i < n; i++) {
        const struct iso_person *known = iso_gallery_find(appliance->borrowed.gallery,
                                                          items[i].person.name);
        error = iso__appliance_may_change(appliance, known, fault);
    }
    return error;
}

/* ---- starting, and time ---- */

static int open_fleet(struct iso_appliance *appliance)
{
    const struct iso_fleet_options options = {
        .store = iso_fleet_gallery_store(appliance->borrowed.gallery),
        .host = {.context = appliance,
                 .keys = get_keys,
                 .clocks = get_clocks,
                 .record = record,
                 .last_event = last_event,
                 .read_log = read_log,
                 .policy = take_policy,
                 .lockdown = take_lockdown,
                 .changed = changed,
                 .health = write_health,
                 .busy = is_busy,
                 .may_restart = may_restart,
                 .say = say},
        .algorithm = iso_appliance_status(appliance).algorithm,
    };
    return iso_fleet_open(&options, &appliance->fleet.door, NULL);
}

void iso__appliance_start_fleet(struct iso_appliance *appliance)
{
    iso_site_access_set_admission(appliance->access.site, admission, appliance);
    appliance->fleet.due_ns = 0;
    iso_fleet_close(appliance->fleet.door); /* of an earlier start */
    appliance->fleet.door = NULL;
    if (open_fleet(appliance)) {
        iso__appliance_say(appliance, LOG_ERR,
                           "fleet: it cannot be read whether the door belongs to one: nobody is "
                           "let in");
    }
}

void iso__appliance_free_fleet(struct iso_appliance *appliance)
{
    iso_fleet_close(appliance->fleet.door);
}

static void tell_work(const struct iso_appliance *appliance, unsigned work)
{
    static const char *const words[] = {ISO_CONTRACT_FLEET_WORK_EVENTS,
                                        ISO_CONTRACT_FLEET_WORK_REQUESTS,
                                        ISO_CONTRACT_FLEET_WORK_PLACES};
    const struct iso_appliance_events *events = &appliance->borrowed.events;
    for (unsigned i = 0; events->fleet_work && i < sizeof words / sizeof *words; i++) {
        if (work & (1u << i)) {
            events->fleet_work(events->context, words[i]);
        }
    }
}

void iso__appliance_fleet_time(struct iso_appliance *appliance, int64_t now_ns)
{
    int64_t wait_ns = ISO_NEVER_NS;
    if (!appliance->fleet.door && open_fleet(appliance)) {
        appliance->fleet.due_ns = now_ns + ISO_NS_PER_S;
        return;
    }
    tell_work(appliance, iso_fleet_time(appliance->fleet.door, &wait_ns));
    appliance->fleet.due_ns = wait_ns < ISO_NEVER_NS - now_ns ? now_ns + wait_ns : ISO_NEVER_NS;
}

int64_t iso__appliance_fleet_due_ns(const struct iso_appliance *appliance)
{
    return appliance->fleet.due_ns;
}
