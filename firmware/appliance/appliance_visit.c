/* WATCH: handles the verdict of a visit. */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <syslog.h>

#include "drivers/terminal/words.h"
#include "firmware/appliance/appliance_access.h"
#include "firmware/appliance/appliance_calls.h"

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
        .stale_ns = config->sensor.stale_ms * ISO_NS_PER_MS,
    };
}

double iso__appliance_threshold(const struct iso_appliance *appliance)
{
    size_t n_people = 1;
    if (appliance->mode != ISO_APPLIANCE_VERIFY && !iso__appliance_only_person(appliance)) {
        (void)iso_gallery_people(appliance->borrowed.gallery, &n_people);
    }
    return iso_config_threshold_among(
        appliance->borrowed.config, n_people,
        iso_site_is_provisional(iso_gallery_site(appliance->borrowed.gallery)));
}

static bool is_valid_at(const struct iso_appliance *appliance, const struct iso_person *person,
                        int64_t now_s)
{
    if (person->valid_from_s == 0 && person->valid_until_s == 0) {
        return true;
    }
    return iso_wall_is_set(now_s) && !iso__appliance_clock_is_behind(appliance) &&
           now_s >= person->valid_from_s &&
           (person->valid_until_s == 0 || now_s <= person->valid_until_s);
}

bool iso__appliance_is_valid(const struct iso_appliance *appliance, int64_t person_id)
{
    const struct iso_person *person = iso_gallery_find_id(appliance->borrowed.gallery, person_id);
    return person && is_valid_at(appliance, person, iso__appliance_date_s(appliance));
}

size_t iso__appliance_count_valid(const struct iso_appliance *appliance)
{
    const int64_t now_s = iso__appliance_date_s(appliance);
    size_t n = 0, valid = 0;
    const struct iso_person *people = iso_gallery_people(appliance->borrowed.gallery, &n);
    for (size_t i = 0; i < n; i++) {
        valid += is_valid_at(appliance, &people[i], now_s);
    }
    return valid;
}

static const char *verdict_word(const struct iso_verdict *verdict)
{
    return verdict->allow ? "allow" : "deny";
}

/* The note of a record: what the images showed, the companion, a soft violation of antipassback. */
struct visit_note {
    char text[ISO_IMAGE_TALLY_TEXT_SIZE + ISO_PERSON_NAME_SIZE + 48 + ISO__APPLIANCE_WHY_SIZE];
};

/* Adds a part to the note, with a comma before all parts but the first. */
static void add_note(struct visit_note *note, const char *before, const char *what)
{
    const size_t length = strlen(note->text);
    (void)snprintf(note->text + length, sizeof note->text - length, "%s%s%s", length ? ", " : "",
                   before, what);
}

static void write_note(const struct iso_appliance *appliance, const struct iso_verdict *verdict,
                       struct visit_note *note)
{
    const struct iso_person *companion = iso_gallery_find_id(appliance->borrowed.gallery,
                                                             verdict->companion);
    if (!iso_image_tally_text(&appliance->visit.image, note->text)) {
        note->text[0] = '\0';
    }
    if (companion) {
        add_note(note, "with ", companion->name);
    }
    if (verdict->reason == ISO_REASON_NO_LEASE) {
        char why[ISO__APPLIANCE_WHY_SIZE];
        iso__appliance_why_no_lease(appliance, why);
        add_note(note, why, "");
    }
    if (verdict->passback) {
        add_note(note, "soft violation of antipassback", "");
    }
}

/* Makes a record of a verdict. Its note may point into `note`. */
static struct iso_audit_record record_of(const struct iso_appliance *appliance, const char *event,
                                         const char *person, const struct iso_verdict *verdict,
                                         struct visit_note *note)
{
    struct iso_audit_record record = iso_audit_record_of(event);
    record.person = *person ? person : NULL;
    record.verdict = verdict_word(verdict);
    record.reason = iso_reason_name(verdict->reason);
    record.score = verdict->score;
    record.threshold = verdict->threshold;
    record.frames = verdict->frames;
    record.sensor = iso__appliance_sensor_state(appliance);
    write_note(appliance, verdict, note);
    if (*note->text) {
        record.note = note->text;
    }
    if (verdict->attack_frames > 0) {
        record.attack_frames = verdict->attack_frames;
        record.note = iso_capture_name(verdict->cue);
    }
    return record;
}

