/* Sends the appliance's events as signals. */
#include <errno.h>
#include <math.h>
#include <stdio.h>

#include "firmware/bus/bus_state.h"
#include "firmware/contract/contract.h"

void iso__bus_send_signal(sd_bus_message *signal, const char *destination, int r)
{
    if (r >= 0 && destination) {
        r = sd_bus_message_set_destination(signal, destination);
    }
    if (r >= 0) {
        (void)sd_bus_send(NULL, signal, NULL);
    }
    sd_bus_message_unref(signal);
}

int iso__bus_new_signal(const struct iso_bus *bus, const char *member, sd_bus_message **out)
{
    return bus->object ? sd_bus_message_new_signal(bus->bus, out, ISO_CONTRACT_PATH,
                                                   ISO_CONTRACT_INTERFACE, member)
                       : -ENOTCONN;
}

static void on_enroll_status(void *context, const char *result, bool done, unsigned stage,
                             unsigned stages, double quality, const char *person)
{
    const struct iso_bus *bus = context;
    sd_bus_message *signal = NULL;
    char word[64];
    (void)snprintf(word, sizeof word, "enroll-%s", result);
    int r = iso__bus_new_signal(bus, ISO_CONTRACT_ENROLL_STATUS, &signal);
    if (r >= 0) {
        r = sd_bus_message_append(signal, "sbuuds", word, (int)done, stage, stages, quality,
                                  person);
    }
    iso__bus_send_signal(signal, bus->claimant, r);
}

static void on_enroll_step(void *context, const char *pose, const char *state, unsigned step,
                           unsigned steps, double turn_deg)
{
    const struct iso_bus *bus = context;
    sd_bus_message *signal = NULL;
    int r = iso__bus_new_signal(bus, ISO_CONTRACT_ENROLL_STEP, &signal);
    if (r >= 0) {
        r = sd_bus_message_append(signal, "ssuud", pose, state, step, steps, turn_deg);
    }
    iso__bus_send_signal(signal, bus->claimant, r);
}

static void on_recognition_status(void *context, enum iso_appliance_mode mode, const char *result,
                                  bool done, const char *person, double score, double threshold)
{
    const struct iso_bus *bus = context;
    sd_bus_message *signal = NULL;
    char word[64];
    const bool verify = mode == ISO_APPLIANCE_VERIFY;
    (void)snprintf(word, sizeof word, "%s-%s", verify ? "verify" : "identify", result);
    if (bus->login.on) { /* the client of a login learns the verdict alone */
        person = "";
        score = NAN;
        threshold = 0.0;
    }
    int r = iso__bus_new_signal(
        bus, verify ? ISO_CONTRACT_VERIFY_STATUS : ISO_CONTRACT_IDENTIFY_STATUS, &signal);
    if (r >= 0) {
        r = sd_bus_message_append(signal, "sbsdd", word, (int)done, person, score, threshold);
    }
    iso__bus_send_signal(signal, bus->claimant, r);
}

static void on_visit(void *context, const struct iso_visit *visit)
{
    const struct iso_bus *bus = context;
    sd_bus_message *signal = NULL;
    char door_fault[300];
    iso__bus_clean_text(door_fault, sizeof door_fault, visit->door_fault);
    int r = iso__bus_new_signal(bus, ISO_CONTRACT_VISIT, &signal);
    if (r >= 0) {
        r = sd_bus_message_append(signal, "ssdduxsss", visit->verdict.allow ? "allow" : "deny",
                                  visit->person, visit->verdict.score, visit->threshold,
                                  (uint32_t)visit->verdict.frames, visit->latency_ns / 1000,
                                  iso_reason_name(visit->verdict.reason),
                                  iso_door_answer_name(visit->door), door_fault);
    }
    iso__bus_send_signal(signal, NULL, r);
}

static void on_wanted(void *context, const char *what)
{
    sd_bus_message *signal = NULL;
    int r = iso__bus_new_signal(context, ISO_CONTRACT_WANTED, &signal);
    r = r < 0 ? r : sd_bus_message_append(signal, "s", what);
    iso__bus_send_signal(signal, NULL, r);
}

static void on_hint(void *context, enum iso_capture capture)
{
    const struct iso_bus *bus = context;
    sd_bus_message *signal = NULL;
    int r = iso__bus_new_signal(bus, ISO_CONTRACT_HINT, &signal);
    if (r >= 0) {
        r = sd_bus_message_append(signal, "s", iso_capture_name(capture));
    }
    iso__bus_send_signal(signal, NULL, r);
}

static void on_door_changed(void *context, const char *state, const char *cause)
{
    const struct iso_bus *bus = context;
    sd_bus_message *signal = NULL;
    int r = iso__bus_new_signal(bus, ISO_CONTRACT_DOOR_CHANGED, &signal);
    if (r >= 0) {
        r = sd_bus_message_append(signal, "ss", state, cause);
    }
    iso__bus_send_signal(signal, NULL, r);
}

static void on_claim_lost(void *context)
{
    iso__bus_forget_claimant(context);
}

struct iso_appliance_events iso_bus_events(struct iso_bus *bus,
                                           void (*message)(void *context, int priority,
                                                           const char *text))
{
    return (struct iso_appliance_events){
        .enroll_status = on_enroll_status,
        .enroll_step = on_enroll_step,
        .recognition_status = on_recognition_status,
        .visit = on_visit,
        .wanted = on_wanted,
        .hint = on_hint,
        .view = iso__bus_on_view,
        .seen = iso__bus_on_seen,
        .picture = iso__bus_on_picture,
        .door_changed = on_door_changed,
        .claim_lost = on_claim_lost,
        .fleet_work = iso__bus_on_fleet_work,
        .message = message,
        .context = bus,
    };
}
