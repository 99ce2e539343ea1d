#include "firmware/contract/name_folding.h"

#include <errno.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unicase.h>
#include <unictype.h>
#include <uninorm.h>
#include <unistr.h>

bool iso_name_folding_drops(uint32_t character)
{
    return uc_is_property_default_ignorable_code_point(character) ||
           uc_is_property_bidi_control(character);
}

/* Removes the characters that folding drops, in place. Returns the new size. */
static size_t drop_characters(uint8_t *text, size_t size)
{
    size_t kept = 0;
    for (size_t at = 0; at < size;) {
        ucs4_t c = 0;
        const size_t length = (size_t)u8_mbtouc(&c, text + at, size - at);
        if (!iso_name_folding_drops(c)) {
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
        *folded_size = drop_characters(folded, *folded_size);
    }
    return folded;
}

/* Folds twice, because the first normalisation turns compatibility characters, such as a square
 * MHz, into letters that have a case. */
int iso_name_fold(const char *name, char **out)
{
    const size_t size = strlen(name);
    size_t once_size = 0, folded_size = 0;
    if (u8_check((const uint8_t *)name, size)) {
        return -EINVAL;
    }
    uint8_t *seen = (uint8_t *)strdup(name);
    uint8_t *once = seen ? fold_once(seen, drop_characters(seen, size), &once_size) : NULL;
    uint8_t *folded = once ? fold_once(once, once_size, &folded_size) : NULL;
    char *text = folded ? strndup((const char *)folded, folded_size) : NULL;
    free(seen);
    free(once);
    free(folded);
    if (!text) {
        return -ENOMEM;
    }
    *out = text;
    return 0;
}
