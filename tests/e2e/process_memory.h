/* The memory of another process, searched for bytes. */
#ifndef TEST_PROCESS_MEMORY_H
#define TEST_PROCESS_MEMORY_H

#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

struct process_memory {
    unsigned char *bytes; /* of everything that the process may write, one area after the other */
    size_t size;
};

/* Reads it while the process stands still (SIGSTOP). False if this user may not: the daemon is not
 * dumpable, so that only root can. Anything else that goes wrong fails the test. */
bool process_memory_read(pid_t pid, struct process_memory *out);
void process_memory_free(struct process_memory *memory);

/* How often the bytes stand there. */
int process_memory_count(const struct process_memory *memory, const void *bytes, size_t size);

#endif
