/* A file of an update gets into the folder of the hub. The file is a bundle of RAUC in the format
 * "verity": behind the contents come a CMS message (RFC 5652), which embeds the manifest, and its
 * length in 8 bytes, the highest first. The hub reads version and board from the manifest. It does
 * not check the signature, because it does not have the certificate of the image; each door does
 * before it installs the file. */
#ifndef ISO_ENROLL_HUB_UPDATE_UPDATE_KEEP_H
#define ISO_ENROLL_HUB_UPDATE_UPDATE_KEEP_H

#include "enroll/hub/update/hub_update.h"

/* Reads the manifest. Pure but for the file. -EBADMSG it is no such bundle, or it names no version
 * or board; -EFBIG it is larger than ISO_FLEET_UPDATE_BYTES_MAX; the errors of iso_file_open(). */
int hub_update_read(const char *path, char version[ISO_FLEET_UPDATE_WORD_SIZE],
                    char board[ISO_FLEET_UPDATE_WORD_SIZE], struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Copies the file into the folder and stores its row. Errors of hub_update_read() and of
 * hub_update_add(), -ENOSPC, -EIO and others of writing. */
int hub_update_keep(struct hub_store *store, const char *path, struct hub_update_file *out,
                    struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
