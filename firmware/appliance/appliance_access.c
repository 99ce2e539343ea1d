/* WATCH: asks the policy of the site whether a person who was recognised, or who showed a card, may
 * enter; and waits for what the policy wants besides. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <syslog.h>

#include "firmware/appliance/appliance_access.h"
#include "firmware/appliance/appliance_calls.h"
#include "firmware/contract/validity.h"

int iso__appliance_new_access(struct iso_appliance *appliance)
{
    static const struct iso_zone_source none; /* read NULL: policies with schedules are refused */
    const struct iso_appliance_borrowed *borrowed = &appliance->borrowed;
    const struct iso_site_access_options options = {
        .access_point = borrowed->config->policy.access_point,
        .zones = borrowed->zones ? borrowed->zones : &none,
    };
    return iso_site_access_new(&options, &appliance->access.site);
}

void iso__appliance_free_access(struct iso_appliance *appliance)
{
    iso_site_access_free(appliance->access.site);
}

int iso__appliance_load_policy(struct iso_appliance *appliance)
{
    struct iso_site_access *site = appliance->access.site;
    const int error = iso_site_access_load(site, appliance->borrowed.gallery);
    const struct iso_fault *fault = iso_site_access_fault(site);
    iso__appliance_end_wait(appliance);
    if (error) {
        iso__appliance_say(appliance, LOG_ERR, "policy: out of memory");
    } else if (*fault->text) {
        iso__appliance_say(appliance, LOG_ERR, "policy: nobody is let in: %s", fault->text);
    }
    return error;
}

int64_t iso__appliance_only_person(const struct iso_appliance *appliance)
{
    const struct iso_factor_wait *wait = &appliance->access.wait;
    const bool verifies = appliance->mode == ISO_APPLIANCE_WATCH && wait->by_card &&
                          !wait->companion_wanted && !(wait->shown.matched & ISO_RECOGNITION_FACE);
    return verifies ? wait->person : 0;
}

const char *iso__appliance_wanted(const struct iso_appliance *appliance)
{
    const struct iso_factor_wait *wait = &appliance->access.wait;
    if (!iso_factor_wait_is_active(wait)) {
        return "";
    }
    if (wait->companion_wanted && !wait->companion) {
        return ISO_CONTRACT_WANTED_PERSON;
    }
    if (wait->wanted & ISO_RECOGNITION_CARD) {
        return ISO_CONTRACT_WANTED_CARD;
    }
    return wait->wanted & ISO_RECOGNITION_PIN ? ISO_CONTRACT_WANTED_PIN : ISO_CONTRACT_WANTED_FACE;
}

/* ---- the question ---- */

bool iso__appliance_knows_date(const struct iso_appliance *appliance)
{
    return iso_wall_is_set(iso__appliance_date_s(appliance)) &&
           !iso__appliance_clock_is_behind(appliance);
}

static struct iso_access ask(const struct iso_appliance *appliance,
                             const struct iso_factor_wait *wait)
{
    const struct iso_site_request request = {
        .person = wait->person,
        .shown = wait->shown,
        .companion = wait->companion,
        .companion_shown = wait->companion_shown,
        .time_s = iso__appliance_date_s(appliance),
        .time_known = iso__appliance_knows_date(appliance),
    };
    return iso_site_access_decide(appliance->access.site, appliance->borrowed.gallery, &request);
}

static enum iso_reason reason_of(enum iso_access_reason reason)
{
    switch (reason) {
    case ISO_ACCESS_NOT_FOUND:
        return ISO_REASON_UNKNOWN;
    case ISO_ACCESS_NOT_ENABLED:
        return ISO_REASON_DISABLED;
    case ISO_ACCESS_NOT_ACTIVE:
    case ISO_ACCESS_EXPIRED:
        return ISO_REASON_NOT_VALID;
    case ISO_ACCESS_UNAUTHORIZED:
        return ISO_REASON_NOT_HERE;
    case ISO_ACCESS_NOT_AT_THIS_TIME:
        return ISO_REASON_NOT_NOW;
    case ISO_ACCESS_INVALID_IDENTIFIER:
    case ISO_ACCESS_INVALID_PIN:
        return ISO_REASON_WRONG_FACTOR;
    case ISO_ACCESS_ANTIPASSBACK:
        return ISO_REASON_ANTIPASSBACK;
    case ISO_ACCESS_NO_PAIR:
        return ISO_REASON_NO_PAIR;
    case ISO_ACCESS_NO_LEASE:
        return ISO_REASON_NO_LEASE;
    case ISO_ACCESS_NOT_APPROVED:
        return ISO_REASON_NOT_APPROVED;
    default:
        return ISO_REASON_NO_POLICY;
    }
}

static void tell_wanted(struct iso_appliance *appliance)
{
    const struct iso_appliance_events *events = &appliance->borrowed.events;
    events->wanted(events->context, iso__appliance_wanted(appliance));
}

