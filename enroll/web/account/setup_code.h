/* The one-time code with which the first administrator gets an account. Root makes
 * the code by the command `isotherm web setup` and gives it to the administrator. The file contains
 * only the hash of the code and the time at which it ends. A new code replaces the old one. If all
 * passwords are forgotten, a new code gives a further account. */
#ifndef WEB_ACCOUNT_SETUP_CODE_H
#define WEB_ACCOUNT_SETUP_CODE_H

#include <stdbool.h>
#include <stdint.h>

#include "core/base/fault.h"

enum {
    WEB_SETUP_CODE_SIZE = 20 + 3 + 1, /* four groups of five characters, with the NUL */
    WEB_SETUP_CODE_VALID_S = 24 * 3600,
};

/* Makes a code of 100 random bits, "ABCDE-FGHJK-MNPQR-STVWX", that is valid for a day from now_s on
 * (seconds since 1970), and writes the file `path`. Errors of web_state_file_write. */
int web_setup_code_make(const char *path, int64_t now_s, char code[WEB_SETUP_CODE_SIZE],
                        struct iso_fault *fault) __attribute__((warn_unused_result));

/* Whether a code is waiting in the file and has not ended. */
bool web_setup_code_waits(const char *path, int64_t now_s);

/* Whether this is the code that is waiting. Does not use it up. */
bool web_setup_code_is(const char *path, int64_t now_s, const char *code);

/* Uses the code up. Small letters, blanks and hyphens do not matter. Returns 0 after the file has
 * been removed; -EACCES: the code is wrong, has ended, or there is none; or the error of removing
 * the file. Only 0 allows an account. */
int web_setup_code_use(const char *path, int64_t now_s, const char *code, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
