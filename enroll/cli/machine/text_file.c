#include "enroll/cli/machine/text_file.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "drivers/file/file.h"
#include "drivers/file/text.h"

enum { LARGEST_BYTES = 1024 * 1024 };

char *cli_text_file_read(const char *path, struct iso_fault *why)
{
    char *text = NULL;
    const int error = iso_text_read(path, LARGEST_BYTES, &text, why);
    if (error) {
        errno = -error;
        return NULL;
    }
    return text;
}

void cli_text_file_line(const char *path, char *out, size_t size)
{
    FILE *file = NULL;

    out[0] = '\0';
    if (iso_file_stream(path, ISO_FILE_ANY_SIZE, &file, NULL) == 0) {
        const size_t n = fread(out, 1, size - 1, file);
        out[n] = '\0';
        out[strcspn(out, "\n")] = '\0';
        fclose(file);
    }
}
