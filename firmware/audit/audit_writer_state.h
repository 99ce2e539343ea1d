/* What a writer of the audit log holds, and how it writes a group. Internal to
 * audit_writer.c and audit_group.c. */
#ifndef ISO_FIRMWARE_AUDIT_AUDIT_WRITER_STATE_H
#define ISO_FIRMWARE_AUDIT_AUDIT_WRITER_STATE_H

#include <pthread.h>
#include <semaphore.h>

#include "firmware/audit/audit_writer.h"

/* All texts of the longest record together; the line of a longer one would not fit either. */
enum { ISO__AUDIT_WRITER_TEXT_BYTES = 3072 };

struct iso__audit_slot {
    struct iso_audit_record record; /* its texts point into `text` */
    uint64_t ticket;
    bool awaited;        /* somebody waits for it, or did */
    bool cancelled;      /* nobody waits any more, and it shall not be written */
    uint64_t outcome_of; /* ticket of the awaited record of which it tells the outcome; 0: none */
    char text[ISO__AUDIT_WRITER_TEXT_BYTES];
};

struct iso_audit_writer {
    const struct iso_times *times;
    bool threaded;
    pthread_t thread;
    pthread_mutex_t log_mutex; /* of the log; after `mutex` is let go, as it is held for long */
    struct iso_audit *audit;
    pthread_mutex_t mutex;        /* of what follows; nobody holds it while the disk works */
    sem_t work;                   /* there is something to do for the thread; see audit_writer.c */
    pthread_cond_t finished_some; /* only the thread says so, and never with the mutex held */
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
    struct iso__audit_slot slots[ISO_AUDIT_WRITER_RECORDS]; /* a ring */
    struct {
        uint64_t lost; /* how many it admits; 0: the group begins with a record */
        struct iso_audit_record record;
        char note[64];
    } admission;
    struct iso_audit_entry entries[1 + ISO_AUDIT_WRITER_RECORDS]; /* of the group */
    size_t n_entries;
};

/* The slot with i others before it. */
struct iso__audit_slot *iso__audit_writer_slot(struct iso_audit_writer *writer, size_t i);

/* Has a record say when it happened. */
void iso__audit_writer_stamp(const struct iso_audit_writer *writer,
                             struct iso_audit_record *record);

/* Names do not stay in memory. */
void iso__audit_writer_wipe(struct iso__audit_slot *slot);

/* Counts a record that is lost; the mutex is held. */
void iso__audit_writer_lose(struct iso_audit_writer *writer, int error,
                            const struct iso_fault *fault);

/* Whether it is time to put losses on record: in the place where the first of them would have
 * stood, once, and again with each later record as long as the log cannot be written. The mutex is
 * held. */
bool iso__audit_writer_has_to_admit(const struct iso_audit_writer *writer);

/* Writes everything that is queued as a group; the mutex is held before and after, and not
 * meanwhile. Whoever waits for a record has to be told. (audit_group.c) */
void iso__audit_writer_write(struct iso_audit_writer *writer);

#endif
