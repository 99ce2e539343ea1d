#include "enroll/name.h"

#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unicase.h>
#include <uninorm.h>
#include <unistr.h>

/* Unicode's case folding and compatibility composition (NFKC), twice as the daemon does it: a
 * square MHz becomes letters with a case only by the first normalisation. NULL if the name is not
 * UTF-8, or for want of memory; the caller frees it. */
static uint8_t *fold(const char *name, size_t *size)
{
    const uint8_t *bytes = (const uint8_t *)name;
    size_t once_size = 0;

    if (u8_check(bytes, strlen(name))) {
        return NULL;
    }
    uint8_t *once = u8_casefold(bytes, strlen(name), NULL, UNINORM_NFKC, NULL, &once_size);
    if (!once) {
        return NULL;
    }
    uint8_t *folded = u8_casefold(once, once_size, NULL, UNINORM_NFKC, NULL, size);
    free(once);
    return folded;
}

bool cli_name_is_same(const char *a, const char *b)
{
    size_t size_a = 0, size_b = 0;

    if (strcmp(a, b) == 0) {
        return true;
    }
    uint8_t *folded_a = fold(a, &size_a), *folded_b = fold(b, &size_b);
    const bool same = folded_a && folded_b && size_a == size_b &&
                      memcmp(folded_a, folded_b, size_a) == 0;
    free(folded_a);
    free(folded_b);
    return same;
}
