#include "core/base/fault.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>

__attribute__((format(printf, 3, 0))) static void describe(struct iso_fault *fault,
                                                           enum iso_fault_code code,
                                                           const char *format, va_list arguments)
{
    if (fault) {
        (void)vsnprintf(fault->text, sizeof fault->text, format, arguments);
        fault->code = code;
    }
}

int iso_fault_set(struct iso_fault *fault, int error, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    describe(fault, error == -ENOMEM ? ISO_FAULT_OUT_OF_MEMORY : ISO_FAULT_NONE, format, arguments);
    va_end(arguments);
    return error;
}

int iso_fault_set_code(struct iso_fault *fault, enum iso_fault_code code, int error,
                       const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    describe(fault, code, format, arguments);
    va_end(arguments);
    return error;
}

int iso_fault_recode(struct iso_fault *fault, enum iso_fault_code code, int error)
{
    if (fault) {
        fault->code = code;
    }
    return error;
}

int iso_fault_code_default(struct iso_fault *fault, enum iso_fault_code code, int error)
{
    return fault && fault->code == ISO_FAULT_NONE ? iso_fault_recode(fault, code, error) : error;
}
