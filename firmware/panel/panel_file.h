/* Stores what an access panel has set over OSDP: the base key of the secure channel (SCBK), the
 * address and the speed.
 *
 *   ISOPANL1 | number of the key u32 | sealed: address u8, baud u32, configured address u8,
 *   configured baud u32, has_key u8, key[16]
 *
 * The file is sealed with a key of the use ISO_KEY_PANEL. Address and speed of the file hold as
 * long as the configuration is the one under which the panel has set them; so a changed
 * configuration has an effect. An older copy of the file has an older key, which the panel refuses;
 * it does not let anybody in, and is not looked for. */
#ifndef ISO_FIRMWARE_PANEL_PANEL_FILE_H
#define ISO_FIRMWARE_PANEL_PANEL_FILE_H

#include <stddef.h>

#include "drivers/door/osdp/osdp_peripheral.h"
#include "firmware/keys/key_ring.h"

enum { ISO_PANEL_PLAIN_BYTES = 1 + 4 + 1 + 4 + 1 + ISO_OSDP_KEY_BYTES };

struct iso_panel_file {
    struct iso_osdp_saved saved;
    uint8_t configured_address;
    uint32_t configured_baud;
};

/* Reads the file. `ring` must be one whose keys of this use belong to the calling thread. The
 * caller wipes *out. -ENOENT there is none (the fault is unchanged then), -EBADMSG it is damaged or
 * sealed with another key, or an errno of reading the file. */
int iso_panel_file_load(const char *path, const struct iso_key_ring *ring,
                        struct iso_panel_file *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Replaces the file; it is on the disk when this returns 0. `key` has the number `number`. The
 * errors of iso_sealed_file_write. */
int iso_panel_file_save(const char *path, const struct iso_seal_key *key, uint32_t number,
                        const struct iso_panel_file *file, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Reads and writes the bytes that are sealed. get: -EBADMSG for a size or for values that are not
 * possible. */
void iso_panel_file_put(const struct iso_panel_file *file, uint8_t plain[ISO_PANEL_PLAIN_BYTES]);
int iso_panel_file_get(const uint8_t *plain, size_t size, struct iso_panel_file *out)
    __attribute__((warn_unused_result));

#endif
