#include "enroll/cli/arguments/wrap.h"

#include <string.h>

void cli_wrap(const char *text, int column, FILE *out)
{
    int at = column;

    while (*text) {
        const int length = (int)strcspn(text, " ");
        if (at > column && at + 1 + length > CLI_WRAP_COLUMNS) {
            fprintf(out, "\n%*s", column, "");
            at = column;
        }
        at += fprintf(out, "%s%.*s", at > column ? " " : "", length, text);
        text += length;
        text += strspn(text, " ");
    }
    fputc('\n', out);
}
