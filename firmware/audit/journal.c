#include "firmware/audit/journal.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <syslog.h>

#include "firmware/contract/contract.h"

struct fields {
    char (*text)[ISO_JOURNAL_FIELD_SIZE];
    size_t n;
};

__attribute__((format(printf, 2, 3))) static void add(struct fields *fields, const char *format,
                                                      ...)
{
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(fields->text[fields->n++], ISO_JOURNAL_FIELD_SIZE, format, arguments);
    va_end(arguments);
}

static int priority_of(const struct iso_audit_record *record)
{
    if (record->door && strcmp(record->door, ISO_CONTRACT_DOOR_NOT_UNLOCKED) == 0) {
        return LOG_WARNING;
    }
    return record->verdict && strcmp(record->verdict, "deny") == 0 ? LOG_NOTICE : LOG_INFO;
}

size_t iso_journal_fields(const struct iso_audit_record *record, uint64_t sequence,
                          const char *head,
                          char fields[ISO_JOURNAL_FIELDS_MAX][ISO_JOURNAL_FIELD_SIZE])
{
    struct fields out = {.text = fields};
    add(&out, "MESSAGE=record %" PRIu64 ": %s%s%s%s%s%s%s", sequence, record->event,
        record->verdict ? " " : "", record->verdict ? record->verdict : "",
        record->reason ? ", " : "", record->reason ? record->reason : "",
        record->door ? ", door " : "", record->door ? record->door : "");
    add(&out, "PRIORITY=%d", priority_of(record));
    add(&out, "ISOTHERM_EVENT=%s", record->event);
    add(&out, "ISOTHERM_SEQUENCE=%" PRIu64, sequence);
    add(&out, "ISOTHERM_HEAD=%s", head);
    if (record->verdict) {
        add(&out, "ISOTHERM_VERDICT=%s", record->verdict);
    }
    if (record->door) {
        add(&out, "ISOTHERM_DOOR=%s", record->door);
    }
    if (record->reason) {
        add(&out, "ISOTHERM_REASON=%s", record->reason);
    }
    if (isfinite(record->score)) {
        add(&out, "ISOTHERM_SCORE=%.6g", record->score);
    }
    if (isfinite(record->threshold)) {
        add(&out, "ISOTHERM_THRESHOLD=%.6g", record->threshold);
    }
    if (record->frames >= 0) {
        add(&out, "ISOTHERM_FRAMES=%d", record->frames);
    }
    if (record->attack_frames >= 0) {
        add(&out, "ISOTHERM_ATTACK_FRAMES=%d", record->attack_frames);
    }
    if (record->sensor) {
        add(&out, "ISOTHERM_SENSOR=%s", record->sensor);
    }
    return out.n;
}
