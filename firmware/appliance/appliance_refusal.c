/* Lock-out and lockdown: nobody is let in, whatever the face. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <syslog.h>

#include "drivers/file/storage_fault.h"
#include "firmware/appliance/appliance_calls.h"
#include "firmware/keys/heads.h"
#include "firmware/visit/lockout_file.h"

static const int64_t save_again_ns = ISO_NS_PER_S, read_again_ns = 3 * ISO_NS_PER_S;

bool iso__appliance_lockout_is_unread(const struct iso_appliance *appliance)
{
    return appliance->lockout.read_ns != ISO_NEVER_NS;
}

int iso__appliance_keep_lockout(struct iso_appliance *appliance, struct iso_fault *fault)
{
    const struct iso_appliance_borrowed *borrowed = &appliance->borrowed;
    const struct iso_lockout_record record = iso_lockout_record_of(
        &appliance->lockout.state, iso__appliance_now_ns(appliance));
    if (iso__appliance_lockout_is_unread(appliance)) {
        return iso_fault_set_code(fault, appliance->lockout.fault.code, -EIO, "%s",
                                  appliance->lockout.fault.text);
    }
    return *borrowed->lockout_path
               ? iso_lockout_save(borrowed->lockout_path, borrowed->ring, &record, fault)
               : 0;
}

/* Writes the file. If that fails, the state holds until the next restart, and writing is tried
 * again. */
static int save_lockout(struct iso_appliance *appliance, struct iso_fault *out)
{
    const bool said = appliance->lockout.save_ns != ISO_NEVER_NS;
    struct iso_fault fault = {.text = ""};
    appliance->lockout.save_ns = ISO_NEVER_NS;
    const int error = iso__appliance_keep_lockout(appliance, &fault);
    if (!error) {
        return 0;
    }
    appliance->lockout.save_ns = iso__appliance_now_ns(appliance) + save_again_ns;
    if (!said) {
        (void)iso__appliance_say_fault(appliance, error, &fault);
    }
    iso__appliance_note_storage(appliance, error, &fault);
    return iso_fault_set_code(out, fault.code, error, "%s", fault.text);
}

/* Whether the file has the present state although the disk reported an error. */
static bool is_kept(const struct iso_appliance *appliance)
{
    const struct iso_lockout_record wanted = iso_lockout_record_of(
        &appliance->lockout.state, iso__appliance_now_ns(appliance));
    const struct iso_appliance_borrowed *borrowed = &appliance->borrowed;
    struct iso_lockout_file file;
    if (iso_lockout_read(borrowed->lockout_path, borrowed->ring, &file, NULL)) {
        return false;
    }
    const struct iso_lockout_record found = file.record;
    return found.lockdown == wanted.lockdown && found.failures == wanted.failures &&
           found.attacks == wanted.attacks && found.locks == wanted.locks &&
           found.remaining_ns == wanted.remaining_ns;
}

/* Writes a state that lets people in again. If the disk does not keep it, the state before holds,
 * because a restart would bring it back anyway. */
static int save_or_undo(struct iso_appliance *appliance, const struct iso_lockout *before,
                        struct iso_fault *fault)
{
    const int error = save_lockout(appliance, fault);
    if (error && !is_kept(appliance)) {
        appliance->lockout.state = *before;
        return error;
    }
    return 0;
}

/* The file cannot be read, is gone or is old. It may have had a lockdown, so a lockdown begins.
 * The file stays as it is until an administrator ends the lockdown. */
static void suspect_file(struct iso_appliance *appliance, int error, const struct iso_fault *fault)
{
    struct iso_audit_record record = iso_audit_record_of("lockdown");
    record.reason = error == -ESTALE ? "stale" : "damaged";
    record.note = fault->text;
    char tag[ISO_FAULT_TAG_SIZE];
    appliance->lockout.state.lockdown = true;
    iso__appliance_say(appliance, LOG_ERR, "%s: nobody is let in until `isotherm lockdown off`%s",
                       fault->text, iso_fault_tag(fault->code, tag));
    (void)iso__appliance_record(appliance, &record);
}

