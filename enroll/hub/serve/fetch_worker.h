/* Answers FETCHes in threads of their own, each with a connection of its own to the database: a
 * snapshot of a large zone takes longer than the event loop may wait. The answers are files in
 * memory; a part of an update is read from the file that the hub keeps. */
#ifndef HUB_SERVE_FETCH_WORKER_H
#define HUB_SERVE_FETCH_WORKER_H

#include <stdint.h>
#include <systemd/sd-event.h>

#include "enroll/hub/answer/hub_answer.h"

enum {
    HUB_FETCH_THREADS = 2,
    HUB_FETCH_WAITING_MOST = 64, /* fetches that are not answered */
};

struct hub_fetch_result {
    int error; /* 0, or that of hub_answer_fetch() or hub_answer_update(), with its fault */
    struct iso_fault fault;
    enum hub_fetch_answer what; /* not of an update */
    int fd;                     /* whoever is called owns it; -1 after an error */
    uint64_t offset;            /* where the answer begins in it */
    uint64_t size;
    double seconds; /* that the answer has taken */
};

struct hub_fetch;

/* Starts the threads. `options` has to live longer. Errors of hub_store_open(), of the threads and
 * of the event loop. */
int hub_fetch_new(sd_event *event, const struct hub_store_options *options, struct hub_fetch **out,
                  struct iso_fault *fault) __attribute__((warn_unused_result));

/* Waits for the answers that are being made, and gives up those that wait: `done` is called for
 * all of them, with -ECANCELED for the latter. NULL is accepted. */
void hub_fetch_free(struct hub_fetch *fetch);

/* Answers a FETCH, which is copied. `done` is called by the event loop. -EBUSY there are too many,
 * -ENOMEM; `done` is not called then. */
int hub_fetch_ask(struct hub_fetch *fetch, const void *bytes, size_t size,
                  void (*done)(void *context, const struct hub_fetch_result *result), void *context)
    __attribute__((warn_unused_result));

#endif
