#include "enroll/screen/fingerprint.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/file/file.h"

/* Whether these characters, all of them, are of a fingerprint. */
static bool is_fingerprint(const char *text, size_t size)
{
    return size > 0 && size < SCREEN_FINGERPRINT_SIZE && strspn(text, "0123456789ABCDEF:") == size;
}

static void read_file(const char *path, char text[SCREEN_FINGERPRINT_SIZE])
{
    struct iso_fault fault;
    char *bytes = NULL;
    size_t size = 0;

    *text = '\0';
    /* One byte more for the end of the line. */
    if (iso_file_read(path, SCREEN_FINGERPRINT_SIZE, &bytes, &size, &fault)) {
        return;
    }
    if (size > 0 && bytes[size - 1] == '\n') {
        bytes[--size] = '\0';
    }
    if (is_fingerprint(bytes, size)) {
        memcpy(text, bytes, size + 1);
    }
    free(bytes);
}

const char *screen_fingerprint_look(struct screen_fingerprint *fingerprint, const char *path,
                                    int64_t now_ns)
{
    if (*path && now_ns >= fingerprint->next_ns) {
        read_file(path, fingerprint->text);
        fingerprint->next_ns = now_ns + SCREEN_FINGERPRINT_NS;
    }
    return fingerprint->text;
}