/* Reads the file; all zero if there has never been one. */
static int load_file(const struct iso_appliance *appliance, struct iso_lockout_file *out,
                     struct iso_fault *fault)
{
    const struct iso_appliance_borrowed *borrowed = &appliance->borrowed;
    struct iso_lockout_file file = {.number = 0};
    if (!*borrowed->lockout_path) {
        *out = file;
        return 0;
    }
    const int error = iso_lockout_load(borrowed->lockout_path, borrowed->ring, &file, fault);
    if (error && error != -ENOENT) {
        return error;
    }
    if (!error && file.number == 0 && !borrowed->config->seal.migrate) {
        return iso_fault_set_code(fault, ISO_FAULT_STORE_UNSEALED, -ESTALE,
                                  "%s: not sealed, and [seal] migrate = no does not accept it",
                                  borrowed->lockout_path);
    }
    *out = file;
    return 0;
}

/* Takes over the state of the file. A lockdown that began before the file could be read goes on. */
static void take_file(struct iso_appliance *appliance, const struct iso_lockout_file *file)
{
    const bool lockdown = appliance->lockout.state.lockdown;
    iso_lockout_restore(&appliance->lockout.state, &file->record, iso__appliance_now_ns(appliance));
    const bool added = lockdown && !appliance->lockout.state.lockdown;
    appliance->lockout.state.lockdown = lockdown || appliance->lockout.state.lockdown;
    if (file->number == 0 || added) { /* writes a sealed file, which the other stores then know */
        (void)!save_lockout(appliance, NULL);
    }
    if (iso_lockout_refusal(&appliance->lockout.state) != ISO_REASON_NONE) {
        iso__appliance_say(appliance, LOG_WARNING, "%s, as before the restart",
                           iso_reason_name(iso_lockout_refusal(&appliance->lockout.state)));
    }
}

/* Errors that may pass, and do not depend on the contents of the file. */
static bool may_pass(int error)
{
    return iso_storage_is_refusal(error) || error == -ENOMEM || error == -ENFILE ||
           error == -EMFILE;
}

static void record_reading(struct iso_appliance *appliance, const char *reason, const char *note)
{
    struct iso_audit_record record = iso_audit_record_of("lockout");
    record.reason = reason;
    record.note = note;
    (void)iso__appliance_note(appliance, &record);
}

static void try_again_later(struct iso_appliance *appliance, const struct iso_fault *fault)
{
    const bool said = iso__appliance_lockout_is_unread(appliance);
    appliance->lockout.read_ns = iso__appliance_now_ns(appliance) + read_again_ns;
    appliance->lockout.fault = *fault;
    appliance->lockout.fault.code = ISO_FAULT_LOCKOUT_UNREADABLE;
    if (!said) {
        char tag[ISO_FAULT_TAG_SIZE];
        iso__appliance_say(appliance, LOG_ERR, "%s: nobody is let in until it can be read%s",
                           fault->text, iso_fault_tag(appliance->lockout.fault.code, tag));
        record_reading(appliance, "unreadable", fault->text);
    }
}

/* Reads the file, for the first time or again. Before the start its knowledge of the other stores
 * was compared with them, unless it could not be read then; in that case this is done now. */
static void read_file(struct iso_appliance *appliance)
{
    const bool again = iso__appliance_lockout_is_unread(appliance);
    struct iso_lockout_file file;
    struct iso_fault fault = {.text = ""};
    int error = load_file(appliance, &file, &fault);
    if (may_pass(error)) {
        try_again_later(appliance, &fault);
        return;
    }
    appliance->lockout.read_ns = ISO_NEVER_NS;
    if (!error && again) {
        error = iso_heads_check(iso_key_ring_board(appliance->borrowed.ring), &fault);
    }
    if (error) {
        suspect_file(appliance, error, &fault);
        return;
    }
    take_file(appliance, &file);
    if (again) {
        iso__appliance_decide_anew(appliance); /* faces were not compared until now */
        iso__appliance_say(appliance, LOG_NOTICE, "the lock-out file can be read again");
        record_reading(appliance, "readable", NULL);
    }
}