static void deny_verdict(struct iso_verdict *verdict, enum iso_reason reason)
{
    verdict->allow = false;
    verdict->reason = reason;
}

/* The reason of a refusal because the record was not written: the record was late, or the log
 * refused it. */
static enum iso_reason reason_of(int error)
{
    return error == -ETIMEDOUT || error == -ENOBUFS ? ISO_REASON_NOT_ON_RECORD
                                                    : ISO_REASON_UNLOGGED;
}

static void refuse_visit(struct iso_appliance *appliance, struct iso_visit *visit)
{
    struct visit_note note;
    const struct iso_audit_record record = record_of(appliance, "visit", visit->person,
                                                     &visit->verdict, &note);
    iso__appliance_refuse_at_door(appliance);
    const int error = iso__appliance_note(appliance, &record);
    if (error) {
        deny_verdict(&visit->verdict, reason_of(error));
    }
}

/* Notes why a door did not unlock: a fault of its lines, or a fault from outside. */
static void note_answer(struct iso_appliance *appliance, struct iso_visit *visit)
{
    appliance->outcome.door_look = iso_door_guard_look(appliance->door);
    const char *text = appliance->outcome.door_look.fault.text;
    visit->door_fault = "";
    if (visit->door == ISO_DOOR_DID_NOT_UNLOCK) {
        visit->door_fault = *text ? text : "the door is at fault";
    }
}

/* The card of the admitted person: the first Wiegand card of the credential, else that of the file
 * of cards, whatever spelling of the name the file has. If an old gallery has two people under two
 * spellings of one name, the spelling in the file decides whose card it is. */
static bool card_of(const struct iso_appliance *appliance, const struct iso_visit *visit,
                    struct iso_wiegand_card *out)
{
    const struct iso_gallery *gallery = appliance->borrowed.gallery;
    if (visit->verdict.person == 0) {
        return false; /* the door is open to everybody */
    }
    struct iso_credential_record record = iso_site_access_credential(gallery,
                                                                     visit->verdict.person);
    bool found = false;
    for (int i = 0; i < record.n_cards && !found; i++) {
        found = record.cards[i].bits == 0;
        *out = (struct iso_wiegand_card){(unsigned)(record.cards[i].code >> 32),
                                         (unsigned)(record.cards[i].code & UINT16_MAX)};
    }
    iso_credential_record_wipe(&record);
    if (found || !appliance->borrowed.cards) {
        return found;
    }
    const struct iso_card *card = iso_cards_find(appliance->borrowed.cards, visit->person);
    const struct iso_person *owner = card ? iso_gallery_find(gallery, card->person) : NULL;
    if (!owner || strcmp(owner->name, visit->person) != 0) {
        return false;
    }
    *out = card->number;
    return true;
}

/* Whether an access controller waits for card numbers. */
static bool has_controller(const struct iso_appliance *appliance)
{
    return appliance->borrowed.cards || appliance->borrowed.panel ||
           *iso_config_option(&appliance->borrowed.config->door.options, "wiegand_d0");
}

/* Sends the number to the access controller, over Wiegand, over OSDP, or both. Returns the first
 * error. */
static int send_number(struct iso_appliance *appliance, const struct iso_wiegand_card *number,
                       struct iso_fault *fault)
{
    const struct iso_config_options *lines = &appliance->borrowed.config->door.options;
    struct iso_panel *panel = appliance->borrowed.panel;
    int error = 0;
    if (!panel || *iso_config_option(lines, "wiegand_d0")) {
        error = iso_door_guard_send_card(appliance->door, number, fault);
    }
    const int other = panel ? iso_panel_send_card(panel, number, error ? NULL : fault) : 0;
    return error ? error : other;
}

