#include "firmware/panel/panel_file.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/bytes.h"
#include "drivers/file/data_file.h"

static const char magic[8] = {'I', 'S', 'O', 'P', 'A', 'N', 'L', '1'};

enum {
    HEAD_BYTES = sizeof magic + 4,
    FILE_BYTES = HEAD_BYTES + ISO_PANEL_PLAIN_BYTES + ISO_SEAL_OVERHEAD,
    FILE_MAX_BYTES = 4096,
};

void iso_panel_file_put(const struct iso_panel_file *file, uint8_t plain[ISO_PANEL_PLAIN_BYTES])
{
    uint8_t *p = plain;
    *p++ = file->saved.address;
    p = iso_put_u32(p, file->saved.baud);
    *p++ = file->configured_address;
    p = iso_put_u32(p, file->configured_baud);
    *p++ = file->saved.has_key;
    (void)iso_put_bytes(p, file->saved.key, sizeof file->saved.key);
}

int iso_panel_file_get(const uint8_t *plain, size_t size, struct iso_panel_file *out)
{
    if (size != ISO_PANEL_PLAIN_BYTES || plain[0] >= ISO_OSDP_BROADCAST ||
        !iso_osdp_is_baud(iso_get_u32(plain + 1)) || plain[5] >= ISO_OSDP_BROADCAST ||
        !iso_osdp_is_baud(iso_get_u32(plain + 6)) || plain[10] > 1) {
        return -EBADMSG;
    }
    out->saved.address = plain[0];
    out->saved.baud = iso_get_u32(plain + 1);
    out->configured_address = plain[5];
    out->configured_baud = iso_get_u32(plain + 6);
    out->saved.has_key = plain[10];
    memcpy(out->saved.key, plain + 11, sizeof out->saved.key);
    return 0;
}

static struct iso_seal_label label_of(uint32_t number)
{
    struct iso_seal_label label = iso_seal_label_of("isotherm panel 1");
    iso_seal_label_number(&label, number);
    return label;
}

static int open_sealed(const uint8_t *bytes, size_t size, const struct iso_key_ring *ring,
                       struct iso_panel_file *out)
{
    uint8_t plain[ISO_PANEL_PLAIN_BYTES];
    if (size != FILE_BYTES || memcmp(bytes, magic, sizeof magic) != 0) {
        return -EBADMSG;
    }
    const uint32_t number = iso_get_u32(bytes + sizeof magic);
    const struct iso_seal_key *key = iso_key_ring_find(ring, ISO_KEY_PANEL, number);
    const struct iso_seal_label label = label_of(number);
    if (!key || iso_seal_open(key, &label, bytes + HEAD_BYTES, size - HEAD_BYTES, plain)) {
        return -EBADMSG;
    }
    const int error = iso_panel_file_get(plain, sizeof plain, out);
    explicit_bzero(plain, sizeof plain);
    return error;
}

int iso_panel_file_load(const char *path, const struct iso_key_ring *ring,
                        struct iso_panel_file *out, struct iso_fault *fault)
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
    return error ? iso_fault_set_code(fault, ISO_FAULT_PANEL_KEY, error,
                                      "%s: damaged, or sealed with another key", path)
                 : 0;
}

int iso_panel_file_save(const char *path, const struct iso_seal_key *key, uint32_t number,
                        const struct iso_panel_file *file, struct iso_fault *fault)
{
    uint8_t plain[ISO_PANEL_PLAIN_BYTES], bytes[FILE_BYTES];
    const struct iso_seal_label label = label_of(number);
    iso_panel_file_put(file, plain);
    memcpy(bytes, magic, sizeof magic);
    (void)iso_put_u32(bytes + sizeof magic, number);
    iso_seal_close(key, &label, plain, sizeof plain, bytes + HEAD_BYTES);
    explicit_bzero(plain, sizeof plain);
    const int error = iso_data_file_replace(path, bytes, sizeof bytes, fault);
    /* An error that came after the new file was in its place is none for the panel. */
    return error && iso_data_file_holds(path, bytes, sizeof bytes) ? 0 : error;
}
