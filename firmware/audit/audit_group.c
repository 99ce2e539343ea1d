/* A group of records: which records it takes from the queue, and how each of them ends. */
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "firmware/audit/audit_writer_state.h"

void iso__audit_writer_stamp(const struct iso_audit_writer *writer, struct iso_audit_record *record)
{
    if (record->wall_ns || record->monotonic_ns) {
        return; /* a record that already has a time keeps it */
    }
    record->wall_ns = iso_times_wall_ns(writer->times);
    record->monotonic_ns = iso_times_now_ns(writer->times);
}

void iso__audit_writer_wipe(struct iso__audit_slot *slot)
{
    explicit_bzero(slot, sizeof *slot);
}

struct iso__audit_slot *iso__audit_writer_slot(struct iso_audit_writer *writer, size_t i)
{
    return &writer->slots[(writer->first + i) % ISO_AUDIT_WRITER_RECORDS];
}

void iso__audit_writer_lose(struct iso_audit_writer *writer, int error,
                            const struct iso_fault *fault)
{
    if (writer->lost++ == 0) {
        writer->lost_behind = writer->queued;
    }
    writer->finished = true;
    writer->error = error;
    writer->fault = *fault;
}

bool iso__audit_writer_has_to_admit(const struct iso_audit_writer *writer)
{
    return writer->lost > 0 && writer->done >= writer->lost_behind &&
           (writer->n > 0 || writer->lost != writer->lost_tried);
}

/* Begins the group with a record of how many records were lost. */
static void begin_admission(struct iso_audit_writer *writer)
{
    struct iso_audit_record *record = &writer->admission.record;
    const uint64_t lost = writer->lost;
    (void)snprintf(writer->admission.note, sizeof writer->admission.note, "%" PRIu64 " %s", lost,
                   lost == 1 ? "record" : "records");
    *record = iso_audit_record_of("records-lost");
    record->note = writer->admission.note;
    iso__audit_writer_stamp(writer, record);
    writer->admission.lost = lost;
    writer->lost_tried = lost;
    writer->entries[writer->n_entries++].record = record;
}

static void end_admission(struct iso_audit_writer *writer, const struct iso_audit_entry *entry)
{
    if (!entry->error) {
        writer->lost -= writer->admission.lost; /* more records may have been lost since */
        writer->lost_behind = writer->queued;
    }
}

static void note_awaited(struct iso_audit_writer *writer, const struct iso__audit_slot *slot,
                         const struct iso_audit_entry *entry)
{
    writer->awaited.ticket = slot->ticket;
    writer->awaited.sequence = entry ? entry->sequence : 0;
    writer->awaited.error = entry ? entry->error : -ECANCELED;
    writer->awaited.fault = entry ? entry->fault : (struct iso_fault){.text = ""};
}

/* Takes a record into the group. A cancelled record is not written. An outcome and the record that
 * it belongs to are never in one group, unless that record was cancelled. So the outcome can say
 * whether the record was written. */
static void begin_slot(struct iso_audit_writer *writer, struct iso__audit_slot *slot)
{
    if (slot->outcome_of) {
        const bool known = slot->outcome_of == writer->awaited.ticket;
        slot->record.grant = known ? writer->awaited.sequence : 0;
    }
    if (slot->cancelled) {
        note_awaited(writer, slot, NULL);
    } else {
        writer->entries[writer->n_entries++].record = &slot->record;
    }
}

/* Takes all queued records. If a loss has to be recorded between two of them, the group ends
 * there. */
static void begin_group(struct iso_audit_writer *writer)
{
    writer->n_entries = 0;
    writer->group = 0;
    writer->admission.lost = 0;
    if (iso__audit_writer_has_to_admit(writer)) {
        begin_admission(writer);
    }
    const uint64_t end = writer->lost > 0 && writer->done < writer->lost_behind
                             ? writer->lost_behind
                             : UINT64_MAX;
    while (writer->group < writer->n &&
           iso__audit_writer_slot(writer, writer->group)->ticket <= end) {
        begin_slot(writer, iso__audit_writer_slot(writer, writer->group++));
    }
}

/* Removes the first record from the queue. `entry` is NULL if the record was cancelled. */
static void end_slot(struct iso_audit_writer *writer, const struct iso_audit_entry *entry)
{
    struct iso__audit_slot *slot = iso__audit_writer_slot(writer, 0);
    if (entry && slot->awaited) {
        note_awaited(writer, slot, entry);
    } else if (entry && entry->error) {
        iso__audit_writer_lose(writer, entry->error, &entry->fault);
    } else if (entry) {
        writer->finished = true;
    }
    writer->done = slot->ticket;
    iso__audit_writer_wipe(slot);
    writer->first = (writer->first + 1) % ISO_AUDIT_WRITER_RECORDS;
    writer->n--;
}

static void end_group(struct iso_audit_writer *writer)
{
    const struct iso_audit_entry *entry = writer->entries;
    if (writer->admission.lost > 0) {
        end_admission(writer, entry++);
    }
    while (writer->group > 0) {
        end_slot(writer, iso__audit_writer_slot(writer, 0)->cancelled ? NULL : entry++);
        writer->group--;
    }
}

void iso__audit_writer_write(struct iso_audit_writer *writer)
{
    begin_group(writer);
    (void)pthread_mutex_unlock(&writer->mutex);
    (void)pthread_mutex_lock(&writer->log_mutex);
    iso_audit_append_group(writer->audit, writer->entries, writer->n_entries);
    (void)pthread_mutex_lock(&writer->mutex);
    writer->last = iso_audit_last(writer->audit);
    (void)pthread_mutex_unlock(&writer->log_mutex);
    end_group(writer);
}
