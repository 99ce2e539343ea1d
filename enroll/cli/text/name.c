#include "enroll/cli/text/name.h"

#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistr.h>

#include "firmware/contract/name_folding.h"

/* Returns NULL if the name is not UTF-8, or if there is no memory. */
static char *fold_name(const char *name)
{
    char *folded = NULL;

    return iso_name_fold(name, &folded) ? NULL : folded;
}

bool cli_name_is_same(const char *a, const char *b)
{
    if (strcmp(a, b) == 0) {
        return true;
    }
    char *folded_a = fold_name(a), *folded_b = fold_name(b);
    const bool same = folded_a && folded_b && strcmp(folded_a, folded_b) == 0;
    free(folded_a);
    free(folded_b);
    return same;
}

/* Prints a character. Invisible ones are escaped in the way that shells such as bash understand. */
static void print_character(FILE *out, ucs4_t c, const uint8_t *bytes, size_t length)
{
    if (c == '\'' || c == '\\') {
        fprintf(out, "\\%c", (char)c);
    } else if (c < 0x20 || c == 0x7f || iso_name_folding_drops(c)) {
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
