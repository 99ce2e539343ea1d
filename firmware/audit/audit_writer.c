#include "firmware/audit/audit_writer.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "drivers/file/disk_wait.h"
#include "drivers/process/thread.h"
#include "firmware/audit/audit_writer_state.h"
#include "firmware/keys/stack_wipe.h"

/* ---- slots ---- */

/* Copies a text behind the texts that are there already. NULL stays NULL. Returns false if there is
 * no room. */
static bool keep_text(struct iso__audit_slot *slot, size_t *used, const char **text)
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

static bool fill_slot(struct iso__audit_slot *slot, const struct iso_audit_record *record)
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

/* ---- the queue; the mutex is held ---- */

/* The number of places that have to be free. The last place is reserved for the outcome of an
 * awaited record, and the one before it for the awaited record itself. */
enum { PLACES_TO_TELL_OUTCOME = 1, PLACES_TO_APPEND, PLACES_TO_POST };

/* Fills in a slot for a record if that many places are free. */
static int enqueue_record(struct iso_audit_writer *writer, const struct iso_audit_record *record,
                          size_t places, struct iso__audit_slot **out, struct iso_fault *fault)
{
    if (ISO_AUDIT_WRITER_RECORDS - writer->n < places) {
        return iso_fault_set_code(fault, ISO_FAULT_LOG_LATE, -ENOBUFS,
                                  "the log's queue is full: %zu records wait for the disk",
                                  writer->n);
    }
    struct iso__audit_slot *slot = iso__audit_writer_slot(writer, writer->n);
    if (!fill_slot(slot, record)) {
        iso__audit_writer_wipe(slot);
        return iso_fault_set(fault, -EINVAL, "the log: the record is too long");
    }
    iso__audit_writer_stamp(writer, &slot->record);
    slot->ticket = ++writer->queued;
    writer->n++;
    (void)sem_post(&writer->work);
    *out = slot;
    return 0;
}

/* ---- the thread ----
 *
 * The door's thread, which has a real-time priority, wakes this thread. It uses a semaphore,
 * because sem_post(3) never waits. pthread_cond_broadcast(3) of glibc 2.36 can wait until a thread
 * that was woken before has run, if another one has begun to wait since then. This thread has an
 * ordinary priority, so on a busy machine the door would have to wait until this thread gets a
 * processor. */

/* Waits for work, and takes all posts of the semaphore. The caller looks at the whole queue, so no
 * post is missed. */
static void wait_for_work(struct iso_audit_writer *writer)
{
    (void)pthread_mutex_unlock(&writer->mutex);
    while (sem_wait(&writer->work) && errno == EINTR) {
    }
    while (sem_trywait(&writer->work) == 0) {
    }
    (void)pthread_mutex_lock(&writer->mutex);
}

static void *run_writer(void *context)
{
    struct iso_audit_writer *writer = context;
    iso_thread_set_name("isothermd-log");
    (void)pthread_mutex_lock(&writer->mutex);
    while (writer->n > 0 || !writer->ending || iso__audit_writer_has_to_admit(writer)) {
        if (writer->n > 0 || iso__audit_writer_has_to_admit(writer)) {
            iso__audit_writer_write(writer);
            (void)pthread_mutex_unlock(&writer->mutex);
            (void)pthread_cond_broadcast(&writer->finished_some);
            iso_stack_wipe(); /* the records may have contained names */
            (void)pthread_mutex_lock(&writer->mutex);
        } else {
            wait_for_work(writer);
        }
    }
    (void)pthread_mutex_unlock(&writer->mutex);
    return NULL;
}

/* Without a thread, the caller that has queued a record writes it. */
static int write_now(struct iso_audit_writer *writer, struct iso_fault *fault)
{
    iso__audit_writer_write(writer);
    const struct iso_audit_entry *own = &writer->entries[writer->n_entries - 1];
    return own->error
               ? iso_fault_set_code(fault, own->fault.code, own->error, "%s", own->fault.text)
               : 0;
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
    (void)sem_init(&writer->work, 0, 0);
    (void)pthread_cond_init(&writer->finished_some, &attributes);
    (void)pthread_condattr_destroy(&attributes);
    const int error = threaded ? iso_thread_start(&writer->thread, run_writer, writer) : 0;
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
        (void)pthread_mutex_unlock(&writer->mutex);
        (void)sem_post(&writer->work);
        iso_disk_wait_begin();
        (void)pthread_join(writer->thread, NULL);
        iso_disk_wait_end();
    }
    (void)sem_destroy(&writer->work);
    (void)pthread_cond_destroy(&writer->finished_some);
    (void)pthread_mutex_destroy(&writer->mutex);
    (void)pthread_mutex_destroy(&writer->log_mutex);
    explicit_bzero(writer, sizeof *writer);
    free(writer);
}

