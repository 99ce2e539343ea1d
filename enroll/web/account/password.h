/* Passwords of the accounts, stored as argon2id (RFC 9106) by libsodium. One hash needs 19 MiB and
 * two passes: what OWASP recommends at least, and little enough for a small board; the memory is
 * given back at once. sodium_init() has to be called before. */
#ifndef WEB_ACCOUNT_PASSWORD_H
#define WEB_ACCOUNT_PASSWORD_H

#include <sodium.h>
#include <stdbool.h>

enum {
    WEB_PASSWORD_LEAST_BYTES = 12,
    WEB_PASSWORD_MOST_BYTES = 128,
    WEB_PASSWORD_PASSES = 2,
    WEB_PASSWORD_MEMORY_BYTES = 19 << 20,
    WEB_PASSWORD_HASH_SIZE = crypto_pwhash_STRBYTES, /* with the NUL */
};

/* What is wrong with a new password of the account `name`, as a line for people; NULL: nothing. */
const char *web_password_flaw(const char *name, const char *password);

/* Makes the hash of a password with a new salt. -ENOMEM. */
int web_password_hash(const char *password, char hash[WEB_PASSWORD_HASH_SIZE])
    __attribute__((warn_unused_result));

/* Whether the password belongs to the hash. With a NULL hash it takes as long and returns false, so
 * that nobody can tell from the time whether an account exists. */
bool web_password_is(const char *password, const char *hash);

#endif