/* Nothing at the door shows that a duress PIN was entered: only the log tells those who read it. It
 * is told at once, and once for a wait, because nobody knows how the wait ends. */
static void record_duress(struct iso_appliance *appliance, const struct iso_factor_wait *wait)
{
    struct iso_audit_record record = iso_audit_record_of("duress");
    const bool first = wait->shown.pin != 0;
    const struct iso_person *person = iso_gallery_find_id(
        appliance->borrowed.gallery, wait->companion_shown.pin ? wait->companion : wait->person);
    if (appliance->access.duress || (!first && !wait->companion_shown.pin)) {
        return;
    }
    appliance->access.duress = true;
    record.person = person ? person->name : NULL;
    (void)iso__appliance_note(appliance, &record);
}

/* Makes the verdict of an answer. Returns false if the door waits for more. `before` is what was
 * waited for until now. */
static bool conclude(struct iso_appliance *appliance, const struct iso_factor_wait *before,
                     const struct iso_access *answer, struct iso_verdict *verdict)
{
    if (answer->outcome == ISO_ACCESS_WANT) {
        tell_wanted(appliance);
        return false;
    }
    verdict->person = before->person;
    verdict->companion = before->companion;
    verdict->passback = answer->passback || answer->companion_passback;
    if (answer->outcome == ISO_ACCESS_ALLOW) {
        verdict->allow = true;
        verdict->reason = before->shown.matched & ISO_RECOGNITION_FACE ? ISO_REASON_MATCH
                                                                       : ISO_REASON_CREDENTIAL;
    } else {
        verdict->allow = false;
        verdict->reason = reason_of(answer->reason);
    }
    return true;
}

/* While the sensor does not work, a card may replace the face; the PIN of a person who has one is
 * then needed, too. The policy is asked again as if the face had been shown, so that all its other
 * rules hold. */
static void replace_face(const struct iso_appliance *appliance, struct iso_access *answer)
{
    const struct iso_factor_wait *wait = &appliance->access.wait;
    if (!appliance->borrowed.config->policy.card_alone || answer->outcome != ISO_ACCESS_WANT ||
        answer->wanted != ISO_RECOGNITION_FACE || answer->companion_wanted ||
        answer->of_companion || !(wait->shown.matched & ISO_RECOGNITION_CARD) ||
        strcmp(iso__appliance_sensor_state(appliance), "lost") != 0) {
        return;
    }
    struct iso_credential_record record = iso_site_access_credential(appliance->borrowed.gallery,
                                                                     wait->person);
    const bool lacks_pin = record.pin && !wait->shown.pin;
    iso_credential_record_wipe(&record);
    if (lacks_pin) {
        answer->wanted = ISO_RECOGNITION_PIN;
        return;
    }
    struct iso_factor_wait as_if = *wait;
    as_if.shown.matched |= ISO_RECOGNITION_FACE;
    *answer = ask(appliance, &as_if);
    explicit_bzero(&as_if, sizeof as_if);
}

/* Asks with all that was shown so far. */
static bool settle(struct iso_appliance *appliance, struct iso_verdict *verdict)
{
    struct iso_factor_wait *wait = &appliance->access.wait;
    struct iso_factor_wait before = *wait;
    struct iso_access answer = ask(appliance, wait);
    replace_face(appliance, &answer);
    iso_factor_wait_answer(wait, &answer, iso_times_now_ns(&appliance->borrowed.times),
                           appliance->borrowed.config->policy.factor_ms * ISO_NS_PER_MS);
    if (answer.duress) {
        record_duress(appliance, &before);
    }
    if (!iso_factor_wait_is_active(wait)) {
        appliance->access.duress = false;
    }
    const bool decided = conclude(appliance, &before, &answer, verdict);
    explicit_bzero(&before, sizeof before);
    return decided;
}

/* Whether the door is open to everybody now, so that a stranger may enter, too. */
static bool is_open(const struct iso_appliance *appliance)
{
    const struct iso_site_request stranger = {
        .time_s = iso__appliance_date_s(appliance),
        .time_known = iso__appliance_knows_date(appliance),
    };
    return iso_site_access_decide(appliance->access.site, appliance->borrowed.gallery, &stranger)
               .outcome == ISO_ACCESS_ALLOW;
}

/* A face that is refused is not the person who is waited for: that person has left. The refusal is
 * the record of both. */
static void end_with_refusal(struct iso_appliance *appliance, const struct iso_verdict *verdict)
{
    if (verdict->reason == ISO_REASON_UNKNOWN || verdict->reason == ISO_REASON_ATTACK ||
        verdict->reason == ISO_REASON_NOT_VALID) {
        iso_factor_wait_end(&appliance->access.wait);
        appliance->access.duress = false;
    }
}

