#include "firmware/appliance/administration/administration.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <syslog.h>
#include <unistd.h>

#include "drivers/file/disk_wait.h"
#include "drivers/terminal/words.h"
#include "firmware/appliance/appliance_calls.h"

int iso__appliance_may_begin(const struct iso_appliance *appliance, struct iso_fault *fault)
{
    return appliance->mode >= ISO_APPLIANCE_ENROLL
               ? iso_fault_set(fault, -EBUSY, "%s goes on, stop it first",
                               iso_appliance_mode_name(appliance->mode))
               : 0;
}

/* Records what will be done. If this fails, it must not be done. */
static int announce_event(struct iso_appliance *appliance, const char *event, const char *note,
                          struct iso_fault *fault)
{
    struct iso_audit_record record = iso_audit_record_of(event);
    const int error = iso__appliance_may_begin(appliance, fault);
    record.note = note;
    return error ? error : iso__appliance_record_first(appliance, &record, fault);
}

/* Records the result. The system's log is not sealed, so names do not go there. */
static void conclude_event(struct iso_appliance *appliance, const char *event, int error,
                           const struct iso_fault *fault, const char *note)
{
    struct iso_audit_record record = iso_audit_record_of(event);
    record.reason = error ? "failed" : "done";
    record.note = error ? fault->text : note;
    (void)iso__appliance_record(appliance, &record);
    iso__appliance_note_storage(appliance, error, fault);
    iso__appliance_say(appliance, error ? LOG_ERR : LOG_NOTICE, "%s %s", event, record.reason);
}

/* ---- files ---- */

static int check_file(int fd, off_t *size, struct iso_fault *fault)
{
    struct stat status;
    if (fstat(fd, &status) || !S_ISREG(status.st_mode)) {
        return iso_fault_set(fault, -EINVAL, "this is not a file");
    }
    *size = status.st_size;
    return 0;
}

static int write_file(int fd, const uint8_t *bytes, size_t size, struct iso_fault *fault)
{
    for (size_t at = 0; at < size;) {
        const ssize_t n = pwrite(fd, bytes + at, size - at, (off_t)at);
        if (n <= 0) {
            const int error = n < 0 ? -errno : -ENOSPC;
            return iso_fault_set(fault, error, "the file cannot be written: %s", strerror(-error));
        }
        at += (size_t)n;
    }
    return iso_disk_wait_fsync(fd) ? iso_fault_set(fault, -errno, "the file cannot be written: %m")
                                   : 0;
}

static int read_file(int fd, uint8_t **bytes, size_t *size, struct iso_fault *fault)
{
    off_t length = 0;
    const int error = check_file(fd, &length, fault);
    if (error) {
        return error;
    }
    if (length > ISO_TRANSFER_MAX_BYTES) {
        return iso_fault_set(fault, -EFBIG, "the file is too large");
    }
    uint8_t *read = malloc((size_t)length + 1);
    if (!read) {
        return iso_fault_set(fault, -ENOMEM, "out of memory");
    }
    for (off_t at = 0; at < length;) {
        const ssize_t n = pread(fd, read + at, (size_t)(length - at), at);
        if (n <= 0) {
            free(read);
            return iso_fault_set(fault, -EIO, "the file cannot be read");
        }
        at += n;
    }
    *bytes = read;
    *size = (size_t)length;
    return 0;
}

/* ---- people ---- */

static int export_to(struct iso_appliance *appliance, int fd, const char *const *people,
                     const struct iso_transfer_lock *lock, const struct iso_work_listener *listener,
                     size_t *n, struct iso_fault *fault)
{
    uint8_t *bytes = NULL;
    size_t size = 0;
    off_t length = 0;
    int error = check_file(fd, &length, fault);
    if (!error && length > 0) {
        error = iso_fault_set(fault, -EINVAL, "the file is not empty");
    }
    if (!error) {
        error = iso_transfer_write(appliance->borrowed.gallery, people, appliance->borrowed.ring,
                                   lock, listener, &bytes, &size, n, fault);
    }
    if (!error) {
        error = write_file(fd, bytes, size, fault);
        iso_transfer_free(bytes, size);
    }
    return error;
}

