/* Threads that stand by to share a batch of tasks (core/base/tasks.h) with the thread that has it.
 *
 * Whoever calls works along as worker 0, the others take tasks as long as there are some. A helper
 * that the machine has no time for is not waited for unless it holds a task that is run; if that is
 * raced for and takes longer than the caller needed for its longest, the caller does it once more.
 * So on a busy machine two threads are no slower than one. To be woken takes some 50 us: helpers
 * get up when a batch is expected, and who helped looks out for the next for some 60 us before it
 * sleeps. The processor of who expects a batch is its own: helpers are sent to the others, and
 * where the kernel may not be told so, one that finds itself there sleeps on. Their threads block
 * all signals. */
#ifndef ISO_FIRMWARE_RECOGNISE_CREW_H
#define ISO_FIRMWARE_RECOGNISE_CREW_H

#include "core/base/tasks.h"

enum { ISO_CREW_MAX = 16 };

struct iso_crew;

/* A crew of 1..ISO_CREW_MAX, the caller included: starts one thread less. -EINVAL, -ENOMEM, -EAGAIN
 * if threads cannot be started. */
int iso_crew_new(int n_workers, struct iso_crew **out) __attribute__((warn_unused_result));
/* Ends the threads; no batch may be running. */
void iso_crew_free(struct iso_crew *crew);

/* What core is handed; valid as long as the crew. Batches come from one thread at a time. */
const struct iso_tasks *iso_crew_tasks(const struct iso_crew *crew);

#endif
