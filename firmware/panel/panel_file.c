#include "firmware/panel/panel_file.h"

#include <errno.h>
#include <string.h>

#include "core/base/bytes.h"
#include "firmware/keys/sealed_file.h"

static const struct iso_sealed_file kind = {.magic = "ISOPANL1",
                                            .kind = "isotherm panel 1",
                                            .use = ISO_KEY_PANEL,
                                            .plain_min = ISO_PANEL_PLAIN_BYTES,
                                            .plain_max = ISO_PANEL_PLAIN_BYTES};

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

int iso_panel_file_load(const char *path, const struct iso_key_ring *ring,
                        struct iso_panel_file *out, struct iso_fault *fault)
{
    uint8_t plain[ISO_PANEL_PLAIN_BYTES];
    size_t size = 0;
    int error = iso_sealed_file_read(path, &kind, ring, plain, &size, fault);
    error = error ? error : iso_panel_file_get(plain, size, out);
    explicit_bzero(plain, sizeof plain);
    return error == -EBADMSG ? iso_fault_set_code(fault, ISO_FAULT_PANEL_KEY, error,
                                                  "%s: damaged, or sealed with another key", path)
                             : error;
}

int iso_panel_file_save(const char *path, const struct iso_seal_key *key, uint32_t number,
                        const struct iso_panel_file *file, struct iso_fault *fault)
{
    uint8_t plain[ISO_PANEL_PLAIN_BYTES];
    iso_panel_file_put(file, plain);
    const int error = iso_sealed_file_write(path, &kind, key, number, plain, sizeof plain, fault);
    explicit_bzero(plain, sizeof plain);
    return error;
}
