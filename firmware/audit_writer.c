#include "firmware/audit_writer.h"

#include <errno.h>
#include <inttypes.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "drivers/process/thread.h"
#include "firmware/stack_wipe.h"

/* All texts of the longest record together; the line of a longer one would not fit either. */
enum { TEXT_BYTES = 3072 };

struct slot {
    struct iso_audit_record record; /* its texts point into `text` */
    uint64_t ticket;
    bool awaited;        /* somebody waits for it, or did */
    bool cancelled;      /* nobody waits any more, and it shall not be written */
    uint64_t outcome_of; /* ticket of the awaited record of which it tells the outcome; 0: none */
    char text[TEXT_BYTES];
};

struct iso_audit_writer {
    const struct iso_times *times;
    bool threaded;
    pthread_t thread;
    pthread_mutex_t log_mutex; /* of the log; after `mutex` is let go, as it is held for long */
    struct iso_audit *audit;
    pthread_mutex_t mutex; /* of what follows; nobody holds it while the disk works */
    pthread_cond_t changed;
    bool ending;
    size_t group;          /* so many slots, from the first on, are being written */
    uint64_t queued, done; /* tickets: the last that was given, the last that is finished */
    uint64_t last;         /* sequence of the last record of the log */
    uint64_t appended;     /* ticket of the record that was appended last; 0: it found no room */
    struct {
        uint64_t ticket, sequence; /* sequence 0: it was not written */
        int error;
        struct iso_fault fault;
    } awaited;                  /* what became of the awaited record that was finished last */
    uint64_t lost, lost_behind; /* how many, and the last ticket before the first of them */
    uint64_t lost_tried;        /* how many were to be admitted at the last try */
    bool finished;              /* a posted record, since the result was taken */
    int error;                  /* of the newest one that is lost since then; 0: none is */
    struct iso_fault fault;
    size_t first, n;
    struct slot slots[ISO_AUDIT_WRITER_RECORDS]; /* a ring */
    struct {
        uint64_t lost; /* how many it admits; 0: the group begins with a record */
        struct iso_audit_record record;
        char note[64];
    } admission;
    struct iso_audit_entry entries[1 + ISO_AUDIT_WRITER_RECORDS]; /* of the group */
    size_t n_entries;
};

/* ---- slots ---- */

/* Copies a text behind those that are there already; NULL stays NULL. False: no room. */
static bool keep_text(struct slot *slot, size_t *used, const char **text)
{
    if (!*text) {
        return true;
    }
    const size_t size = strlen(*text) + 1;
    if (size > sizeof slot->text - *used) {
        return false;
    }
    char *copy = memcpy(slot->text + *used, *text, size);
    *used += size;
    *text = copy;
    return true;
}

static bool fill(struct slot *slot, const struct iso_audit_record *record)
{
    struct iso_audit_record *own = &slot->record;
    size_t used = 0;
    *own = *record;
    const char **texts[] = {&own->event,  &own->person, &own->verdict, &own->reason,
                            &own->note,   &own->sensor, &own->door,    &own->door_fault,
                            &own->before, &own->after,  &own->gallery};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        if (!keep_text(slot, &used, texts[i])) {
            return false;
        }
    }
    return true;
}

/* Names do not stay in memory. */
static void wipe(struct slot *slot)
{
    explicit_bzero(slot, sizeof *slot);
}

static void stamp(const struct iso_audit_writer *writer, struct iso_audit_record *record)
{
    record->wall_ns = iso_times_wall_ns(writer->times);
    record->monotonic_ns = iso_times_now_ns(writer->times);
}

/* ---- the queue; the mutex is held ---- */

/* The slot with i others before it. */
static struct slot *slot_at(struct iso_audit_writer *writer, size_t i)
{
    return &writer->slots[(writer->first + i) % ISO_AUDIT_WRITER_RECORDS];
}

static void lose(struct iso_audit_writer *writer, int error, const struct iso_fault *fault)
{
    if (writer->lost++ == 0) {
        writer->lost_behind = writer->queued;
    }
    writer->finished = true;
    writer->error = error;
    writer->fault = *fault;
}

