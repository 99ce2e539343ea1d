/* What to do about a fault, by its code. */
#ifndef CLI_REMEDY_H
#define CLI_REMEDY_H

#include "core/base/fault_code.h"

/* One line for people that says how the fault is mended. NULL for ISO_FAULT_NONE, of which nothing
 * more is known than its sentence, and outside the range. A constant. */
const char *cli_remedy(enum iso_fault_code code);

#endif