static struct iso_lockout_options options_of(const struct iso_appliance *appliance)
{
    const struct iso_config_lockout *config = &appliance->borrowed.config->lockout;
    return (struct iso_lockout_options){
        .failures = config->failures,
        .attacks = config->attacks,
        .first_ns = config->first_ms * ISO_NS_PER_MS,
        .longest_ns = config->longest_ms * ISO_NS_PER_MS,
        .forget_ns = config->forget_ms * ISO_NS_PER_MS,
    };
}

void iso__appliance_configure_lockout(struct iso_appliance *appliance)
{
    appliance->lockout.state.options = options_of(appliance);
}

void iso__appliance_start_lockout(struct iso_appliance *appliance)
{
    const struct iso_lockout_options options = options_of(appliance);
    iso_lockout_init(&appliance->lockout.state, &options);
    appliance->lockout.save_ns = ISO_NEVER_NS;
    appliance->lockout.read_ns = ISO_NEVER_NS;
    if (!appliance->borrowed.lockout_path) {
        appliance->borrowed.lockout_path = "";
    }
    read_file(appliance);
}

enum iso_reason iso__appliance_lock_reason(const struct iso_appliance *appliance)
{
    return iso_lockout_refusal(&appliance->lockout.state);
}

static bool is_locked(const struct iso_appliance *appliance)
{
    return iso__appliance_lock_reason(appliance) != ISO_REASON_NONE;
}

int64_t iso__appliance_lockout_due_ns(const struct iso_appliance *appliance)
{
    int64_t due_ns = iso_lockout_due_ns(&appliance->lockout.state);
    due_ns = appliance->lockout.save_ns < due_ns ? appliance->lockout.save_ns : due_ns;
    return appliance->lockout.read_ns < due_ns ? appliance->lockout.read_ns : due_ns;
}

static enum iso_reason refusal_of(const struct iso_appliance *appliance)
{
    if (is_locked(appliance)) {
        return iso__appliance_lock_reason(appliance);
    }
    if (iso__appliance_lockout_is_unread(appliance)) {
        return ISO_REASON_NO_LOCKOUT;
    }
    return iso_gallery_state(appliance->borrowed.gallery, NULL) ? ISO_REASON_NO_GALLERY
                                                                : ISO_REASON_NONE;
}

bool iso__appliance_is_shut(const struct iso_appliance *appliance)
{
    return refusal_of(appliance) != ISO_REASON_NONE;
}

void iso__appliance_lockout_time(struct iso_appliance *appliance, int64_t t_ns)
{
    if (t_ns >= appliance->lockout.read_ns) {
        read_file(appliance);
    }
    const bool was_locked = is_locked(appliance);
    if (t_ns >= appliance->lockout.save_ns) {
        (void)!save_lockout(appliance, NULL);
    }
    if (!iso_lockout_time(&appliance->lockout.state, t_ns)) {
        return;
    }
    if (was_locked && !is_locked(appliance)) {
        struct iso_audit_record record = iso_audit_record_of("lockout");
        record.reason = "over";
        (void)iso__appliance_note(appliance, &record);
        iso__appliance_decide_anew(appliance); /* faces were not compared until now */
    }
    (void)!save_lockout(appliance, NULL);
}