/* Sends the card number. The controller has locks of its own, so a failure does not change what
 * the lock of this door does. A door without a lock of its own did not unlock then. */
static void send_card(struct iso_appliance *appliance, struct iso_visit *visit)
{
    struct iso_fault *fault = &appliance->outcome.card_fault;
    struct iso_wiegand_card number;
    const bool has_card = card_of(appliance, visit, &number);
    int error = -ENOENT;
    if (iso_door_guard_look(appliance->door).state != ISO_DOOR_UNLOCKED) {
        return; /* not at a fault; and a door that stands open gets no number */
    }
    if (has_card) {
        error = send_number(appliance, &number, fault);
    } else {
        (void)iso_fault_set(fault, error, "the admitted person has no card number");
    }
    if (!error) {
        return;
    }
    if (has_card) {
        (void)iso__appliance_say_fault(appliance, error, fault);
    } else {
        iso__appliance_warn(appliance, fault);
    }
    if (!iso_config_has_relay(appliance->borrowed.config)) {
        visit->door = ISO_DOOR_DID_NOT_UNLOCK;
        visit->door_fault = fault->text;
    }
}

/* Asks the door to unlock, once the grant is on record. Returns ISO_REASON_NONE, or why nobody is
 * let in after all. */
static enum iso_reason open_door(struct iso_appliance *appliance, struct iso_visit *visit)
{
    if (iso__appliance_grant_at_door(appliance, visit->verdict.since_ns, &visit->door)) {
        return ISO_REASON_STALE;
    }
    note_answer(appliance, visit);
    if (has_controller(appliance)) {
        send_card(appliance, visit);
    }
    return ISO_REASON_NONE;
}

/* Nobody is let in without a record on the disk, and what the door did is known only afterwards.
 * Therefore there are two records: "grant" is written before the lock is switched; "visit" is
 * written after that, repeats the grant and says what the door did. A crash in between leaves a
 * grant without a visit. If a grant gets to the disk too late, its "visit" is a denial. */
static void let_in(struct iso_appliance *appliance, struct iso_visit *visit)
{
    struct visit_note note;
    struct iso_fault fault = {.text = ""};
    struct iso_audit_record record = record_of(appliance, "grant", visit->person, &visit->verdict,
                                               &note);
    const int error = iso__appliance_record_grant(appliance, &record, &fault);
    const enum iso_reason refusal = error ? reason_of(error) : open_door(appliance, visit);
    if (refusal != ISO_REASON_NONE) {
        deny_verdict(&visit->verdict, refusal);
        iso__appliance_refuse_at_door(appliance);
        record = record_of(appliance, "visit", visit->person, &visit->verdict, &note);
    }
    if (refusal == ISO_REASON_UNLOGGED) {
        return; /* the log refuses records */
    }
    record.event = "visit";
    record.door = *iso_door_answer_name(visit->door) ? iso_door_answer_name(visit->door) : NULL;
    record.door_fault = *visit->door_fault ? visit->door_fault : NULL;
    (void)!iso_audit_writer_post_outcome(appliance->log, &record, NULL);
    iso__appliance_tell_door(appliance);
    if (refusal == ISO_REASON_NONE && visit->door != ISO_DOOR_DID_NOT_UNLOCK) {
        iso__appliance_entered(appliance, &visit->verdict);
    }
}

static void count_verdict(struct iso_appliance_counts *counts, const struct iso_verdict *verdict)
{
    counts->allowed += verdict->allow;
    counts->denied += !verdict->allow;
    counts->attacks += verdict->reason == ISO_REASON_ATTACK;
}

/* Cuts the text of the last visit before the name. */
void iso__appliance_forget_outcome(struct iso_appliance *appliance, const char *name)
{
    if (*name && strcmp(appliance->outcome.person, name) == 0) {
        const size_t verdict = strcspn(appliance->outcome.text, " ");
        explicit_bzero(appliance->outcome.text + verdict, sizeof appliance->outcome.text - verdict);
        explicit_bzero(appliance->outcome.person, sizeof appliance->outcome.person);
    }
}

