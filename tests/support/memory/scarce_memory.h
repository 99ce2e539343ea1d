/* Memory that runs out: the Nth allocation of a test program fails. The linker puts it before the
 * allocators of everything that is linked statically (isotherm_scarce_memory() in CMake). */
#ifndef TESTS_SUPPORT_MEMORY_SCARCE_MEMORY_H
#define TESTS_SUPPORT_MEMORY_SCARCE_MEMORY_H

#include "core/base/fault.h"

/* How many allocations succeed until one fails; negative: none fails. */
extern long scarce_memory_left;

/* Calls `action` with the first, second, ... allocation failing, until none fails any more. Each
 * time it has to return -ENOMEM with a fault that says so, and 0 at last. Returns how many failed,
 * which is below `most`. */
int scarce_memory_exhaust(int (*action)(void *context, struct iso_fault *fault), void *context,
                          int most);

#endif
