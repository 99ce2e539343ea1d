/* The system's journal as a second place for what the audit log says: structured fields, for
 * `journalctl ISOTHERM_EVENT=visit`. No name goes there, for the journal is not sealed:
 *
 *   ISOTHERM_EVENT, ISOTHERM_SEQUENCE, ISOTHERM_HEAD and, where they apply, ISOTHERM_VERDICT,
 *   ISOTHERM_DOOR (what the door did after "allow"), ISOTHERM_REASON, ISOTHERM_SCORE,
 * ISOTHERM_THRESHOLD, ISOTHERM_FRAMES, ISOTHERM_ATTACK_FRAMES, ISOTHERM_SENSOR
 *
 * ISOTHERM_HEAD is the head of the log behind the record (audit.h): a journal that is kept
 * elsewhere bears witness against a log that is put back. */
#ifndef ISO_FIRMWARE_JOURNAL_H
#define ISO_FIRMWARE_JOURNAL_H

#include "firmware/audit.h"

/* For iso_audit_options.written; context is not used. What cannot be sent is lost. */
void iso_journal_record(void *context, const struct iso_audit_record *record, uint64_t sequence,
                        const char *head);

/* The fields, as texts "NAME=value"; returns how many there are. */
enum { ISO_JOURNAL_FIELDS_MAX = 15, ISO_JOURNAL_FIELD_SIZE = 192 };

size_t iso_journal_fields(const struct iso_audit_record *record, uint64_t sequence,
                          const char *head,
                          char fields[ISO_JOURNAL_FIELDS_MAX][ISO_JOURNAL_FIELD_SIZE]);

#endif
