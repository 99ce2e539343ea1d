/* Reads the memory of another process and searches it for bytes. */
#ifndef TEST_PROCESS_MEMORY_H
#define TEST_PROCESS_MEMORY_H

#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

struct process_memory {
    unsigned char *bytes; /* of all areas that the process may write, one after the other */
    size_t size;
};

/* Reads the memory of a child process while it is stopped (SIGSTOP). Returns false if this user may
 * not read it: the daemon is not dumpable, so only root may. Any other failure fails the test. */
bool process_memory_read(pid_t pid, struct process_memory *out);
void process_memory_free(struct process_memory *memory);

/* Returns the number of places that have these bytes. */
int process_memory_count(const struct process_memory *memory, const void *bytes, size_t size);

#endif