int iso_appliance_export(struct iso_appliance *appliance, int fd, const char *const *people,
                         const struct iso_transfer_lock *lock,
                         const struct iso_work_listener *listener, size_t *n,
                         struct iso_fault *fault)
{
    char note[96];
    size_t count = 0;
    struct iso_fault own = {.text = ""};
    (void)snprintf(note, sizeof note, "for %s%.16s",
                   lock->address ? "" : "anyone with the passphrase",
                   lock->address ? lock->address : "");
    int error = announce_event(appliance, "export", note, fault);
    if (error) {
        return error;
    }
    error = export_to(appliance, fd, people, lock, listener, &count, &own);
    (void)snprintf(note, sizeof note, "%zu %s", count, iso_plural(count, "person", "people"));
    conclude_event(appliance, "export", error, &own, note);
    if (error) {
        return iso_fault_set_code(fault, own.code, error, "%s", own.text);
    }
    *n = count;
    return 0;
}

/* An import replaces nobody who came from the fleet. */
static int may_replace(const struct iso_appliance *appliance, const struct iso_gallery_item *items,
                       size_t n, struct iso_fault *fault)
{
    int error = 0;
    for (size_t i = 0; !error && i < n; i++) {
        const struct iso_person *known = iso_gallery_find(appliance->borrowed.gallery,
                                                          items[i].person.name);
        error = iso__appliance_may_change(appliance, known, fault);
    }
    return error;
}

static int import_from(struct iso_appliance *appliance, const struct iso_import_request *request,
                       size_t *added, size_t *n, struct iso_fault *fault)
{
    struct iso_transfer *transfer = NULL;
    uint8_t *bytes = NULL;
    size_t size = 0;
    int error = read_file(request->fd, &bytes, &size, fault);
    if (!error) {
        error = iso_transfer_read(bytes, size, appliance->borrowed.ring, request->key,
                                  request->sender, &transfer, fault);
    }
    free(bytes);
    if (!error) {
        const struct iso_gallery_item *items = iso_transfer_items(transfer, n);
        error = request->replace ? may_replace(appliance, items, *n, fault) : 0;
        if (!error) {
            error = iso_gallery_import(appliance->borrowed.gallery, items, *n, request->replace,
                                       request->listener, added, fault);
        }
    }
    iso_transfer_done(transfer);
    return error;
}

int iso_appliance_import(struct iso_appliance *appliance, const struct iso_import_request *request,
                         size_t *added, size_t *known, struct iso_fault *fault)
{
    char note[96];
    size_t came = 0, n = 0;
    struct iso_fault own = {.text = ""};
    (void)snprintf(note, sizeof note, "from %s%.16s",
                   request->sender ? "" : "anyone with the passphrase",
                   request->sender ? request->sender : "");
    int error = announce_event(appliance, "import", note, fault);
    if (error) {
        return error;
    }
    error = import_from(appliance, request, &came, &n, &own);
    (void)snprintf(note, sizeof note, "%zu of %zu people", came, n);
    conclude_event(appliance, "import", error, &own, note);
    if (error) {
        return iso_fault_set_code(fault, own.code, error, "%s", own.text);
    }
    iso__appliance_record_gallery(appliance, "gallery", NULL);
    *added = came;
    *known = n - came;
    return 0;
}

int iso__appliance_record_change(struct iso_appliance *appliance,
                                 const struct iso_audit_record *record, struct iso_fault *fault)
{
    const int error = iso__appliance_may_begin(appliance, fault);
    return error ? error : iso__appliance_record_first(appliance, record, fault);
}

void iso__appliance_conclude_change(struct iso_appliance *appliance,
                                    struct iso_audit_record *record, int error,
                                    const struct iso_fault *fault)
{
    if (error) {
        record->reason = "failed";
        record->note = fault->text;
        (void)iso__appliance_record(appliance, record);
        iso__appliance_note_storage(appliance, error, fault);
    } else {
        iso__appliance_record_gallery(appliance, "gallery", NULL);
    }
    iso__appliance_say(appliance, error ? LOG_ERR : LOG_NOTICE, "%s %s", record->event,
                       error ? "failed" : "done");
}