/* Records that the door is locked, and for how long. */
static void record_lock(struct iso_appliance *appliance)
{
    char note[64];
    struct iso_audit_record record = iso_audit_record_of("lockout");
    const int64_t left_ns = iso_lockout_remaining_ns(&appliance->lockout.state,
                                                     iso__appliance_now_ns(appliance));
    record.reason = "locked";
    (void)snprintf(note, sizeof note, "%.0f s: %d failures, %d attacks",
                   (double)left_ns / (double)ISO_NS_PER_S, appliance->lockout.state.failures,
                   appliance->lockout.state.attacks);
    record.note = note;
    (void)iso__appliance_note(appliance, &record);
    iso__appliance_say(appliance, LOG_WARNING, "nobody is let in for %s", note);
}

void iso__appliance_count_verdict(struct iso_appliance *appliance,
                                  const struct iso_verdict *verdict)
{
    const int agree = appliance->visit.decision.options.agree;
    const bool remembered = appliance->lockout.state.failures > 0;
    if (iso_lockout_verdict(&appliance->lockout.state, verdict, agree,
                            iso__appliance_now_ns(appliance))) {
        record_lock(appliance);
        iso__appliance_decide_anew(appliance);
        (void)!save_lockout(appliance, NULL);
    } else if (iso_lockout_counts(verdict, agree) || (verdict->allow && remembered)) {
        (void)!save_lockout(appliance, NULL);
    }
}

void iso__appliance_shut_out(const struct iso_appliance *appliance, struct iso_verdict *verdict)
{
    const enum iso_reason refusal = refusal_of(appliance);
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
    return iso__appliance_record_first(appliance, &record, fault);
}

int iso_appliance_clear_lockout(struct iso_appliance *appliance, struct iso_fault *fault)
{
    const struct iso_lockout before = appliance->lockout.state;
    if (iso__appliance_lockout_is_unread(
            appliance)) { /* it may contain a lockdown, which this must not end */
        return iso_fault_set_code(fault, appliance->lockout.fault.code, -EIO, "%s",
                                  appliance->lockout.fault.text);
    }
    int error = record_act(appliance, "lockout", "cleared", fault);
    if (error) {
        return error;
    }
    iso_lockout_clear(&appliance->lockout.state);
    iso__appliance_decide_anew(appliance);
    error = save_or_undo(appliance, &before, fault);
    if (error) {
        iso_storage_add(fault, "the lock-out is as before");
    } else {
        iso__appliance_accept_clock(appliance);
    }
    return error;
}

/* A lockdown begins even if the disk reports an error. */
static int begin_lockdown(struct iso_appliance *appliance, struct iso_fault *fault)
{
    const int error = record_act(appliance, "lockdown", "on", fault);
    struct iso_fault own = {.text = ""};
    appliance->lockout.state.lockdown = true;
    iso__appliance_decide_anew(appliance);
    const int unkept = save_lockout(appliance, &own);
    if (!unkept) {
        return error;
    }
    iso_storage_add(&own, "nobody is let in from now on, but a restart may forget that");
    return iso_fault_set_code(fault, own.code, unkept, "%s", own.text);
}

/* Ends a lockdown. This also replaces a file that cannot be read. */
static int end_lockdown(struct iso_appliance *appliance, struct iso_fault *fault)
{
    const struct iso_lockout before = appliance->lockout.state;
    const int64_t read_ns = appliance->lockout.read_ns;
    int error = record_act(appliance, "lockdown", "off", fault);
    if (error) {
        return error;
    }
    appliance->lockout.state.lockdown = false;
    appliance->lockout.read_ns = ISO_NEVER_NS;
    iso__appliance_decide_anew(appliance);
    error = save_or_undo(appliance, &before, fault);
    if (error) {
        appliance->lockout.read_ns = read_ns;
        iso_storage_add(fault, "the lockdown goes on");
    }
    return error;
}

int iso_appliance_lockdown(struct iso_appliance *appliance, bool on, struct iso_fault *fault)
{
    const int error = on ? begin_lockdown(appliance, fault) : end_lockdown(appliance, fault);
    iso__appliance_say(appliance, LOG_NOTICE, "lockdown %s",
                       appliance->lockout.state.lockdown ? "on" : "off");
    return error;
}
