#include "firmware/person_name.h"

#include <errno.h>
#include <sodium.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unicase.h>
#include <uninorm.h>
#include <unistr.h>

#include "firmware/utf8.h"

static bool is_control(uint32_t c)
{
    return c < 0x20 || (c >= 0x7f && c < 0xa0) || (c >= 0x2028 && c <= 0x202e) ||
           (c >= 0x2066 && c <= 0x2069) || c == 0x200e || c == 0x200f || c == 0xfeff;
}

static bool is_blank(uint32_t c)
{
    return c == ' ' || c == 0xa0 || (c >= 0x2000 && c <= 0x200a) || c == 0x3000;
}

const char *iso_person_name_flaw(const char *name)
{
    uint32_t c = 0, last = 0;
    int n = 0;
    for (; *name; n++, last = c) {
        const int length = iso_utf8_decode(name, &c);
        if (!length) {
            return "the name is not UTF-8";
        }
        if (is_control(c)) {
            return "the name holds a control character";
        }
        if (n == 0 && is_blank(c)) {
            return "the name begins with a blank";
        }
        if (n == ISO_PERSON_NAME_CHARACTERS) {
            return "the name is longer than 64 characters";
        }
        name += length;
    }
    if (n == 0) {
        return "the name is empty";
    }
    return is_blank(last) ? "the name ends with a blank" : NULL;
}

/* ---- which names are one ---- */

static void digest(const uint8_t *folded, size_t size, struct iso_person_name_key *out)
{
    (void)crypto_generichash(out->bytes, sizeof out->bytes, folded, size, NULL, 0);
}

/* Most names need neither tables nor memory: what they fold to is the lower case. */
static bool fold_ascii(const char *name, size_t size, uint8_t *folded)
{
    for (size_t i = 0; i < size; i++) {
        const unsigned char c = (unsigned char)name[i];
        if (c >= 0x80) {
            return false;
        }
        folded[i] = c >= 'A' && c <= 'Z' ? (uint8_t)(c + ('a' - 'A')) : c;
    }
    return true;
}

/* Folded twice: compatibility characters, such as a square MHz, become letters with a case only by
 * the first normalisation. */
static int fold(const char *name, size_t size, uint8_t **folded, size_t *folded_size)
{
    size_t once_size = 0;
    if (u8_check((const uint8_t *)name, size)) {
        return -EINVAL;
    }
    uint8_t *once = u8_casefold((const uint8_t *)name, size, NULL, UNINORM_NFKC, NULL, &once_size);
    if (!once) {
        return -ENOMEM;
    }
    *folded = u8_casefold(once, once_size, NULL, UNINORM_NFKC, NULL, folded_size);
    free(once);
    return *folded ? 0 : -ENOMEM;
}

int iso_person_name_key(const char *name, struct iso_person_name_key *out)
{
    const size_t size = strlen(name);
    uint8_t lower[ISO_PERSON_NAME_SIZE], *folded = NULL;
    size_t folded_size = 0;
    if (size < sizeof lower && fold_ascii(name, size, lower)) {
        digest(lower, size, out);
        return 0;
    }
    const int error = fold(name, size, &folded, &folded_size);
    if (error) {
        return error;
    }
    digest(folded, folded_size, out);
    free(folded);
    return 0;
}

bool iso_person_name_key_is_same(const struct iso_person_name_key *a,
                                 const struct iso_person_name_key *b)
{
    return memcmp(a, b, sizeof *a) == 0;
}
