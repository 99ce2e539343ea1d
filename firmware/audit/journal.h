/* The system's journal receives each record of the audit log, too: as structured fields, for
 * `journalctl ISOTHERM_EVENT=visit`. Names and notes are left out, because the journal is not
 * sealed:
 *
 *   ISOTHERM_EVENT, ISOTHERM_SEQUENCE, ISOTHERM_HEAD
 *   and, where they apply, ISOTHERM_VERDICT, ISOTHERM_DOOR (what the door did after "allow"),
 *   ISOTHERM_REASON, ISOTHERM_SCORE, ISOTHERM_THRESHOLD, ISOTHERM_FRAMES,
 *   ISOTHERM_ATTACK_FRAMES, ISOTHERM_SENSOR
 *
 * A thread sends the entries, because the journal may be stuck and the log must not wait for it.
 * Entries wait in a queue of ISO_JOURNAL_ENTRIES. An entry that finds no place is not sent; the
 * next one that finds a place has the number of those entries (ISOTHERM_UNSENT). The audit log has
 * all of them.
 *
 * ISOTHERM_HEAD is the head of the log after the record (audit.h). With a journal that is kept
 * elsewhere, an old log that was put back can be detected. */
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

/* Sends the queued entries, but waits for at most a second; then frees the journal, or leaves that
 * to a thread that is stuck. NULL is accepted. */
void iso_journal_free(struct iso_journal *journal);

/* For iso_audit_options.written, with the journal as its context: queues an entry without
 * waiting. */
void iso_journal_record(void *journal, const struct iso_audit_record *record, uint64_t sequence,
                        const char *head);

enum { ISO_JOURNAL_FIELDS_MAX = 15, ISO_JOURNAL_FIELD_SIZE = 192 };

/* Writes the fields of a record as texts "NAME=value": the message, its priority, and the fields
 * above. Returns their number. */
size_t iso_journal_fields(const struct iso_audit_record *record, uint64_t sequence,
                          const char *head,
                          char fields[ISO_JOURNAL_FIELDS_MAX][ISO_JOURNAL_FIELD_SIZE]);

#endif
