#include "firmware/contract/person_name.h"

#include <errno.h>
#include <sodium.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unictype.h>

#include "drivers/base/utf8.h"
#include "firmware/contract/name_folding.h"

/* ---- which characters a name may have ---- */

/* Whether a character could forge lines of a log or a list. */
static bool is_control(uint32_t c)
{
    return c < 0x20 || (c >= 0x7f && c < 0xa0) || (c >= 0x2028 && c <= 0x202e) ||
           (c >= 0x2066 && c <= 0x2069) || c == 0x200e || c == 0x200f || c == 0xfeff;
}

/* Whether two names that differ only in this character look the same. Such characters are those
 * that folding drops, the Unicode category "format" (Cf), noncharacters, and a pattern without
 * dots. */
static bool is_unseen(uint32_t c)
{
    static const uint32_t braille_blank = 0x2800;
    return iso_name_folding_drops(c) || uc_is_general_category_withtable(c, UC_CATEGORY_MASK_Cf) ||
           uc_is_property_not_a_character(c) || c == braille_blank;
}

static bool is_blank(uint32_t c)
{
    return uc_is_property_white_space(c);
}

/* Returns what is wrong with a character, or NULL. A stored name may contain characters that a new
 * name must not contain. */
static const char *character_flaw(uint32_t c, bool stored)
{
    if (is_control(c)) {
        return "the name holds a control character";
    }
    return is_unseen(c) && !stored ? "the name holds an invisible character" : NULL;
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

bool iso_person_name_has_control(const char *text)
{
    uint32_t c = 0;
    for (int length; *text; text += length) {
        length = iso_utf8_decode(text, &c);
        if (!length || is_control(c)) {
            return true;
        }
    }
    return false;
}

/* ---- which names are one ---- */

static void digest_name(const uint8_t *folded, size_t size, struct iso_person_name_key *out)
{
    (void)crypto_generichash(out->bytes, sizeof out->bytes, folded, size, NULL, 0);
}

/* Most names are ASCII. They need neither tables nor memory, because they fold to lower case. */
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

int iso_person_name_key(const char *name, struct iso_person_name_key *out)
{
    const size_t size = strlen(name);
    uint8_t lower[ISO_PERSON_NAME_SIZE];
    char *folded = NULL;
    if (size < sizeof lower && fold_ascii(name, size, lower)) {
        digest_name(lower, size, out);
        return 0;
    }
    const int error = iso_name_fold(name, &folded);
    if (error) {
        return error;
    }
    digest_name((const uint8_t *)folded, strlen(folded), out);
    free(folded);
    return 0;
}

bool iso_person_name_key_is_same(const struct iso_person_name_key *a,
                                 const struct iso_person_name_key *b)
{
    return memcmp(a, b, sizeof *a) == 0;
}
