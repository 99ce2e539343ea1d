#include "enroll/web/account/setup_code.h"

#include <errno.h>
#include <sodium.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "drivers/file/directory.h"
#include "drivers/file/file.h"
#include "enroll/web/account/state_file.h"

enum { CHARACTERS = 20, GROUP = 5 };

/* What the file contains. It is read by the machine that wrote it. */
struct stored {
    char magic[8];
    int64_t until_s;
    uint8_t hash[32];
};

static const char magic[8] = "ISOWEBC1";

/* No I, L, O and U, which are easily mistaken. */
static const char alphabet[] = "0123456789ABCDEFGHJKMNPQRSTVWXYZ";

static void hash_of(const char bare[CHARACTERS], uint8_t hash[32])
{
    crypto_generichash(hash, 32, (const unsigned char *)bare, CHARACTERS, NULL, 0);
}

int web_setup_code_make(const char *path, int64_t now_s, char code[WEB_SETUP_CODE_SIZE],
                        struct iso_fault *fault)
{
    struct stored stored = {.until_s = now_s + WEB_SETUP_CODE_VALID_S};
    char bare[CHARACTERS], *to = code;
    int r;

    for (int i = 0; i < CHARACTERS; i++) {
        bare[i] = alphabet[randombytes_uniform(32)];
    }
    memcpy(stored.magic, magic, sizeof magic);
    hash_of(bare, stored.hash);
    r = web_state_file_write(path, &stored, sizeof stored, fault);
    if (r == 0) {
        for (int i = 0; i < CHARACTERS; i++) {
            if (i > 0 && i % GROUP == 0) {
                *to++ = '-';
            }
            *to++ = bare[i];
        }
        *to = '\0';
    }
    sodium_memzero(bare, sizeof bare);
    return r;
}

static bool read_stored(const char *path, int64_t now_s, struct stored *out)
{
    char *bytes;
    size_t size;
    bool ok;

    if (iso_file_read(path, sizeof *out, &bytes, &size, NULL)) {
        return false;
    }
    ok = size == sizeof *out && memcmp(bytes, magic, sizeof magic) == 0;
    if (ok) {
        memcpy(out, bytes, sizeof *out);
        /* A code from the future was made before the clock was set back. */
        ok = now_s < out->until_s && out->until_s - now_s <= WEB_SETUP_CODE_VALID_S;
    }
    free(bytes);
    return ok;
}

bool web_setup_code_waits(const char *path, int64_t now_s)
{
    struct stored stored;

    return read_stored(path, now_s, &stored);
}

/* The characters of a code as a person typed it. */
static bool bare_code(const char *code, char bare[CHARACTERS])
{
    int n = 0;

    for (; *code; code++) {
        const char c = *code >= 'a' && *code <= 'z' ? (char)(*code - 'a' + 'A') : *code;
        if (c == ' ' || c == '-') {
            continue;
        }
        if (n == CHARACTERS || !strchr(alphabet, c)) {
            return false;
        }
        bare[n++] = c;
    }
    return n == CHARACTERS;
}

bool web_setup_code_is(const char *path, int64_t now_s, const char *code)
{
    struct stored stored;
    char bare[CHARACTERS];
    uint8_t hash[32];

    if (!read_stored(path, now_s, &stored) || !bare_code(code, bare)) {
        return false;
    }
    hash_of(bare, hash);
    sodium_memzero(bare, sizeof bare);
    return sodium_memcmp(hash, stored.hash, sizeof hash) == 0;
}

int web_setup_code_use(const char *path, int64_t now_s, const char *code, struct iso_fault *fault)
{
    if (!web_setup_code_is(path, now_s, code)) {
        return iso_fault_set(fault, -EACCES, "the code is wrong or has ended");
    }
    if (unlink(path)) {
        return iso_file_fault(path, -errno, fault);
    }
    return iso_directory_sync(path, fault);
}
