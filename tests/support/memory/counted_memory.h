/* Counts every allocation of the process: this program's, and those of the shared libraries that it
 * uses, whose allocator the linker finds here. For glibc; a sanitizer has an allocator of its own,
 * and counting does not go with it. */
#ifndef TESTS_SUPPORT_MEMORY_COUNTED_MEMORY_H
#define TESTS_SUPPORT_MEMORY_COUNTED_MEMORY_H

/* Allocations so far, of all threads; freeing does not count. */
unsigned long counted_memory(void);

#endif
