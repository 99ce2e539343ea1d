/* WATCH: what becomes of a visit. */
#include <stdio.h>
#include <syslog.h>

#include "drivers/terminal/words.h"
#include "firmware/appliance_state.h"

struct iso_decision_options iso__appliance_decision_options(const struct iso_config *config)
{
    const struct iso_config_decision *decision = &config->decision;
    return (struct iso_decision_options){
        .threshold = iso_config_threshold(config),
        .margin = decision->margin,
        .agree = decision->agree,
        .max_frames = decision->max_frames,
        .attack_frames = decision->attack_frames,
        .gap_ns = decision->gap_ms * ISO_NS_PER_MS,
        .refractory_ns = decision->refractory_ms * ISO_NS_PER_MS,
    };
}

bool iso__appliance_is_valid(const struct iso_appliance *appliance, int64_t person_id)
{
    const struct iso_person *person = iso_gallery_find_id(appliance->parts.gallery, person_id);
    const int64_t now_s = iso_times_wall_ns(&appliance->parts.times) / ISO_NS_PER_S;
    if (!person) {
        return false;
    }
    if (person->valid_from_s == 0 && person->valid_until_s == 0) {
        return true;
    }
    return iso_wall_is_set(now_s) && now_s >= person->valid_from_s &&
           (person->valid_until_s == 0 || now_s <= person->valid_until_s);
}

static const char *verdict_word(const struct iso_verdict *verdict)
{
    return verdict->allow ? "allow" : "deny";
}

/* Puts the verdict on record; one that cannot be is DENY. */
static void record_verdict(struct iso_appliance *appliance, const char *person,
                           struct iso_verdict *verdict)
{
    struct iso_audit_record record = iso_audit_record_of("visit");
    record.person = *person ? person : NULL;
    record.verdict = verdict_word(verdict);
    record.reason = iso_reason_name(verdict->reason);
    record.score = verdict->score;
    record.threshold = iso_config_threshold(appliance->parts.config);
    record.frames = verdict->frames;
    record.sensor = iso__appliance_sensor_state(appliance);
    char image[ISO_IMAGE_TALLY_TEXT_SIZE];
    if (iso_image_tally_text(&appliance->image, image)) {
        record.note = image;
    }
    if (verdict->attack_frames > 0) {
        record.attack_frames = verdict->attack_frames;
        record.note = iso_capture_name(verdict->cue);
    }
    if (iso__appliance_record(appliance, &record)) {
        verdict->allow = false;
        verdict->reason = ISO_REASON_UNLOGGED;
    }
}

static void count(struct iso_appliance_counts *counts, const struct iso_verdict *verdict)
{
    counts->allowed += verdict->allow;
    counts->denied += !verdict->allow;
    counts->attacks += verdict->reason == ISO_REASON_ATTACK;
}

static void tell_door(struct iso_appliance *appliance, bool allow, int64_t now_ns)
{
    if (allow) {
        iso_door_control_grant(&appliance->door, now_ns);
    } else {
        iso_door_control_refuse(&appliance->door, now_ns);
    }
}

/* The controller has locks of its own; what it cannot be told does not change what this door does.
 */
static void send_card(struct iso_appliance *appliance, const char *person)
{
    const struct iso_wiegand_card *card = iso_cards_find(appliance->parts.cards, person);
    struct iso_fault fault = {""};
    if (appliance->door.door.state != ISO_DOOR_UNLOCKED) {
        return; /* a fault lasts: nobody is let in, here or there */
    }
    if (!card) {
        iso__appliance_say(appliance, LOG_WARNING, "who was let in has no card number");
    } else if (iso_door_io_send_card(appliance->parts.door_io, card, &fault)) {
        iso__appliance_say(appliance, LOG_ERR, "%s", fault.text);
    }
}

void iso__appliance_finish_visit(struct iso_appliance *appliance, struct iso_verdict verdict)
{
    const struct iso_person *person = iso_gallery_find_id(appliance->parts.gallery, verdict.person);
    const char *name = person ? person->name : "";
    const int64_t now_ns = iso_times_now_ns(&appliance->parts.times);
    record_verdict(appliance, name, &verdict);
    tell_door(appliance, verdict.allow, now_ns);
    count(&appliance->counts, &verdict);
    if (verdict.allow && appliance->parts.cards) {
        send_card(appliance, name);
    }

    const struct iso_visit visit = {
        .verdict = verdict,
        .person = name,
        .threshold = iso_config_threshold(appliance->parts.config),
        .latency_ns = now_ns - appliance->arrival_ns,
    };
    (void)snprintf(appliance->last_outcome, sizeof appliance->last_outcome, "%s%s%s",
                   verdict_word(&verdict), *name ? " " : "", name);
    iso__appliance_say(appliance, LOG_INFO, "visit: %s (%s, %d %s, %lld ms)",
                       verdict_word(&verdict), iso_reason_name(verdict.reason), verdict.frames,
                       iso_plural((uint64_t)verdict.frames, "frame", "frames"),
                       (long long)(visit.latency_ns / ISO_NS_PER_MS));
    appliance->parts.events.visit(appliance->parts.events.context, &visit);
    iso__appliance_learn(appliance, &verdict);
}
