#include "enroll/screen/fingerprint.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/file/file.h"

/* Whether all of these characters are allowed. */
static bool is_allowed(const char *text, size_t size, const char *allowed)
{
    return size > 0 && size < SCREEN_FINGERPRINT_SIZE && strspn(text, allowed) == size;
}

static void read_file(const char *path, const char *allowed, char text[SCREEN_FINGERPRINT_SIZE])
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
    if (is_allowed(bytes, size, allowed)) {
        memcpy(text, bytes, size + 1);
    }
    free(bytes);
}

static const char *look(struct screen_fingerprint *file, const char *path, const char *allowed,
                        int64_t now_ns)
{
    if (*path && now_ns >= file->next_ns) {
        read_file(path, allowed, file->text);
        file->next_ns = now_ns + SCREEN_FINGERPRINT_NS;
    }
    return file->text;
}

const char *screen_fingerprint_look(struct screen_fingerprint *fingerprint, const char *path,
                                    int64_t now_ns)
{
    return look(fingerprint, path, "0123456789ABCDEF:", now_ns);
}

const char *screen_setup_code_look(struct screen_fingerprint *code, const char *path,
                                   int64_t now_ns)
{
    return look(code, path, "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZ-", now_ns);
}