/* ---- posting and appending ---- */

static int post_record(struct iso_audit_writer *writer, const struct iso_audit_record *record,
                       bool outcome, struct iso_fault *fault)
{
    struct iso_fault own = {.text = ""};
    struct iso__audit_slot *slot = NULL;
    (void)pthread_mutex_lock(&writer->mutex);
    int error = enqueue_record(writer, record, outcome ? PLACES_TO_TELL_OUTCOME : PLACES_TO_POST,
                               &slot, &own);
    if (error) {
        iso__audit_writer_lose(writer, error, &own);
    } else {
        slot->outcome_of = outcome ? writer->appended : 0;
        error = writer->threaded ? 0 : write_now(writer, &own);
    }
    (void)pthread_mutex_unlock(&writer->mutex);
    return error ? iso_fault_set_code(fault, own.code, error, "%s", own.text) : 0;
}

int iso_audit_writer_post(struct iso_audit_writer *writer, const struct iso_audit_record *record,
                          struct iso_fault *fault)
{
    return post_record(writer, record, false, fault);
}

int iso_audit_writer_post_outcome(struct iso_audit_writer *writer,
                                  const struct iso_audit_record *record, struct iso_fault *fault)
{
    return post_record(writer, record, true, fault);
}

/* Waits until the record with this ticket is finished, or for at most wait_ns. */
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
    iso_disk_wait_begin();
    while (writer->done < ticket && error != ETIMEDOUT) {
        error = wait_ns == ISO_NEVER_NS
                    ? pthread_cond_wait(&writer->finished_some, &writer->mutex)
                    : pthread_cond_timedwait(&writer->finished_some, &writer->mutex, &until);
    }
    iso_disk_wait_end();
    return writer->done >= ticket;
}

/* The caller has stopped waiting for this record. The record is not written, unless its group is
 * being written already. */
static void give_up(struct iso_audit_writer *writer, uint64_t ticket)
{
    for (size_t i = writer->group; i < writer->n; i++) {
        struct iso__audit_slot *slot = iso__audit_writer_slot(writer, i);
        slot->cancelled = slot->cancelled || slot->ticket == ticket;
    }
}

static int append_group(struct iso_audit_writer *writer, const struct iso_audit_record *record,
                        int64_t wait_ns, struct iso_fault *fault)
{
    struct iso__audit_slot *slot = NULL;
    writer->appended = 0;
    const int error = enqueue_record(writer, record, PLACES_TO_APPEND, &slot, fault);
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
        return iso_fault_set_code(fault, ISO_FAULT_LOG_LATE, -ETIMEDOUT,
                                  "the record did not get to the disk within %d ms",
                                  (int)(wait_ns / ISO_NS_PER_MS));
    }
    return writer->awaited.error
               ? iso_fault_set_code(fault, writer->awaited.fault.code, writer->awaited.error, "%s",
                                    writer->awaited.fault.text)
               : 0;
}

int iso_audit_writer_append(struct iso_audit_writer *writer, const struct iso_audit_record *record,
                            int64_t wait_ns, uint64_t *sequence, struct iso_fault *fault)
{
    (void)pthread_mutex_lock(&writer->mutex);
    const int error = append_group(writer, record, wait_ns, fault);
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
    iso_disk_wait_begin();
    (void)pthread_mutex_lock(&writer->log_mutex);
    iso_disk_wait_end();
    return writer->audit;
}

void iso_audit_writer_release(struct iso_audit_writer *writer)
{
    (void)pthread_mutex_lock(&writer->mutex);
    writer->last = iso_audit_last(writer->audit);
    (void)pthread_mutex_unlock(&writer->mutex);
    (void)pthread_mutex_unlock(&writer->log_mutex);
}
