#include "core/base/fault.h"

#include <stdarg.h>
#include <stdio.h>

int iso_fault_set(struct iso_fault *fault, int error, const char *format, ...)
{
    if (fault) {
        va_list arguments;
        va_start(arguments, format);
        (void)vsnprintf(fault->text, sizeof fault->text, format, arguments);
        va_end(arguments);
    }
    return error;
}
