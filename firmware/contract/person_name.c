#include "firmware/contract/person_name.h"

#include <errno.h>
#include <sodium.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unicase.h>
#include <unictype.h>
#include <uninorm.h>
#include <unistr.h>

#include "drivers/base/utf8.h"

/* ---- which characters a name may have ---- */

/* Forges lines of a log or a list. */
static bool is_control(uint32_t c)
{
    return c < 0x20 || (c >= 0x7f && c < 0xa0) || (c >= 0x2028 && c <= 0x202e) ||
           (c >= 0x2066 && c <= 0x2069) || c == 0x200e || c == 0x200f || c == 0xfeff;
}

/* Two names that differ in such characters alone look the same. Unicode's table has all that a font
 * may leave out; the others are of its category "format" (Cf), no characters at all, or a pattern
 * without dots. */
static bool is_unseen(uint32_t c)
{
    static const uint32_t braille_blank = 0x2800;
    return uc_is_property_default_ignorable_code_point(c) || uc_is_property_bidi_control(c) ||
           uc_is_general_category_withtable(c, UC_CATEGORY_MASK_Cf) ||
           uc_is_property_not_a_character(c) || c == braille_blank;
}

static bool is_blank(uint32_t c)
{
    return uc_is_property_white_space(c);
}

/* What is refused in a name that is given now; in a stored name only what always was. */
static const char *character_flaw(uint32_t c, bool stored)
{
    if (is_control(c)) {
        return "the name holds a control character";
    }
    return is_unseen(c) && !stored ? "the name holds a character that is not seen" : NULL;
}

static const char *find_flaw(const char *name, bool stored)
{
    uint32_t c = 0, last = 0;
    int n = 0;
    for (; *name; n++, last = c) {
        const int length = iso_utf8_decode(name, &c);
        if (!length) {
            return "the name is not UTF-8";
        }
        const char *flaw = character_flaw(c, stored);
        if (flaw) {
            return flaw;
        }
        if (n == 0 && is_blank(c) && !stored) {
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
    return is_blank(last) && !stored ? "the name ends with a blank" : NULL;
}

const char *iso_person_name_flaw(const char *name)
{
    return find_flaw(name, false);
}

bool iso_person_name_can_be_stored(const char *name)
{
    return !find_flaw(name, true);
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

/* Takes away what a font may leave out, in place: the new size. */
static size_t drop_unseen(uint8_t *text, size_t size)
{
    size_t kept = 0;
    for (size_t at = 0; at < size;) {
        ucs4_t c = 0;
        const size_t length = (size_t)u8_mbtouc(&c, text + at, size - at);
        if (!uc_is_property_default_ignorable_code_point(c) && !uc_is_property_bidi_control(c)) {
            memmove(text + kept, text + at, length);
            kept += length;
        }
        at += length;
    }
    return kept;
}

static uint8_t *fold_once(const uint8_t *text, size_t size, size_t *folded_size)
{
    uint8_t *folded = u8_casefold(text, size, NULL, UNINORM_NFKC, NULL, folded_size);
    if (folded) {
        *folded_size = drop_unseen(folded, *folded_size);
    }
    return folded;
}

/* Folded twice: compatibility characters, such as a square MHz, become letters with a case only by
 * the first normalisation. */
static int fold(const char *name, size_t size, uint8_t **folded, size_t *folded_size)
{
    size_t once_size = 0;
    if (u8_check((const uint8_t *)name, size)) {
        return -EINVAL;
    }
    uint8_t *seen = (uint8_t *)strdup(name);
    uint8_t *once = seen ? fold_once(seen, drop_unseen(seen, size), &once_size) : NULL;
    *folded = once ? fold_once(once, once_size, folded_size) : NULL;
    free(seen);
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
