/* Who is refused whatever the face: the lock-out, and the lockdown. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <syslog.h>

#include "firmware/appliance_state.h"
#include "firmware/lockout_file.h"

static int64_t now_ns(const struct iso_appliance *appliance)
{
    return iso_times_now_ns(&appliance->parts.times);
}

static const int64_t save_again_ns = ISO_NS_PER_S;

/* What cannot be kept is still true until the next restart, and tried again until it can. */
static void save(struct iso_appliance *appliance)
{
    const int64_t t_ns = now_ns(appliance);
    const struct iso_lockout_record record = iso_lockout_record_of(&appliance->lockout, t_ns);
    const bool said = appliance->lockout_save_ns != ISO_NEVER_NS;
    struct iso_fault fault = {""};
    appliance->lockout_save_ns = ISO_NEVER_NS;
    if (*appliance->parts.lockout_path &&
        iso_lockout_save(appliance->parts.lockout_path, &record, &fault)) {
        appliance->lockout_save_ns = t_ns + save_again_ns;
        if (!said) {
            iso__appliance_say(appliance, LOG_ERR, "%s", fault.text);
        }
    }
}

/* What was remembered cannot be read: it may have been the worst. */
static void suspect(struct iso_appliance *appliance, const struct iso_fault *fault)
{
    struct iso_audit_record record = iso_audit_record_of("lockdown");
    record.reason = "damaged";
    record.note = fault->text;
    appliance->lockout.lockdown = true;
    iso__appliance_say(appliance, LOG_ERR, "%s: nobody is let in until `isotherm lockdown off`",
                       fault->text);
    (void)iso__appliance_record(appliance, &record);
}

void iso__appliance_start_lockout(struct iso_appliance *appliance)
{
    const struct iso_config_lockout *config = &appliance->parts.config->lockout;
    const struct iso_lockout_options options = {
        .failures = config->failures,
        .attacks = config->attacks,
        .first_ns = config->first_ms * ISO_NS_PER_MS,
        .longest_ns = config->longest_ms * ISO_NS_PER_MS,
        .forget_ns = config->forget_ms * ISO_NS_PER_MS,
    };
    struct iso_lockout_record record = {0};
    struct iso_fault fault = {""};
    int error = 0;
    iso_lockout_init(&appliance->lockout, &options);
    appliance->lockout_save_ns = ISO_NEVER_NS;
    if (!appliance->parts.lockout_path) {
        appliance->parts.lockout_path = "";
    }
    if (*appliance->parts.lockout_path) {
        error = iso_lockout_load(appliance->parts.lockout_path, &record, &fault);
    }
    if (error && error != -ENOENT) {
        suspect(appliance, &fault);
        return;
    }
    iso_lockout_restore(&appliance->lockout, &record, now_ns(appliance));
    if (iso_lockout_refusal(&appliance->lockout) != ISO_REASON_NONE) {
        iso__appliance_say(appliance, LOG_WARNING, "%s, as before the restart",
                           iso_reason_name(iso_lockout_refusal(&appliance->lockout)));
    }
}

bool iso__appliance_is_shut(const struct iso_appliance *appliance)
{
    return iso_lockout_refusal(&appliance->lockout) != ISO_REASON_NONE;
}

void iso__appliance_lockout_time(struct iso_appliance *appliance, int64_t t_ns)
{
    const bool was_shut = iso__appliance_is_shut(appliance);
    if (t_ns >= appliance->lockout_save_ns) {
        save(appliance);
    }
    if (!iso_lockout_time(&appliance->lockout, t_ns)) {
        return;
    }
    if (was_shut && !iso__appliance_is_shut(appliance)) {
        struct iso_audit_record record = iso_audit_record_of("lockout");
        record.reason = "over";
        (void)iso__appliance_record(appliance, &record);
        iso_decision_reset(&appliance->decision); /* who was not compared begins anew */
    }
    save(appliance);
}

/* On record that it has locked, and for how long. */
static void record_lock(struct iso_appliance *appliance)
{
    char note[64];
    struct iso_audit_record record = iso_audit_record_of("lockout");
    const int64_t left_ns = iso_lockout_remaining_ns(&appliance->lockout, now_ns(appliance));
    record.reason = "locked";
    (void)snprintf(note, sizeof note, "%.0f s: %d failures, %d attacks",
                   (double)left_ns / (double)ISO_NS_PER_S, appliance->lockout.failures,
                   appliance->lockout.attacks);
    record.note = note;
    (void)iso__appliance_record(appliance, &record);
    iso__appliance_say(appliance, LOG_WARNING, "nobody is let in for %s", note);
}

void iso__appliance_count_verdict(struct iso_appliance *appliance,
                                  const struct iso_verdict *verdict)
{
    const int agree = appliance->decision.options.agree;
    const bool remembered = appliance->lockout.failures > 0;
    if (iso_lockout_verdict(&appliance->lockout, verdict, agree, now_ns(appliance))) {
        record_lock(appliance);
        iso_decision_reset(&appliance->decision);
        save(appliance);
    } else if (iso_lockout_counts(verdict, agree) || (verdict->allow && remembered)) {
        save(appliance);
    }
}

void iso__appliance_shut_out(const struct iso_appliance *appliance, struct iso_verdict *verdict)
{
    const enum iso_reason refusal = iso_lockout_refusal(&appliance->lockout);
    if (refusal != ISO_REASON_NONE) {
        verdict->allow = false;
        verdict->reason = refusal;
        verdict->person = 0;
        verdict->score = NAN;
    }
}

/* ---- an administrator ---- */

static int record_act(struct iso_appliance *appliance, const char *event, const char *what,
                      struct iso_fault *fault)
{
    struct iso_audit_record record = iso_audit_record_of(event);
    record.reason = what;
    return iso_audit_append(appliance->parts.audit, &record, fault);
}

int iso_appliance_clear_lockout(struct iso_appliance *appliance, struct iso_fault *fault)
{
    const int error = record_act(appliance, "lockout", "cleared", fault);
    if (error) {
        return error;
    }
    iso_lockout_clear(&appliance->lockout);
    iso_decision_reset(&appliance->decision);
    save(appliance);
    return 0;
}

int iso_appliance_lockdown(struct iso_appliance *appliance, bool on, struct iso_fault *fault)
{
    const int error = record_act(appliance, "lockdown", on ? "on" : "off", fault);
    if (error && !on) {
        return error;
    }
    appliance->lockout.lockdown = on;
    iso_decision_reset(&appliance->decision);
    iso__appliance_say(appliance, LOG_NOTICE, "lockdown %s", on ? "on" : "off");
    save(appliance);
    return error;
}
