/* The state of a writer of the audit log, and how it writes a group. Internal to audit_writer.c and
 * audit_group.c. */
#ifndef ISO_FIRMWARE_AUDIT_AUDIT_WRITER_STATE_H
#define ISO_FIRMWARE_AUDIT_AUDIT_WRITER_STATE_H

#include <pthread.h>
#include <semaphore.h>

#include "firmware/audit/audit_writer.h"

/* The length of all texts of the longest record. The line of a longer record would not fit
 * either. */
enum { ISO__AUDIT_WRITER_TEXT_BYTES = 3072 };

struct iso__audit_slot {
    struct iso_audit_record record; /* its texts point into `text` */
    uint64_t ticket;
    bool awaited;        /* a caller waits or has waited for this record */
    bool cancelled;      /* no caller waits any more, and the record must not be written */
    uint64_t outcome_of; /* ticket of the awaited record whose outcome this is; 0: none */
    char text[ISO__AUDIT_WRITER_TEXT_BYTES];
};

struct iso_audit_writer {
    const struct iso_times *times;
    bool threaded;
    pthread_t thread;
    pthread_mutex_t log_mutex; /* protects the log; held for long, so `mutex` is released before */
    struct iso_audit *audit;
    pthread_mutex_t mutex;        /* protects all members below; not held while the disk works */
    sem_t work;                   /* the thread has something to do; see audit_writer.c */
    pthread_cond_t finished_some; /* signalled by the thread only, and never with the mutex held */
    bool ending;
    size_t group;          /* number of slots, from the first on, that are being written */
    uint64_t queued, done; /* tickets: the last one given, the last one finished */
    uint64_t last;         /* sequence of the last record of the log */
    uint64_t appended;     /* ticket of the record that was appended last; 0: there was no room */
    struct {
        uint64_t ticket, sequence; /* sequence 0: it was not written */
        int error;
        struct iso_fault fault;
    } awaited;                  /* the result of the awaited record that was finished last */
    uint64_t lost, lost_behind; /* number of losses; the last ticket before the first of them */
    uint64_t lost_tried;        /* the number of losses at the last attempt to record them */
    bool finished;              /* a posted record was finished since the result was taken */
    int error; /* of the newest record that was lost since then; 0: none was lost */
    struct iso_fault fault;
    size_t first, n;
    struct iso__audit_slot slots[ISO_AUDIT_WRITER_RECORDS]; /* a ring buffer */
    struct {
        uint64_t lost; /* how many losses the group's first record reports; 0: none */
        struct iso_audit_record record;
        char note[64];
    } admission;
    struct iso_audit_entry entries[1 + ISO_AUDIT_WRITER_RECORDS]; /* the records of the group */
    size_t n_entries;
};

/* The slot with i others before it. */
struct iso__audit_slot *iso__audit_writer_slot(struct iso_audit_writer *writer, size_t i);

/* Sets the time in a record. */
void iso__audit_writer_stamp(const struct iso_audit_writer *writer,
                             struct iso_audit_record *record);

/* Wipes a slot, so that no names stay in memory. */
void iso__audit_writer_wipe(struct iso__audit_slot *slot);

/* Counts a record that is lost; the mutex is held. */
void iso__audit_writer_lose(struct iso_audit_writer *writer, int error,
                            const struct iso_fault *fault);

/* Whether losses have to be recorded now: as soon as the records before the first loss are written,
 * and after a failure with each later record. The mutex is held. */
bool iso__audit_writer_has_to_admit(const struct iso_audit_writer *writer);

/* Writes everything that is queued as a group. The mutex is held on entry and on return, but not
 * meanwhile. The caller has to wake the threads that wait for a record. (audit_group.c) */
void iso__audit_writer_write(struct iso_audit_writer *writer);

#endif
