#include "firmware/settings/settings_file.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/bytes.h"
#include "drivers/file/data_file.h"
#include "drivers/file/directory.h"
#include "drivers/file/storage_fault.h"

static const char magic[8] = {'I', 'S', 'O', 'S', 'E', 'T', 'S', '1'};

enum {
    HEAD_BYTES = sizeof magic + 4,
    FILE_MAX_BYTES = HEAD_BYTES + (int)ISO_SETTINGS_PLAIN_MAX + (int)ISO_SEAL_OVERHEAD,
};

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

static struct iso_seal_label label_of(uint32_t key)
{
    struct iso_seal_label label = iso_seal_label_of("isotherm settings 1");
    iso_seal_label_number(&label, key);
    return label;
}

static int open_sealed(const uint8_t *bytes, size_t size, const struct iso_key_ring *ring,
                       struct iso_settings_file *out)
{
    uint8_t plain[ISO_SETTINGS_PLAIN_MAX];
    if (size < HEAD_BYTES + ISO_SEAL_OVERHEAD || size > FILE_MAX_BYTES ||
        memcmp(bytes, magic, sizeof magic) != 0) {
        return -EBADMSG;
    }
    const uint32_t number = iso_get_u32(bytes + sizeof magic);
    const struct iso_seal_key *key = iso_key_ring_find(ring, ISO_KEY_ANCHOR, number);
    const struct iso_seal_label label = label_of(number);
    const size_t sealed = size - HEAD_BYTES;
    if (!key || iso_seal_open(key, &label, bytes + HEAD_BYTES, sealed, plain)) {
        return -EBADMSG;
    }
    return iso_settings_get(plain, sealed - ISO_SEAL_OVERHEAD, out);
}

int iso_settings_file_read(const char *path, const struct iso_key_ring *ring,
                           struct iso_settings_file *out, struct iso_fault *fault)
{
    struct iso_fault why = {.text = ""};
    void *bytes = NULL;
    size_t size = 0;
    int error = iso_data_file_read(path, FILE_MAX_BYTES, &bytes, &size, &why);
    if (error) {
        return error == -ENOENT ? error
                                : iso_fault_set_code(fault, why.code, error, "%s", why.text);
    }
    error = open_sealed(bytes, size, ring, out);
    free(bytes);
    return error ? iso_fault_set(fault, error, "%s: damaged", path) : 0;
}

/* Writes the bytes of the file, which may have been written in spite of an error. */
static int replace(const char *path, const uint8_t *bytes, size_t size, struct iso_fault *fault)
{
    struct iso_fault why = {.text = ""};
    const int error = iso_data_file_replace(path, bytes, size, &why);
    if (error && iso_data_file_holds(path, bytes, size)) {
        return iso_directory_sync(path, fault);
    }
    if (iso_storage_is_refusal(error)) {
        return iso_storage_refused(path, error, fault);
    }
    return error ? iso_fault_set_code(fault, why.code, error, "%s: cannot be written: %s", path,
                                      why.text[0] ? why.text : strerror(-error))
                 : 0;
}

int iso_settings_file_write(const char *path, const struct iso_key_ring *ring,
                            struct iso_settings_file *file, struct iso_fault *fault)
{
    const uint32_t key = iso_key_ring_newest(ring, ISO_KEY_ANCHOR);
    const struct iso_seal_label label = label_of(key);
    uint8_t *plain = malloc(ISO_SETTINGS_PLAIN_MAX), *bytes = malloc(FILE_MAX_BYTES);
    int error = plain && bytes ? 0 : iso_fault_set(fault, -ENOMEM, "%s: out of memory", path);
    if (!error) {
        file->number++;
        const size_t n = iso_settings_put(file, plain);
        memcpy(bytes, magic, sizeof magic);
        (void)iso_put_u32(bytes + sizeof magic, key);
        iso_seal_close(iso_key_ring_find(ring, ISO_KEY_ANCHOR, key), &label, plain, n,
                       bytes + HEAD_BYTES);
        error = replace(path, bytes, HEAD_BYTES + n + ISO_SEAL_OVERHEAD, fault);
        file->number -= error ? 1 : 0;
    }
    free(plain);
    free(bytes);
    return error;
}
