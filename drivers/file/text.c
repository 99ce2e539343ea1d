#include "drivers/file/text.h"

#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/file/file.h"

int iso_text_read(const char *path, size_t max_bytes, char **text, struct iso_fault *fault)
{
    char *bytes = NULL;
    size_t size = 0;
    const int error = iso_file_read(path, max_bytes, &bytes, &size, fault);
    if (!error && memchr(bytes, 0, size)) {
        free(bytes);
        return iso_fault_set(fault, -EBADMSG, "%s: not a text file (it holds a NUL byte)", path);
    }
    if (!error) {
        *text = bytes;
    }
    return error;
}

void iso_text_copy_end(const char *text, char *to, size_t size)
{
    const size_t length = strlen(text);
    const bool fits = length < size;
    (void)snprintf(to, size, "%s%s", fits ? "" : "...", fits ? text : text + length - (size - 4));
}

int iso_text_find_long_line(const char *text, size_t max_bytes)
{
    int line = 1;
    for (const char *end; *text; text = *end ? end + 1 : end, line++) {
        end = strchrnul(text, '\n');
        if ((size_t)(end - text) > max_bytes) {
            return line;
        }
    }
    return 0;
}

void iso_text_print_number(FILE *stream, const char *key, double value)
{
    char text[32];
    for (int digits = 15; digits <= 17; digits++) {
        (void)snprintf(text, sizeof text, "%.*g", digits, value);
        if (strtod(text, NULL) == value) {
            break;
        }
    }
    (void)fprintf(stream, "%s = %s\n", key, text);
}
