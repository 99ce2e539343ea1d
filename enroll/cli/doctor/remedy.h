/* What to do about a fault, by its code. */
#ifndef CLI_REMEDY_H
#define CLI_REMEDY_H

#include "core/base/fault_code.h"

/* One line that says how to correct the fault. NULL outside the range, and for ISO_FAULT_NONE, a
 * fault of which only the sentence is known. A constant. */
const char *cli_remedy(enum iso_fault_code code);

#endif
