/* Counts every allocation of the process: those of the program, and those of its shared libraries,
 * because the linker resolves their allocator to this one. It needs glibc, and it does not work
 * with a sanitizer, which has its own allocator. */
#ifndef TESTS_SUPPORT_MEMORY_COUNTED_MEMORY_H
#define TESTS_SUPPORT_MEMORY_COUNTED_MEMORY_H

/* The number of allocations so far, of all threads. Calls of free() are not counted. */
unsigned long counted_memory(void);

#endif
