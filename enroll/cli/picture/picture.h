/* One picture of what the camera sees, for its installation. */
#ifndef CLI_PICTURE_PICTURE_H
#define CLI_PICTURE_PICTURE_H

#include <stddef.h>
#include <stdint.h>

#include "enroll/cli/client/daemon.h"

/* Claims the camera, asks for a picture, and releases the camera. Meanwhile the door admits nobody.
 * *png is a whole PNG file in memory, which the caller frees with free(). Faults of
 * cli_daemon_send(), and "bad-reply". */
enum cli_exit cli_picture_take(struct cli_daemon *daemon, uint8_t **png, size_t *size,
                               struct cli_fault *fault) __attribute__((warn_unused_result));

/* Writes a PNG to a file that only its owner can read. A regular file that could not be written
 * completely is removed. CLI_EXIT_NOT_FOUND or CLI_EXIT_FAULT "file". */
enum cli_exit cli_picture_save(const char *path, const uint8_t *png, size_t size,
                               struct cli_fault *fault) __attribute__((warn_unused_result));

#endif
