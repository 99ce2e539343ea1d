/* What to do about a fault, by its code. */
#ifndef CLI_REMEDY_H
#define CLI_REMEDY_H

#include "core/base/fault_code.h"

/* One line that says how to correct the fault, a constant. NULL outside the range and for
 * ISO_FAULT_NONE. */
const char *cli_remedy(enum iso_fault_code code);

#endif
