#include "enroll/setup/text_file.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LARGEST_BYTES = 1024 * 1024 };

char *cli_text_file_read(const char *path)
{
    FILE *file = fopen(path, "re");
    char *text = file ? malloc(LARGEST_BYTES + 1) : NULL;
    int error = file && text ? 0 : errno;

    if (!error) {
        const size_t size = fread(text, 1, LARGEST_BYTES, file);
        text[size] = '\0';
        error = ferror(file)            ? errno
                : size == LARGEST_BYTES ? EFBIG
                : strlen(text) < size   ? EBADMSG
                                        : 0;
    }
    if (file) {
        fclose(file);
    }
    if (error) {
        free(text);
        errno = error;
        return NULL;
    }
    return text;
}

void cli_text_file_line(const char *path, char *out, size_t size)
{
    FILE *file = fopen(path, "re");

    out[0] = '\0';
    if (file) {
        const size_t n = fread(out, 1, size - 1, file);
        out[n] = '\0';
        out[strcspn(out, "\n")] = '\0';
        fclose(file);
    }
}
