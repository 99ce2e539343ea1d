/* Stores the settings that were changed while the daemon ran, so that they survive a restart.
 *
 *   ISOSETS1 | number of the key u32 | sealed: number of the file u64, count u32, and for each
 *   setting section, key and value, each as its length u8 and its bytes
 *
 * The file is sealed with the anchors' key, so only a program that has the key ring can write a
 * valid one: who can write the disk cannot lower a threshold. Each write increases the number of
 * the file, and the daemon puts that number on record at every start. A file of this appliance of
 * an earlier time can be put back, as the configuration file can; the record shows it. A write
 * creates a new file in the same directory and renames it. */
#ifndef ISO_FIRMWARE_SETTINGS_SETTINGS_FILE_H
#define ISO_FIRMWARE_SETTINGS_SETTINGS_FILE_H

#include "core/base/fault.h"
#include "firmware/keys/key_ring.h"
#include "firmware/settings/live_keys.h"

enum {
    ISO_SETTING_NAME_SIZE = 32, /* of a section or a key, with the NUL */
    ISO_SETTINGS_PLAIN_MAX = 12 + ISO_LIVE_KEYS_MAX * 3 * ISO_SETTING_NAME_SIZE,
};

struct iso_stored_setting {
    char section[ISO_SETTING_NAME_SIZE], key[ISO_SETTING_NAME_SIZE], value[ISO_LIVE_VALUE_SIZE];
};

struct iso_settings_file {
    uint64_t number; /* 0: there is no file */
    size_t n;
    struct iso_stored_setting items[ISO_LIVE_KEYS_MAX];
};

/* Reads the file. After an error *out is unchanged: -ENOENT there is none (the fault is unchanged
 * then), -EBADMSG it is damaged or sealed with a key that is not in the ring, or an errno of
 * reading it. */
int iso_settings_file_read(const char *path, const struct iso_key_ring *ring,
                           struct iso_settings_file *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Writes the file with the next number, and increases file->number. The file is on the disk when
 * this returns 0. An error of storage_fault.h: then the file has the old contents, or the new ones
 * without being synchronised, and file->number is unchanged. */
int iso_settings_file_write(const char *path, const struct iso_key_ring *ring,
                            struct iso_settings_file *file, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Writes the bytes that are sealed; returns their number. */
size_t iso_settings_put(const struct iso_settings_file *file,
                        uint8_t plain[ISO_SETTINGS_PLAIN_MAX]);

/* Reads these bytes. -EBADMSG, with *out unchanged: they are cut short or too long, a length is not
 * possible, a text has a NUL, or two settings have the same key. */
int iso_settings_get(const uint8_t *plain, size_t size, struct iso_settings_file *out)
    __attribute__((warn_unused_result));

#endif
