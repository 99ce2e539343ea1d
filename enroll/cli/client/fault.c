#include "enroll/cli/client/fault.h"

#include <stdarg.h>
#include <stdio.h>

enum cli_exit cli_fault_set(struct cli_fault *fault, enum cli_exit exit, const char *code,
                            const char *format, ...)
{
    va_list arguments;

    (void)snprintf(fault->code, sizeof fault->code, "%s", code);
    va_start(arguments, format);
    (void)vsnprintf(fault->text, sizeof fault->text, format, arguments);
    va_end(arguments);
    return exit;
}
