/* The code of a fault at the end of a line for the system's log: "TEXT [disk-full]". */
#ifndef ISO_FIRMWARE_CONTRACT_FAULT_TAG_H
#define ISO_FIRMWARE_CONTRACT_FAULT_TAG_H

#include "core/base/fault_code.h"

enum { ISO_FAULT_TAG_SIZE = 32 };

/* Writes " [NAME]", or nothing for ISO_FAULT_NONE. Returns the tag. */
const char *iso_fault_tag(enum iso_fault_code code, char tag[ISO_FAULT_TAG_SIZE]);

/* The name of a code as it is on the bus: "" for ISO_FAULT_NONE. A constant. */
const char *iso_fault_word(enum iso_fault_code code);

#endif
