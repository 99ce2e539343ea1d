#include "enroll/cli/text/name.h"

#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unicase.h>
#include <unictype.h>
#include <uninorm.h>
#include <unistr.h>

static bool is_unseen(ucs4_t c)
{
    return uc_is_property_default_ignorable_code_point(c) || uc_is_property_bidi_control(c);
}

/* Takes the characters that are not seen away, in place: the new size. */
static size_t drop_unseen(uint8_t *text, size_t size)
{
    size_t kept = 0;

    for (size_t at = 0; at < size;) {
        ucs4_t c = 0;
        const size_t length = (size_t)u8_mbtouc(&c, text + at, size - at);
        if (!is_unseen(c)) {
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

char *cli_name_fold(const char *name)
{
    size_t once_size = 0, size = 0;

    if (u8_check((const uint8_t *)name, strlen(name))) {
        return NULL;
    }
    uint8_t *seen = (uint8_t *)strdup(name);
    uint8_t *once = seen ? fold_once(seen, drop_unseen(seen, strlen(name)), &once_size) : NULL;
    uint8_t *folded = once ? fold_once(once, once_size, &size) : NULL;
    char *text = folded ? strndup((const char *)folded, size) : NULL;
    free(seen);
    free(once);
    free(folded);
    return text;
}

bool cli_name_is_same(const char *a, const char *b)
{
    if (strcmp(a, b) == 0) {
        return true;
    }
    char *folded_a = cli_name_fold(a), *folded_b = cli_name_fold(b);
    const bool same = folded_a && folded_b && strcmp(folded_a, folded_b) == 0;
    free(folded_a);
    free(folded_b);
    return same;
}

/* As a shell such as bash reads it. */
static void print_character(FILE *out, ucs4_t c, const uint8_t *bytes, size_t length)
{
    if (c == '\'' || c == '\\') {
        fprintf(out, "\\%c", (char)c);
    } else if (c < 0x20 || c == 0x7f || is_unseen(c)) {
        fprintf(out, c <= 0xffff ? "\\u%04X" : "\\U%08X", (unsigned)c);
    } else {
        (void)fwrite(bytes, 1, length, out);
    }
}

void cli_name_print(FILE *out, const char *name)
{
    const uint8_t *text = (const uint8_t *)name;
    const size_t size = strlen(name);

    fputs("$'", out);
    for (size_t at = 0; at < size;) {
        ucs4_t c = 0;
        const size_t length = (size_t)u8_mbtouc(&c, text + at, size - at);
        print_character(out, c, text + at, length);
        at += length;
    }
    fputc('\'', out);
}
