/* The system's journal as a second place for what the audit log says: structured fields, for
 * `journalctl ISOTHERM_EVENT=visit`. No name goes there, for the journal is not sealed:
 *
 *   ISOTHERM_EVENT, ISOTHERM_SEQUENCE, ISOTHERM_HEAD
 *   and, where they apply, ISOTHERM_VERDICT, ISOTHERM_DOOR (what the door did after "allow"),
 *   ISOTHERM_REASON, ISOTHERM_SCORE, ISOTHERM_THRESHOLD, ISOTHERM_FRAMES,
 *   ISOTHERM_ATTACK_FRAMES, ISOTHERM_SENSOR
 *
 * A thread sends the entries, since the journal may be stuck, and the log must not wait for it:
 * they wait in a queue of ISO_JOURNAL_ENTRIES. An entry that finds no place is not sent; the next
 * one that does says how many those were (ISOTHERM_UNSENT). The audit log has all of them.
 *
 * ISOTHERM_HEAD is the head of the log behind the record (audit.h): a journal that is kept
 * elsewhere bears witness against a log that is put back. */
#ifndef ISO_FIRMWARE_AUDIT_JOURNAL_H
#define ISO_FIRMWARE_AUDIT_JOURNAL_H

#include <stddef.h>
#include <sys/uio.h>

#include "firmware/audit/audit.h"

enum { ISO_JOURNAL_ENTRIES = 128 };

struct iso_journal;

/* Sends an entry of n fields. It may block, and its result is ignored. It is sd_journal_sendv,
 * except in tests. */
typedef int iso_journal_send(const struct iovec *fields, int n);

/* Starts the thread. -ENOMEM, -EAGAIN no thread can be had. */
int iso_journal_new(iso_journal_send *send, struct iso_journal **out)
    __attribute__((warn_unused_result));

/* Sends the queued entries, but waits for at most a second. NULL is fine. */
void iso_journal_free(struct iso_journal *journal);

/* For iso_audit_options.written, with the journal as its context: queues an entry without
 * waiting. */
void iso_journal_record(void *journal, const struct iso_audit_record *record, uint64_t sequence,
                        const char *head);

/* Writes the fields as texts "NAME=value". Returns their number. */
enum { ISO_JOURNAL_FIELDS_MAX = 15, ISO_JOURNAL_FIELD_SIZE = 192 };

size_t iso_journal_fields(const struct iso_audit_record *record, uint64_t sequence,
                          const char *head,
                          char fields[ISO_JOURNAL_FIELDS_MAX][ISO_JOURNAL_FIELD_SIZE]);

#endif
