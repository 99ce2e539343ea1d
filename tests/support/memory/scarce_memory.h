/* Memory that runs out: the Nth allocation of a test program fails. The linker replaces the
 * allocators in all statically linked code by these (isotherm_scarce_memory() in CMake). */
#ifndef TESTS_SUPPORT_MEMORY_SCARCE_MEMORY_H
#define TESTS_SUPPORT_MEMORY_SCARCE_MEMORY_H

#include "core/base/fault.h"

/* The number of allocations that succeed before one fails; negative: none fails. */
extern long scarce_memory_left;

/* Calls `action` again and again, and lets first the first allocation fail, then the second, and so
 * on, until none fails any more. `action` must return -ENOMEM with the fault "out of memory" each
 * time, and 0 at last. Returns the number of failures, which is below `most`. */
int scarce_memory_exhaust(int (*action)(void *context, struct iso_fault *fault), void *context,
                          int most);

#endif