/* How many places have to be free. The last one is for the outcome of an awaited record, and the
 * one before it for the awaited record. */
enum { PLACES_TO_TELL_OUTCOME = 1, PLACES_TO_APPEND, PLACES_TO_POST };

/* A slot for a record, filled in, if there are so many places free. */
static int enqueue(struct iso_audit_writer *writer, const struct iso_audit_record *record,
                   size_t places, struct slot **out, struct iso_fault *fault)
{
    if (ISO_AUDIT_WRITER_RECORDS - writer->n < places) {
        return iso_fault_set(fault, -ENOBUFS,
                             "the log's queue is full: %zu records wait for the disk", writer->n);
    }
    struct slot *slot = slot_at(writer, writer->n);
    if (!fill(slot, record)) {
        wipe(slot);
        return iso_fault_set(fault, -EINVAL, "the log: the record is too long");
    }
    stamp(writer, &slot->record);
    slot->ticket = ++writer->queued;
    writer->n++;
    (void)pthread_cond_broadcast(&writer->changed);
    *out = slot;
    return 0;
}

/* ---- writing ---- */

/* Whether it is time to put losses on record: in the place where the first of them would have
 * stood, once, and again with each later record as long as the log cannot be written. */
static bool has_to_admit(const struct iso_audit_writer *writer)
{
    return writer->lost > 0 && writer->done >= writer->lost_behind &&
           (writer->n > 0 || writer->lost != writer->lost_tried);
}

/* The record of the losses. */
static void begin_admission(struct iso_audit_writer *writer)
{
    struct iso_audit_record *record = &writer->admission.record;
    const uint64_t lost = writer->lost;
    (void)snprintf(writer->admission.note, sizeof writer->admission.note, "%" PRIu64 " %s", lost,
                   lost == 1 ? "record" : "records");
    *record = iso_audit_record_of("records-lost");
    record->note = writer->admission.note;
    stamp(writer, record);
    writer->admission.lost = lost;
    writer->lost_tried = lost;
    writer->entries[writer->n_entries++].record = record;
}

static void end_admission(struct iso_audit_writer *writer, const struct iso_audit_entry *entry)
{
    if (!entry->error) {
        writer->lost -= writer->admission.lost; /* others may have been lost meanwhile */
        writer->lost_behind = writer->queued;
    }
}

static void note_awaited(struct iso_audit_writer *writer, const struct slot *slot,
                         const struct iso_audit_entry *entry)
{
    writer->awaited.ticket = slot->ticket;
    writer->awaited.sequence = entry ? entry->sequence : 0;
    writer->awaited.error = entry ? entry->error : -ECANCELED;
    writer->awaited.fault = entry ? entry->fault : (struct iso_fault){""};
}

/* Takes a record into the group. One that was cancelled is not written; an outcome of one that was
 * queued before it knows that by now: the two are never in one group, unless that was cancelled. */
static void begin_slot(struct iso_audit_writer *writer, struct slot *slot)
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

/* Takes everything that is queued; but losses that have to be admitted between two records end the
 * group there. */
static void begin_group(struct iso_audit_writer *writer)
{
    writer->n_entries = 0;
    writer->group = 0;
    writer->admission.lost = 0;
    if (has_to_admit(writer)) {
        begin_admission(writer);
    }
    const uint64_t end = writer->lost > 0 && writer->done < writer->lost_behind
                             ? writer->lost_behind
                             : UINT64_MAX;
    while (writer->group < writer->n && slot_at(writer, writer->group)->ticket <= end) {
        begin_slot(writer, slot_at(writer, writer->group++));
    }
}

/* Takes the first record out of the queue; entry is NULL for one that was cancelled. */
static void end_slot(struct iso_audit_writer *writer, const struct iso_audit_entry *entry)
{
    struct slot *slot = slot_at(writer, 0);
    if (entry && slot->awaited) {
        note_awaited(writer, slot, entry);
    } else if (entry && entry->error) {
        lose(writer, entry->error, &entry->fault);
    } else if (entry) {
        writer->finished = true;
    }
    writer->done = slot->ticket;
    wipe(slot);
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
        end_slot(writer, slot_at(writer, 0)->cancelled ? NULL : entry++);
        writer->group--;
    }
    (void)pthread_cond_broadcast(&writer->changed);
}

