/* The file with the key of a card reader's secure channel (the SCBK of OSDP), which the key
 * [reader] osdp_key of the configuration names: one line of 32 hexadecimal digits. */
#ifndef ISO_FIRMWARE_DAEMON_READER_KEY_H
#define ISO_FIRMWARE_DAEMON_READER_KEY_H

#include <stdint.h>
#include <sys/types.h>

#include "core/base/fault.h"
#include "drivers/door/osdp/osdp_aes.h"

/* Reads the file. It must belong to `owner` (root, except in tests); its group may read it, so that
 * the daemon need not be root, and nobody else. The caller wipes `key`. -EPERM owner or mode are
 * wrong, -EBADMSG it is no such line, or a key that everyone knows (the default key, all bytes
 * equal); or the errors of iso_file_open. No fault quotes the content. */
int iso_reader_key_read(const char *path, uid_t owner, uint8_t key[ISO_OSDP_KEY_BYTES],
                        struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