void iso__appliance_count_attack_frame(struct iso_appliance *appliance)
{
    appliance->outcome.counts.attack_frames++;
}

static void tell_visit(struct iso_appliance *appliance, const struct iso_visit *visit)
{
    const struct iso_verdict *verdict = &visit->verdict;
    const bool stuck = visit->door == ISO_DOOR_DID_NOT_UNLOCK;
    const char *answer = iso_door_answer_name(visit->door);
    /* A short text would leave the end of a longer one, and the name in it, in memory. */
    explicit_bzero(appliance->outcome.text, sizeof appliance->outcome.text);
    explicit_bzero(appliance->outcome.person, sizeof appliance->outcome.person);
    (void)snprintf(appliance->outcome.text, sizeof appliance->outcome.text, "%s%s%s%s",
                   verdict_word(verdict), *visit->person ? " " : "", visit->person,
                   stuck ? ", door not-unlocked" : "");
    (void)snprintf(appliance->outcome.person, sizeof appliance->outcome.person, "%s",
                   visit->person);
    iso__appliance_say(appliance, stuck ? LOG_WARNING : LOG_INFO,
                       "visit: %s (%s, %d %s, %lld ms)%s%s%s%s", verdict_word(verdict),
                       iso_reason_name(verdict->reason), verdict->frames,
                       iso_plural((uint64_t)verdict->frames, "frame", "frames"),
                       (long long)(visit->latency_ns / ISO_NS_PER_MS), *answer ? ", door " : "",
                       answer, *visit->door_fault ? ": " : "", visit->door_fault);
    appliance->borrowed.events.visit(appliance->borrowed.events.context, visit);
}

/* Records, switches, reports. `arrival_ns` is when the visit began. */
static void finish(struct iso_appliance *appliance, const struct iso_verdict *verdict,
                   int64_t arrival_ns)
{
    const struct iso_person *person = iso_gallery_find_id(appliance->borrowed.gallery,
                                                          verdict->person);
    struct iso_visit visit = {
        .verdict = *verdict,
        .door_fault = "",
        .person = person ? person->name : "",
        .threshold = verdict->threshold,
        .latency_ns = iso_times_now_ns(&appliance->borrowed.times) - arrival_ns,
    };
    if (verdict->allow) {
        let_in(appliance, &visit);
    } else {
        refuse_visit(appliance, &visit);
    }
    iso__appliance_show_at_reader(appliance,
                                  visit.verdict.allow && visit.door != ISO_DOOR_DID_NOT_UNLOCK);
    count_verdict(&appliance->outcome.counts, &visit.verdict);
    appliance->outcome.verdict = visit.verdict;
    tell_visit(appliance, &visit);
}

bool iso__appliance_finish_visit(struct iso_appliance *appliance, struct iso_verdict *verdict)
{
    if (!iso__appliance_ask_policy(appliance, verdict)) {
        return false;
    }
    finish(appliance, verdict, appliance->visit.arrival_ns);
    if (appliance->outcome.verdict.reason == ISO_REASON_MATCH) {
        iso__appliance_learn(appliance, &appliance->outcome.verdict);
    }
    return true;
}

void iso__appliance_finish_strange(struct iso_appliance *appliance, struct iso_verdict *verdict)
{
    const bool has_face = verdict->frames > 0;
    if (!has_face) {
        verdict->threshold = iso__appliance_threshold(appliance);
    }
    iso__appliance_shut_out(appliance, verdict);
    finish(appliance, verdict,
           has_face ? appliance->visit.arrival_ns : iso_times_now_ns(&appliance->borrowed.times));
    /* The face that is still there has its verdict, and is not judged again at once. */
    iso_decision_spend(&appliance->visit.decision, iso__appliance_now_ns(appliance));
}

void iso__appliance_finish_factor(struct iso_appliance *appliance, struct iso_verdict *verdict)
{
    iso__appliance_finish_strange(appliance, verdict);
    iso__appliance_count_verdict(appliance, verdict);
}