static const char *remark_of_rename(const struct iso_appliance *appliance, const char *before,
                                    const char *after)
{
    const struct iso_cards *cards = appliance->borrowed.cards;
    const struct iso_card *old = cards ? iso_cards_find(cards, before) : NULL;
    const struct iso_card *renamed = cards ? iso_cards_find(cards, after) : NULL;
    if (old == renamed) {
        return "";
    }
    return renamed ? "the file of card numbers ([door] cards) has a number for the new name, which "
                     "is sent from now on: see that it is the right one"
                   : "the file of card numbers ([door] cards) has the old name: change it there "
                     "too and restart the daemon, or no card number is sent";
}

int iso_appliance_rename(struct iso_appliance *appliance, const char *person, const char *name,
                         const char **remark, struct iso_fault *fault)
{
    struct iso_gallery *gallery = appliance->borrowed.gallery;
    char before[ISO_PERSON_NAME_SIZE];
    struct iso_fault own = {.text = ""};
    if (iso_gallery_state(gallery, fault)) {
        return -EIO;
    }
    int error = iso_gallery_may_rename(gallery, person, name, fault);
    if (!error) {
        error = iso__appliance_may_change(appliance, iso_gallery_find(gallery, person), fault);
    }
    if (error) {
        return error;
    }
    (void)snprintf(before, sizeof before, "%s", iso_gallery_find(gallery, person)->name);
    struct iso_audit_record record = iso_audit_record_of("rename");
    record.person = record.before = before;
    record.after = name;
    error = iso__appliance_record_change(appliance, &record, fault);
    if (error) {
        return error;
    }
    error = iso_gallery_rename(gallery, before, name, &own);
    iso__appliance_conclude_change(appliance, &record, error, &own);
    if (error) {
        return iso_fault_set_code(fault, own.code, error, "%s", own.text);
    }
    *remark = remark_of_rename(appliance, before, name);
    return 0;
}

int iso_appliance_set_validity(struct iso_appliance *appliance, const char *person,
                               const struct iso_validity_change *change, struct iso_fault *fault)
{
    const struct iso_person *known = iso_gallery_find(appliance->borrowed.gallery, person);
    const int64_t now_s = iso_times_wall_ns(&appliance->borrowed.times) / ISO_NS_PER_S;
    char flaw[ISO_VALIDITY_FLAW_SIZE];
    char before_text[ISO_VALIDITY_TEXT_SIZE], after_text[ISO_VALIDITY_TEXT_SIZE];
    struct iso_fault own = {.text = ""};
    if (iso_gallery_state(appliance->borrowed.gallery, fault)) {
        return -EIO;
    }
    if (!known) {
        return iso_fault_set(fault, -ENOENT, "%s: no such person", person);
    }
    const struct iso_validity before = {known->valid_from_s, known->valid_until_s};
    const struct iso_validity after = iso_validity_after(&before, change);
    if (!iso_validity_is_fine(&before, change, now_s, flaw)) {
        return iso_fault_set(fault, -EINVAL, "%s", flaw);
    }
    iso_validity_text(&before, before_text);
    iso_validity_text(&after, after_text);
    struct iso_audit_record record = iso_audit_record_of("validity");
    record.person = known->name;
    record.before = before_text;
    record.after = after_text;
    int error = iso__appliance_may_change(appliance, known, fault);
    if (!error) {
        error = iso__appliance_record_change(appliance, &record, fault);
    }
    if (error) {
        return error;
    }
    error = iso_gallery_set_validity(appliance->borrowed.gallery, known->name, &after, &own);
    iso__appliance_conclude_change(appliance, &record, error, &own);
    return error ? iso_fault_set_code(fault, own.code, error, "%s", own.text) : 0;
}

/* ---- the door ---- */

