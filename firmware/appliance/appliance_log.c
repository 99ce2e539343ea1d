/* Records for the audit log, and lines for the system's log. */
#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <syslog.h>

#include "firmware/appliance/appliance_calls.h"

void iso__appliance_say(struct iso_appliance *appliance, int priority, const char *format, ...)
{
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    appliance->borrowed.events.message(appliance->borrowed.events.context, priority, text);
}

int iso__appliance_say_fault(struct iso_appliance *appliance, int error,
                             const struct iso_fault *fault)
{
    char tag[ISO_FAULT_TAG_SIZE];
    if (error) {
        iso__appliance_say(appliance, LOG_ERR, "%s%s", fault->text,
                           iso_fault_tag(fault->code, tag));
    }
    return error;
}

void iso__appliance_warn(struct iso_appliance *appliance, const struct iso_fault *fault)
{
    char tag[ISO_FAULT_TAG_SIZE];
    iso__appliance_say(appliance, LOG_WARNING, "%s%s", fault->text,
                       iso_fault_tag(fault->code, tag));
}

int iso__appliance_record_first(struct iso_appliance *appliance,
                                const struct iso_audit_record *record, struct iso_fault *fault)
{
    struct iso_fault own = {.text = ""};
    const int error = iso_audit_writer_append(appliance->log, record, ISO_NEVER_NS, NULL, &own);
    iso__appliance_note_storage(appliance, error, &own);
    return error ? iso_fault_set_code(fault, own.code, error, "%s", own.text) : 0;
}

int iso__appliance_record(struct iso_appliance *appliance, const struct iso_audit_record *record)
{
    struct iso_fault fault = {.text = ""};
    const int error = iso__appliance_record_first(appliance, record, &fault);
    return iso__appliance_say_fault(appliance, error, &fault);
}

/* The writer keeps a fault of the disk; iso__appliance_tell_log reports it. */
int iso__appliance_note(struct iso_appliance *appliance, const struct iso_audit_record *record)
{
    const int error = iso_audit_writer_post(appliance->log, record, NULL);
    iso__appliance_tell_door(appliance);
    return error;
}

/* The clock by which the writer waits stops during a suspension. So the time is measured again by
 * the clock that runs on. */
int iso__appliance_record_grant(struct iso_appliance *appliance,
                                const struct iso_audit_record *record, struct iso_fault *fault)
{
    static const int64_t wait_ns = ISO_GRANT_WAIT_MS * ISO_NS_PER_MS;
    const struct iso_times *times = &appliance->borrowed.times;
    const int64_t begin_ns = iso_times_boot_ns(times);
    struct iso_fault own = {.text = ""};
    int error = iso_audit_writer_append(appliance->log, record, wait_ns, NULL, &own);
    iso__appliance_note_storage(appliance, error, &own);
    const int64_t took_ns = iso_times_boot_ns(times) - begin_ns;
    if (!error && took_ns > wait_ns) {
        error = iso_fault_set_code(&own, ISO_FAULT_LOG_LATE, -ETIMEDOUT,
                                   "the record took %lld ms to get to the disk",
                                   (long long)(took_ns / ISO_NS_PER_MS));
    }
    if (error) {
        (void)iso_fault_set_code(fault, own.code, error, "%s", own.text);
    }
    return iso__appliance_say_fault(appliance, error, &own);
}

void iso__appliance_record_gallery(struct iso_appliance *appliance, const char *event,
                                   const char *note)
{
    const struct iso_gallery_version version = iso_gallery_version(appliance->borrowed.gallery);
    struct iso_audit_record record = iso_audit_record_of(event);
    record.gallery = version.gallery;
    record.gallery_changes = version.changes;
    record.note = note;
    (void)iso__appliance_record(appliance, &record);
}

struct iso_audit_writer *iso_appliance_log(const struct iso_appliance *appliance)
{
    return appliance->log;
}

int iso_appliance_record_act(struct iso_appliance *appliance, const char *person, const char *note,
                             struct iso_fault *fault)
{
    struct iso_audit_record record = iso_audit_record_of("act");
    record.person = *person ? person : NULL;
    record.note = note;
    return iso__appliance_record_first(appliance, &record, fault);
}
