/* The passphrase of a file of exported people. The client asks for it and derives a key from it;
 * the daemon only gets the key. */
#ifndef CLI_TEXT_PASSPHRASE_H
#define CLI_TEXT_PASSPHRASE_H

#include <stdbool.h>
#include <stdint.h>

#include "enroll/cli/client/fault.h"

enum { CLI_KEY_BYTES = 32, CLI_SALT_BYTES = 16 };

/* Takes the first line of `file`, or (NULL) asks at the terminal without echo, twice if `fresh`, or
 * reads a line from stdin if that is none; and makes it into a key by Argon2id, which takes about a
 * second. A fresh one has at least 12 bytes. CLI_EXIT_USAGE it is empty, too short or not the same
 * twice; CLI_EXIT_NOT_FOUND, CLI_EXIT_FAULT. */
enum cli_exit cli_passphrase_key(const char *file, bool fresh, const uint8_t salt[CLI_SALT_BYTES],
                                 uint8_t key[CLI_KEY_BYTES], struct cli_fault *fault)
    __attribute__((warn_unused_result));

#endif
