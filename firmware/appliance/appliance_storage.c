/* The state of the disk, and of the counter of the state. Brings a gallery that is out of service
 * back, reports faults of the counter, and makes sure that the counter also counts a change after
 * which no record is written. */
#include <errno.h>
#include <syslog.h>

#include "drivers/file/storage_fault.h"
#include "firmware/appliance/appliance_access.h"
#include "firmware/appliance/appliance_calls.h"
#include "firmware/keys/state_counter.h"

static const int64_t retry_ns = ISO_NS_PER_S;

void iso__appliance_init_storage(struct iso_appliance *appliance)
{
    appliance->storage.gallery_retry_ns = ISO_NEVER_NS;
}

void iso__appliance_note_storage(struct iso_appliance *appliance, int error,
                                 const struct iso_fault *fault)
{
    if (iso_storage_is_refusal(error)) {
        appliance->storage.fault = *fault;
    } else if (!error) {
        appliance->storage.fault = (struct iso_fault){.text = ""};
    }
}

const struct iso_fault *iso__appliance_storage_fault(const struct iso_appliance *appliance)
{
    return iso__appliance_lockout_is_unread(appliance) ? &appliance->lockout.fault
                                                       : &appliance->storage.fault;
}

/* Each fault of the log is reported once, until the log can be written again. */
void iso__appliance_tell_log(struct iso_appliance *appliance)
{
    struct iso_fault fault;
    int error = 0;
    if (iso_audit_writer_take_result(appliance->log, &error, &fault)) {
        const int told = appliance->storage.log_error;
        iso__appliance_note_storage(appliance, error, &fault);
        (void)iso__appliance_say_fault(appliance, error == told ? 0 : error, &fault);
        appliance->storage.log_error = error;
    }
}

int64_t iso__appliance_storage_due_ns(const struct iso_appliance *appliance)
{
    return appliance->storage.gallery_retry_ns;
}

void iso__appliance_storage_time(struct iso_appliance *appliance, int64_t t_ns)
{
    struct iso_gallery *gallery = appliance->borrowed.gallery;
    struct iso_fault fault = {.text = ""};
    if (!iso_gallery_state(gallery, &fault)) {
        appliance->storage.gallery_retry_ns = ISO_NEVER_NS;
        return;
    }
    if (appliance->storage.gallery_retry_ns == ISO_NEVER_NS) {
        char tag[ISO_FAULT_TAG_SIZE];
        iso__appliance_say(appliance, LOG_ERR, "%s: nobody is let in%s", fault.text,
                           iso_fault_tag(fault.code, tag));
    } else if (t_ns < appliance->storage.gallery_retry_ns) {
        return;
    }
    appliance->storage.gallery_retry_ns = t_ns + retry_ns;
    if (iso_gallery_recover(gallery, &fault)) {
        iso__appliance_note_storage(appliance, -EIO, &fault);
        return;
    }
    appliance->storage.gallery_retry_ns = ISO_NEVER_NS;
    iso__appliance_decide_anew(appliance);        /* faces were not compared until now */
    (void)!iso__appliance_load_policy(appliance); /* without memory the earlier one still holds */
    iso__appliance_say(appliance, LOG_NOTICE, "the gallery is in service again");
    iso__appliance_record_gallery(appliance, "gallery", "read from the disk again");
}

/* ---- the counter of the state directory ---- */

/* Longer than the log needs for a record, because the number is due for a moment with each record.
 */
static const int64_t counter_patience_ns = 2 * ISO_NS_PER_S;

static void take_counter_news(struct iso_appliance *appliance)
{
    struct iso_fault fault = {.text = ""};
    int error = 0;
    if (!iso_state_counter_take_news(appliance->borrowed.counter, &error, &fault)) {
        return;
    }
    appliance->counter.fault = fault;
    if (error) {
        char tag[ISO_FAULT_TAG_SIZE];
        iso__appliance_say(appliance, LOG_ERR,
                           "the counter of the state stands still, and a restart may be refused: "
                           "%s%s",
                           fault.text, iso_fault_tag(fault.code, tag));
    } else {
        iso__appliance_say(appliance, LOG_NOTICE, "the counter of the state works again");
    }
}

/* Writes a record if the number is due for long. The record makes the log write its anchor, and the
 * number with it. One such record is enough. */
static void follow_counter(struct iso_appliance *appliance, int64_t now_ns)
{
    if (!iso_state_counter_is_due(appliance->borrowed.counter)) {
        appliance->counter.due = appliance->counter.noted = false;
    } else if (!appliance->counter.due) {
        appliance->counter.due = true;
        appliance->counter.due_ns = now_ns;
    } else if (!appliance->counter.noted &&
               now_ns - appliance->counter.due_ns >= counter_patience_ns) {
        const struct iso_audit_record record = iso_audit_record_of("counter");
        appliance->counter.noted = true;
        (void)iso__appliance_note(appliance, &record);
    }
}

void iso__appliance_counter_time(struct iso_appliance *appliance, int64_t now_ns)
{
    if (appliance->borrowed.counter) {
        take_counter_news(appliance);
        follow_counter(appliance, now_ns);
    }
}
