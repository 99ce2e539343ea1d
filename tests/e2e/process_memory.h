/* Reads the memory of another process and searches it for bytes. */
#ifndef TEST_PROCESS_MEMORY_H
#define TEST_PROCESS_MEMORY_H

#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

/* One area of the memory, as a line of /proc/PID/maps describes it. */
struct process_memory_area {
    char line[128];
    size_t offset, size; /* its bytes in struct process_memory */
};

struct process_memory {
    unsigned char *bytes; /* of all areas that the process may write, one after the other */
    size_t size;
    struct process_memory_area *areas;
    size_t n_areas;
};

/* Reads the memory of a child process while it is stopped (SIGSTOP). Returns false if this user may
 * not read it: the daemon is not dumpable, so only root may. Any other failure fails the test. */
bool process_memory_read(pid_t pid, struct process_memory *out);
void process_memory_free(struct process_memory *memory);

/* Returns the number of places that have these bytes. Prints for each place its area, its offset in
 * the area and the text around it, if `print` is true. */
int process_memory_count(const struct process_memory *memory, const void *bytes, size_t size,
                         bool print);

#endif