/* Writes a group; the mutex is held before and after, and not meanwhile. */
static void write_group(struct iso_audit_writer *writer)
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

static void *run(void *context)
{
    struct iso_audit_writer *writer = context;
    (void)pthread_mutex_lock(&writer->mutex);
    while (writer->n > 0 || !writer->ending || has_to_admit(writer)) {
        if (writer->n > 0 || has_to_admit(writer)) {
            write_group(writer);
            iso_stack_wipe(); /* records may have named somebody */
        } else {
            (void)pthread_cond_wait(&writer->changed, &writer->mutex);
        }
    }
    (void)pthread_mutex_unlock(&writer->mutex);
    return NULL;
}

/* Without a thread: whoever has queued a record writes it. */
static int write_now(struct iso_audit_writer *writer, struct iso_fault *fault)
{
    write_group(writer);
    const struct iso_audit_entry *own = &writer->entries[writer->n_entries - 1];
    return own->error ? iso_fault_set(fault, own->error, "%s", own->fault.text) : 0;
}

/* ---- new and free ---- */

int iso_audit_writer_new(struct iso_audit *audit, const struct iso_times *times, bool threaded,
                         struct iso_audit_writer **out)
{
    struct iso_audit_writer *writer = calloc(1, sizeof *writer);
    pthread_condattr_t attributes;
    if (!writer) {
        return -ENOMEM;
    }
    writer->audit = audit;
    writer->times = times;
    writer->threaded = threaded;
    writer->last = iso_audit_last(audit);
    iso_thread_mutex_init(&writer->mutex);
    (void)pthread_mutex_init(&writer->log_mutex, NULL);
    (void)pthread_condattr_init(&attributes);
    (void)pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
    (void)pthread_cond_init(&writer->changed, &attributes);
    (void)pthread_condattr_destroy(&attributes);
    const int error = threaded ? iso_thread_start(&writer->thread, run, writer) : 0;
    if (error) {
        writer->threaded = false;
        iso_audit_writer_free(writer);
        return error;
    }
    *out = writer;
    return 0;
}

void iso_audit_writer_free(struct iso_audit_writer *writer)
{
    if (!writer) {
        return;
    }
    if (writer->threaded) {
        (void)pthread_mutex_lock(&writer->mutex);
        writer->ending = true;
        (void)pthread_cond_broadcast(&writer->changed);
        (void)pthread_mutex_unlock(&writer->mutex);
        (void)pthread_join(writer->thread, NULL);
    }
    (void)pthread_cond_destroy(&writer->changed);
    (void)pthread_mutex_destroy(&writer->mutex);
    (void)pthread_mutex_destroy(&writer->log_mutex);
    explicit_bzero(writer, sizeof *writer);
    free(writer);
}

/* ---- posting and appending ---- */

static int post(struct iso_audit_writer *writer, const struct iso_audit_record *record,
                bool outcome, struct iso_fault *fault)
{
    struct iso_fault own = {""};
    struct slot *slot = NULL;
    (void)pthread_mutex_lock(&writer->mutex);
    int error = enqueue(writer, record, outcome ? PLACES_TO_TELL_OUTCOME : PLACES_TO_POST, &slot,
                        &own);
    if (error) {
        lose(writer, error, &own);
    } else {
        slot->outcome_of = outcome ? writer->appended : 0;
        error = writer->threaded ? 0 : write_now(writer, &own);
    }
    (void)pthread_mutex_unlock(&writer->mutex);
    return error ? iso_fault_set(fault, error, "%s", own.text) : 0;
}

int iso_audit_writer_post(struct iso_audit_writer *writer, const struct iso_audit_record *record,
                          struct iso_fault *fault)
{
    return post(writer, record, false, fault);
}

int iso_audit_writer_post_outcome(struct iso_audit_writer *writer,
                                  const struct iso_audit_record *record, struct iso_fault *fault)
{
    return post(writer, record, true, fault);
}