static int may_test_door(const struct iso_appliance *appliance, struct iso_fault *fault)
{
    if (appliance->mode != ISO_APPLIANCE_WATCH) {
        return iso_fault_set(fault, -EBUSY, "the camera is claimed, the door is not watched");
    }
    if (iso__appliance_lock_reason(appliance) != ISO_REASON_NONE) {
        return iso_fault_set(fault, -EPERM, "%s: nobody is let in",
                             appliance->lockout.state.lockdown ? "lockdown" : "locked out");
    }
    if (!iso_config_has_relay(appliance->borrowed.config)) {
        return iso_fault_set(fault, -ENODEV, "the door has no relay: [door] relay is empty");
    }
    return iso_door_guard_may_test(appliance->door, fault);
}

int iso_appliance_test_door(struct iso_appliance *appliance, struct iso_fault *fault)
{
    struct iso_fault own = {.text = ""};
    const struct iso_audit_record record = iso_audit_record_of("door-test");
    int error = may_test_door(appliance, fault);
    if (!error) {
        error = iso__appliance_record_grant(appliance, &record, fault);
    }
    if (error) {
        return error;
    }
    error = iso_door_guard_test(appliance->door, &own);
    iso__appliance_tell_door(appliance);
    conclude_event(appliance, "door-test", error, &own, "the relay was switched");
    return error ? iso_fault_set_code(fault, own.code, error, "%s", own.text) : 0;
}

/* ---- keys ---- */

/* The keys of the use ISO_KEY_ANCHOR seal the anchors of gallery and log, the lock-out file and
 * the file of changed settings. */
static int rotate_anchors(struct iso_appliance *appliance, struct iso_audit *audit,
                          struct iso_fault *fault)
{
    struct iso_appliance_borrowed *borrowed = &appliance->borrowed;
    uint32_t anchor = 0;
    int error = iso_key_ring_add(borrowed->ring, ISO_KEY_ANCHOR, &anchor, fault);
    if (!error) {
        error = iso_gallery_renew_anchor(borrowed->gallery, fault);
    }
    if (!error) {
        error = iso_audit_renew_anchor(audit, fault);
    }
    if (!error) {
        error = iso__appliance_keep_lockout(appliance, fault);
    }
    if (!error && borrowed->settings) {
        error = iso_live_settings_renew(borrowed->settings, fault);
    }
    return error ? error : iso_key_ring_drop(borrowed->ring, ISO_KEY_ANCHOR, anchor, fault);
}

static int rotate_stores(struct iso_appliance *appliance, const struct iso_work_listener *listener,
                         struct iso_fault *fault)
{
    struct iso_appliance_borrowed *borrowed = &appliance->borrowed;
    int error = iso_gallery_rotate(borrowed->gallery, listener, fault);
    struct iso_audit *audit = iso_audit_writer_hold(appliance->log);
    if (!error) {
        error = iso_audit_rotate_key(audit, fault);
    }
    if (!error) {
        error = rotate_anchors(appliance, audit, fault);
    }
    iso_audit_writer_release(appliance->log);
    return error;
}

int iso_appliance_rotate_keys(struct iso_appliance *appliance,
                              const struct iso_work_listener *listener, const char **remark,
                              struct iso_fault *fault)
{
    struct iso_fault own = {.text = ""};
    const char *said = "";
    int error = announce_event(appliance, "rotate-keys", NULL, fault);
    if (error) {
        return error;
    }
    error = rotate_stores(appliance, listener, &own);
    if (!error && iso_key_ring_has_credential(appliance->borrowed.ring)) {
        said = "the appliance's key is a credential of the system, and is changed there";
    } else if (!error) {
        error = iso_key_ring_change_key(appliance->borrowed.ring, &own);
    }
    conclude_event(appliance, "rotate-keys", error, &own, said);
    iso__appliance_record_gallery(appliance, "gallery", NULL);
    if (error) {
        return iso_fault_set_code(fault, own.code, error, "%s", own.text);
    }
    *remark = said;
    return 0;
}