bool iso__appliance_ask_policy(struct iso_appliance *appliance, struct iso_verdict *verdict)
{
    struct iso_factor_wait *wait = &appliance->access.wait;
    verdict->threshold = iso__appliance_threshold(appliance);
    iso__appliance_access_time(appliance, iso_times_now_ns(&appliance->borrowed.times));
    if (verdict->allow) {
        if (iso_factor_wait_begins_anew(wait, verdict->person)) {
            iso__appliance_end_wait(appliance);
        }
        iso_factor_wait_face(wait, verdict->person);
        if (wait->person == verdict->person) {
            appliance->access.verdict = *verdict;
        }
        return settle(appliance, verdict);
    }
    end_with_refusal(appliance, verdict);
    if (verdict->reason == ISO_REASON_UNKNOWN && is_open(appliance)) {
        verdict->allow = true;
        verdict->reason = ISO_REASON_OPEN;
        verdict->person = 0;
        verdict->since_ns = iso__appliance_now_ns(appliance);
    }
    return true;
}

/* ---- cards and keys ---- */

/* The verdict for somebody who completes with a card or a PIN what a face may have begun. The last
 * thing that was shown is the newest evidence, so the age of the verdict begins now. */
static struct iso_verdict verdict_of_factor(const struct iso_appliance *appliance)
{
    struct iso_verdict verdict = {.score = NAN};
    if (appliance->access.wait.shown.matched & ISO_RECOGNITION_FACE) {
        verdict = appliance->access.verdict;
    }
    verdict.allow = false;
    verdict.since_ns = iso__appliance_now_ns(appliance);
    return verdict;
}

/* Asks again after a card or a PIN. */
static void take_factor(struct iso_appliance *appliance)
{
    struct iso_verdict verdict = verdict_of_factor(appliance);
    if (iso_factor_wait_is_active(&appliance->access.wait) && settle(appliance, &verdict)) {
        iso__appliance_finish_factor(appliance, &verdict);
    }
}

/* Whether a card or a key counts now. */
static bool takes_factors(const struct iso_appliance *appliance)
{
    return appliance->mode == ISO_APPLIANCE_WATCH && !iso__appliance_is_shut(appliance) &&
           iso_site_access_has_policy(appliance->access.site);
}

/* A card that nobody has, while nobody is waited for. It does not count for the lock-out: a card of
 * another site proves nothing, and noise on the lines can look like one. */
static void refuse_strange_card(struct iso_appliance *appliance)
{
    struct iso_verdict verdict = {.score = NAN, .reason = ISO_REASON_UNKNOWN};
    if (is_open(appliance)) {
        verdict.allow = true;
        verdict.reason = ISO_REASON_OPEN;
        verdict.since_ns = iso__appliance_now_ns(appliance);
    }
    iso__appliance_finish_strange(appliance, &verdict);
}

void iso_appliance_card(struct iso_appliance *appliance, const struct iso_card_number *card)
{
    struct iso_factor_wait *wait = &appliance->access.wait;
    const struct iso_person *holder = iso_site_access_holder(appliance->borrowed.gallery, card);
    if (!takes_factors(appliance)) {
        return;
    }
    if (holder) {
        iso_factor_wait_card(wait, holder->id);
    } else if (iso_factor_wait_is_active(wait)) {
        iso_factor_wait_strange_card(wait);
    } else {
        refuse_strange_card(appliance);
    }
    take_factor(appliance);
}

void iso_appliance_key(struct iso_appliance *appliance, char key)
{
    if (takes_factors(appliance) && iso_factor_wait_key(&appliance->access.wait, key)) {
        take_factor(appliance);
    }
}

/* ---- time ---- */

void iso__appliance_end_wait(struct iso_appliance *appliance)
{
    struct iso_factor_wait *wait = &appliance->access.wait;
    if (!iso_factor_wait_is_active(wait)) {
        return;
    }
    struct iso_verdict verdict = verdict_of_factor(appliance);
    verdict.person = wait->person;
    verdict.companion = wait->companion;
    verdict.reason = ISO_REASON_NOT_ENOUGH;
    iso_factor_wait_end(wait); /* first, because a lock-out that begins now ends the wait, too */
    appliance->access.duress = false;
    iso__appliance_finish_factor(appliance, &verdict);
}

void iso__appliance_access_time(struct iso_appliance *appliance, int64_t now_ns)
{
    if (now_ns >= iso__appliance_access_due_ns(appliance)) {
        iso__appliance_end_wait(appliance);
    }
}

int64_t iso__appliance_access_due_ns(const struct iso_appliance *appliance)
{
    const struct iso_factor_wait *wait = &appliance->access.wait;
    return iso_factor_wait_is_active(wait) ? wait->until_ns : ISO_NEVER_NS;
}

void iso__appliance_entered(struct iso_appliance *appliance, const struct iso_verdict *verdict)
{
    struct iso_site_access *site = appliance->access.site;
    const int64_t now_s = iso__appliance_date_s(appliance);
    const int64_t people[] = {verdict->person, verdict->companion};
    for (size_t i = 0; i < sizeof people / sizeof *people; i++) {
        if (people[i] && iso_site_access_enter(site, people[i], now_s)) {
            iso__appliance_say(appliance, LOG_ERR, "policy: out of memory");
        }
    }
}
