/* Functions that fill in a fault (isotherm/fault.h), which is the one description of a failure in
 * the whole project. Functions that read input from outside (files, configuration, devices) fill it
 * in and also return a negative errno. The member `code` is one of enum iso_fault_code. */
#ifndef ISO_CORE_BASE_FAULT_H
#define ISO_CORE_BASE_FAULT_H

#include "core/base/fault_code.h"
#include "isotherm/fault.h"

/* Writes the text if fault is not NULL; a text that is too long is cut. Returns `error` (a negative
 * errno), so that a caller can `return iso_fault_set(fault, -EBADMSG, "%s: truncated", path);`. The
 * code becomes ISO_FAULT_OUT_OF_MEMORY for -ENOMEM, which always means the same, and ISO_FAULT_NONE
 * for all other errors. */
int iso_fault_set(struct iso_fault *fault, int error, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* The same with a code. A function that quotes the text of another fault passes the code of that
 * fault on as well: iso_fault_set_code(fault, why.code, error, "%s: %s", owner, why.text). */
int iso_fault_set_code(struct iso_fault *fault, enum iso_fault_code code, int error,
                       const char *format, ...) __attribute__((format(printf, 4, 5)));

/* Replaces the code of a fault that another function has described, and returns `error`. Does
 * nothing if fault is NULL. For a caller that knows more than the function that it called. */
int iso_fault_recode(struct iso_fault *fault, enum iso_fault_code code, int error);

/* The same only if the fault has no code yet. */
int iso_fault_code_default(struct iso_fault *fault, enum iso_fault_code code, int error);

#endif
