#include "enroll/web/account/password.h"

#include <errno.h>
#include <string.h>

#include "drivers/base/utf8.h"

const char *web_password_flaw(const char *name, const char *password)
{
    const size_t n = strlen(password);

    if (n < WEB_PASSWORD_LEAST_BYTES) {
        return "the password is shorter than 12 characters";
    }
    if (n > WEB_PASSWORD_MOST_BYTES) {
        return "the password is longer than 128 bytes";
    }
    if (!iso_utf8_is_valid(password)) {
        return "the password is not UTF-8";
    }
    if (strspn(password, (const char[]){password[0], '\0'}) == n) {
        return "the password is one character, repeated";
    }
    if (*name && strncmp(password, name, strlen(name)) == 0 && n < 2 * strlen(name)) {
        return "the password is hardly more than the name of the account";
    }
    return NULL;
}

int web_password_hash(const char *password, char hash[WEB_PASSWORD_HASH_SIZE])
{
    if (crypto_pwhash_str_alg(hash, password, strlen(password), WEB_PASSWORD_PASSES,
                              WEB_PASSWORD_MEMORY_BYTES, crypto_pwhash_ALG_ARGON2ID13)) {
        return -ENOMEM;
    }
    return 0;
}

bool web_password_is(const char *password, const char *hash)
{
    char unused[WEB_PASSWORD_HASH_SIZE];

    if (strlen(password) > WEB_PASSWORD_MOST_BYTES) {
        return false;
    }
    if (!hash) {
        (void)!web_password_hash(password, unused);
        return false;
    }
    return crypto_pwhash_str_verify(hash, password, strlen(password)) == 0;
}
