#include "firmware/settings/settings_file.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/bytes.h"
#include "firmware/keys/sealed_file.h"

static const struct iso_sealed_file kind = {.magic = "ISOSETS1",
                                            .kind = "isotherm settings 1",
                                            .use = ISO_KEY_ANCHOR,
                                            .plain_min = 0,
                                            .plain_max = ISO_SETTINGS_PLAIN_MAX};

_Static_assert((int)ISO_SETTINGS_PLAIN_MAX <= (int)ISO_SEALED_FILE_PLAIN_MAX, "it fits the file");

/* ---- the bytes that are sealed ---- */

static uint8_t *put_text(uint8_t *p, const char *text)
{
    uint8_t *length = p++;
    while (*text) {
        *p++ = (uint8_t)*text++;
    }
    *length = (uint8_t)(p - length - 1);
    return p;
}

size_t iso_settings_put(const struct iso_settings_file *file, uint8_t plain[ISO_SETTINGS_PLAIN_MAX])
{
    uint8_t *p = iso_put_u64(plain, file->number);
    p = iso_put_u32(p, (uint32_t)file->n);
    for (size_t i = 0; i < file->n; i++) {
        p = put_text(p, file->items[i].section);
        p = put_text(p, file->items[i].key);
        p = put_text(p, file->items[i].value);
    }
    return (size_t)(p - plain);
}

/* The bytes that are still to be read. */
struct rest {
    const uint8_t *p;
    size_t n;
};

/* Reads a text of 1 to 31 bytes. */
static bool get_text(struct rest *rest, char text[ISO_SETTING_NAME_SIZE])
{
    const size_t n = rest->n > 0 ? rest->p[0] : 0;
    if (n == 0 || n >= ISO_SETTING_NAME_SIZE || n >= rest->n || memchr(rest->p + 1, 0, n)) {
        return false;
    }
    memcpy(text, rest->p + 1, n);
    text[n] = '\0';
    rest->p += n + 1;
    rest->n -= n + 1;
    return true;
}

static bool is_repeated(const struct iso_settings_file *file, size_t index)
{
    const struct iso_stored_setting *one = &file->items[index];
    for (size_t i = 0; i < index; i++) {
        if (strcmp(file->items[i].section, one->section) == 0 &&
            strcmp(file->items[i].key, one->key) == 0) {
            return true;
        }
    }
    return false;
}

int iso_settings_get(const uint8_t *plain, size_t size, struct iso_settings_file *out)
{
    struct iso_settings_file file = {.number = 0};
    if (size < 12) {
        return -EBADMSG;
    }
    struct rest rest = {plain + 12, size - 12};
    file.number = iso_get_u64(plain);
    file.n = iso_get_u32(plain + 8);
    if (file.number == 0 || file.n > ISO_LIVE_KEYS_MAX) {
        return -EBADMSG;
    }
    for (size_t i = 0; i < file.n; i++) {
        struct iso_stored_setting *item = &file.items[i];
        if (!get_text(&rest, item->section) || !get_text(&rest, item->key) ||
            !get_text(&rest, item->value) || is_repeated(&file, i)) {
            return -EBADMSG;
        }
    }
    if (rest.n > 0) {
        return -EBADMSG;
    }
    *out = file;
    return 0;
}

_Static_assert((int)ISO_SETTING_NAME_SIZE == (int)ISO_LIVE_VALUE_SIZE,
               "names and values are read alike");

/* ---- the file ---- */

int iso_settings_file_read(const char *path, const struct iso_key_ring *ring,
                           struct iso_settings_file *out, struct iso_fault *fault)
{
    uint8_t plain[ISO_SETTINGS_PLAIN_MAX];
    size_t size = 0;
    int error = iso_sealed_file_read(path, &kind, ring, plain, &size, fault);
    error = error ? error : iso_settings_get(plain, size, out);
    return error == -EBADMSG ? iso_fault_set(fault, error, "%s: damaged", path) : error;
}

int iso_settings_file_write(const char *path, const struct iso_key_ring *ring,
                            struct iso_settings_file *file, struct iso_fault *fault)
{
    const uint32_t number = iso_key_ring_newest(ring, ISO_KEY_ANCHOR);
    uint8_t *plain = malloc(ISO_SETTINGS_PLAIN_MAX);
    if (!plain) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", path);
    }
    file->number++;
    const size_t n = iso_settings_put(file, plain);
    const int error = iso_sealed_file_write(
        path, &kind, iso_key_ring_find(ring, ISO_KEY_ANCHOR, number), number, plain, n, fault);
    file->number -= error ? 1 : 0;
    free(plain);
    return error;
}
