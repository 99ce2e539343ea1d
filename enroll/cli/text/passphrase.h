/* The passphrase of a file of exported people. The client asks for it and derives a key from it;
 * the daemon only gets the key. */
#ifndef CLI_TEXT_PASSPHRASE_H
#define CLI_TEXT_PASSPHRASE_H

#include <stdbool.h>
#include <stdint.h>

#include "enroll/cli/client/fault.h"

enum { CLI_KEY_BYTES = 32, CLI_SALT_BYTES = 16 };

/* Reads a passphrase and derives a key from it by Argon2id, which takes about a second. The
 * passphrase is the first line of `file`. If `file` is NULL, it is asked for at the terminal
 * without echo, twice if `fresh`; if standard input is not a terminal, its next line is read. A
 * fresh passphrase must have at least 12 bytes. CLI_EXIT_USAGE if the passphrase is empty, too
 * short, too long, or not the same twice; CLI_EXIT_NOT_FOUND if there is no such file;
 * CLI_EXIT_FAULT. */
enum cli_exit cli_passphrase_key(const char *file, bool fresh, const uint8_t salt[CLI_SALT_BYTES],
                                 uint8_t key[CLI_KEY_BYTES], struct cli_fault *fault)
    __attribute__((warn_unused_result));

#endif
