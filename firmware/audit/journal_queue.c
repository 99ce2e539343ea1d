/* The thread that sends entries to the system's journal, and its queue. */
#include <errno.h>
#include <inttypes.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "drivers/process/thread.h"
#include "firmware/audit/journal.h"

static const int wait_at_end_s = 1;

/* One more field than a record has, for ISOTHERM_UNSENT. */
struct entry {
    size_t n;
    char fields[ISO_JOURNAL_FIELDS_MAX + 1][ISO_JOURNAL_FIELD_SIZE];
};

struct iso_journal {
    iso_journal_send *send;
    pthread_t thread;
    pthread_mutex_t mutex; /* protects all members below; not held while an entry is sent */
    pthread_cond_t changed;
    bool ending;
    bool abandoned;  /* the thread frees the journal when its call returns */
    bool ended;      /* the thread has ended */
    uint64_t unsent; /* entries lost since the last one that was queued */
    size_t first, n;
    struct entry entries[ISO_JOURNAL_ENTRIES]; /* a ring buffer */
};

static void release(struct iso_journal *journal)
{
    (void)pthread_cond_destroy(&journal->changed);
    (void)pthread_mutex_destroy(&journal->mutex);
    free(journal);
}

static void send_entry(iso_journal_send *send, const struct entry *entry)
{
    struct iovec vectors[ISO_JOURNAL_FIELDS_MAX + 1];
    for (size_t i = 0; i < entry->n; i++) {
        const char *field = entry->fields[i];
        vectors[i] = (struct iovec){(void *)(uintptr_t)field, strlen(field)};
    }
    (void)send(vectors, (int)entry->n);
}

/* Sends the oldest entry. The mutex is held on entry and on return, but not while the entry is
 * sent. */
static void send_first(struct iso_journal *journal)
{
    const struct entry entry = journal->entries[journal->first];
    journal->first = (journal->first + 1) % ISO_JOURNAL_ENTRIES;
    journal->n--;
    (void)pthread_mutex_unlock(&journal->mutex);
    send_entry(journal->send, &entry);
    (void)pthread_mutex_lock(&journal->mutex);
}

static void *run(void *context)
{
    struct iso_journal *journal = context;
    iso_thread_set_name("isothermd-jrnl");
    (void)pthread_mutex_lock(&journal->mutex);
    while (!journal->abandoned && (journal->n > 0 || !journal->ending)) {
        if (journal->n > 0) {
            send_first(journal);
        } else {
            (void)pthread_cond_wait(&journal->changed, &journal->mutex);
        }
    }
    journal->ended = true;
    const bool abandoned = journal->abandoned;
    (void)pthread_cond_broadcast(&journal->changed);
    (void)pthread_mutex_unlock(&journal->mutex);
    if (abandoned) {
        release(journal);
    }
    return NULL;
}

int iso_journal_new(iso_journal_send *send, struct iso_journal **out)
{
    struct iso_journal *journal = calloc(1, sizeof *journal);
    pthread_condattr_t attributes;
    if (!journal) {
        return -ENOMEM;
    }
    journal->send = send;
    iso_thread_mutex_init(&journal->mutex);
    (void)pthread_condattr_init(&attributes);
    (void)pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
    (void)pthread_cond_init(&journal->changed, &attributes);
    (void)pthread_condattr_destroy(&attributes);
    const int error = iso_thread_start(&journal->thread, run, journal);
    if (error) {
        release(journal);
        return error;
    }
    *out = journal;
    return 0;
}

void iso_journal_free(struct iso_journal *journal)
{
    struct timespec until;
    int error = 0;
    if (!journal) {
        return;
    }
    (void)clock_gettime(CLOCK_MONOTONIC, &until);
    until.tv_sec += wait_at_end_s;
    (void)pthread_mutex_lock(&journal->mutex);
    journal->ending = true;
    (void)pthread_cond_broadcast(&journal->changed);
    while (!journal->ended && error == 0) {
        error = pthread_cond_timedwait(&journal->changed, &journal->mutex, &until);
    }
    const bool ended = journal->ended;
    const pthread_t thread = journal->thread;
    journal->abandoned = !ended;
    (void)pthread_mutex_unlock(&journal->mutex);
    if (ended) {
        (void)pthread_join(thread, NULL);
        release(journal);
    } else {
        (void)pthread_detach(thread);
    }
}

/* Returns a free place for an entry; NULL if there is none. */
static struct entry *place(struct iso_journal *journal)
{
    return journal->n < ISO_JOURNAL_ENTRIES
               ? &journal->entries[(journal->first + journal->n) % ISO_JOURNAL_ENTRIES]
               : NULL;
}

void iso_journal_record(void *context, const struct iso_audit_record *record, uint64_t sequence,
                        const char *head)
{
    struct iso_journal *journal = context;
    (void)pthread_mutex_lock(&journal->mutex);
    struct entry *entry = place(journal);
    if (entry) {
        entry->n = iso_journal_fields(record, sequence, head, entry->fields);
        if (journal->unsent > 0) {
            (void)snprintf(entry->fields[entry->n++], ISO_JOURNAL_FIELD_SIZE,
                           "ISOTHERM_UNSENT=%" PRIu64, journal->unsent);
        }
        journal->unsent = 0;
        journal->n++;
        (void)pthread_cond_broadcast(&journal->changed);
    } else {
        journal->unsent++;
    }
    (void)pthread_mutex_unlock(&journal->mutex);
}