/* Waits until the record with this ticket is finished, or until wait_ns are over. */
static bool wait_for(struct iso_audit_writer *writer, uint64_t ticket, int64_t wait_ns)
{
    struct timespec until = {0};
    int error = 0;
    if (wait_ns != ISO_NEVER_NS) {
        (void)clock_gettime(CLOCK_MONOTONIC, &until);
        const int64_t end_ns = until.tv_nsec + wait_ns % ISO_NS_PER_S;
        until.tv_sec += (time_t)(wait_ns / ISO_NS_PER_S + end_ns / ISO_NS_PER_S);
        until.tv_nsec = (long)(end_ns % ISO_NS_PER_S);
    }
    while (writer->done < ticket && error != ETIMEDOUT) {
        error = wait_ns == ISO_NEVER_NS
                    ? pthread_cond_wait(&writer->changed, &writer->mutex)
                    : pthread_cond_timedwait(&writer->changed, &writer->mutex, &until);
    }
    return writer->done >= ticket;
}

/* Nobody waits for this record any more: it is not written, unless its group is being written. */
static void give_up(struct iso_audit_writer *writer, uint64_t ticket)
{
    for (size_t i = writer->group; i < writer->n; i++) {
        struct slot *slot = slot_at(writer, i);
        slot->cancelled = slot->cancelled || slot->ticket == ticket;
    }
}

static int append(struct iso_audit_writer *writer, const struct iso_audit_record *record,
                  int64_t wait_ns, struct iso_fault *fault)
{
    struct slot *slot = NULL;
    writer->appended = 0;
    const int error = enqueue(writer, record, PLACES_TO_APPEND, &slot, fault);
    if (error) {
        return error;
    }
    const uint64_t ticket = writer->appended = slot->ticket;
    slot->awaited = true;
    if (!writer->threaded) {
        return write_now(writer, fault);
    }
    if (!wait_for(writer, ticket, wait_ns)) {
        give_up(writer, ticket);
        return iso_fault_set(fault, -ETIMEDOUT, "the record did not get to the disk within %d ms",
                             (int)(wait_ns / ISO_NS_PER_MS));
    }
    return writer->awaited.error
               ? iso_fault_set(fault, writer->awaited.error, "%s", writer->awaited.fault.text)
               : 0;
}

int iso_audit_writer_append(struct iso_audit_writer *writer, const struct iso_audit_record *record,
                            int64_t wait_ns, uint64_t *sequence, struct iso_fault *fault)
{
    (void)pthread_mutex_lock(&writer->mutex);
    const int error = append(writer, record, wait_ns, fault);
    if (!error && sequence) {
        *sequence = writer->awaited.sequence;
    }
    (void)pthread_mutex_unlock(&writer->mutex);
    return error;
}

/* ---- what is known ---- */

uint64_t iso_audit_writer_last(struct iso_audit_writer *writer)
{
    (void)pthread_mutex_lock(&writer->mutex);
    const uint64_t last = writer->last;
    (void)pthread_mutex_unlock(&writer->mutex);
    return last;
}

bool iso_audit_writer_take_result(struct iso_audit_writer *writer, int *error,
                                  struct iso_fault *fault)
{
    (void)pthread_mutex_lock(&writer->mutex);
    const bool finished = writer->finished;
    if (finished) {
        *error = writer->error;
        *fault = writer->fault;
        writer->finished = false;
        writer->error = 0;
    }
    (void)pthread_mutex_unlock(&writer->mutex);
    return finished;
}

struct iso_audit *iso_audit_writer_hold(struct iso_audit_writer *writer)
{
    (void)pthread_mutex_lock(&writer->mutex);
    (void)wait_for(writer, writer->queued, ISO_NEVER_NS);
    (void)pthread_mutex_unlock(&writer->mutex);
    (void)pthread_mutex_lock(&writer->log_mutex);
    return writer->audit;
}

void iso_audit_writer_release(struct iso_audit_writer *writer)
{
    (void)pthread_mutex_lock(&writer->mutex);
    writer->last = iso_audit_last(writer->audit);
    (void)pthread_mutex_unlock(&writer->mutex);
    (void)pthread_mutex_unlock(&writer->log_mutex);
}
