/* WATCH: handles the verdict of a visit. */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <syslog.h>

#include "drivers/terminal/words.h"
#include "firmware/appliance/verdict/verdict.h"

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
    struct iso__verdict_note note;
    const struct iso_audit_record record = iso__verdict_record(appliance, "visit", visit->person,
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

/* Asks the door to unlock, once the grant is on record. Returns ISO_REASON_NONE, or why nobody is
 * let in after all. */
static enum iso_reason open_door(struct iso_appliance *appliance, struct iso_visit *visit)
{
    if (iso__appliance_grant_at_door(appliance, visit->verdict.since_ns, &visit->door)) {
        return ISO_REASON_STALE;
    }
    note_answer(appliance, visit);
    if (iso__verdict_has_controller(appliance)) {
        iso__verdict_send_card(appliance, visit);
    }
    return ISO_REASON_NONE;
}

/* Nobody is let in without a record on the disk, and what the door did is known only afterwards.
 * Therefore there are two records: "grant" is written before the lock is switched; "visit" is
 * written after that, repeats the grant and says what the door did. A crash in between leaves a
 * grant without a visit. If a grant gets to the disk too late, its "visit" is a denial. */
static void let_in(struct iso_appliance *appliance, struct iso_visit *visit)
{
    struct iso__verdict_note note;
    struct iso_fault fault = {.text = ""};
    struct iso_audit_record record = iso__verdict_record(appliance, "grant", visit->person,
                                                         &visit->verdict, &note);
    const int error = iso__appliance_record_grant(appliance, &record, &fault);
    const enum iso_reason refusal = error ? reason_of(error) : open_door(appliance, visit);
    if (refusal != ISO_REASON_NONE) {
        deny_verdict(&visit->verdict, refusal);
        iso__appliance_refuse_at_door(appliance);
        record = iso__verdict_record(appliance, "visit", visit->person, &visit->verdict, &note);
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
                   iso__verdict_word(verdict), *visit->person ? " " : "", visit->person,
                   stuck ? ", door not-unlocked" : "");
    (void)snprintf(appliance->outcome.person, sizeof appliance->outcome.person, "%s",
                   visit->person);
    iso__appliance_say(appliance, stuck ? LOG_WARNING : LOG_INFO,
                       "visit: %s (%s, %d %s, %lld ms)%s%s%s%s", iso__verdict_word(verdict),
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
