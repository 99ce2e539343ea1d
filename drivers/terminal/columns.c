#include "drivers/terminal/columns.h"

#include <locale.h>
#include <stdbool.h>
#include <string.h>
#include <wchar.h>

/* The next character: its bytes (at least one) and its columns. `known` is false for a character
 * that may not be printed. */
struct letter {
    size_t bytes;
    int columns;
    bool known;
};

static struct letter next_letter(const char *text, mbstate_t *state)
{
    wchar_t wide;
    const size_t length = mbrtowc(&wide, text, strlen(text), state);

    if (length == (size_t)-1 || length == (size_t)-2 || length == 0) {
        *state = (mbstate_t){0};
        return (struct letter){.bytes = 1, .columns = 1};
    }
    const int columns = wcwidth(wide);
    return columns < 0 ? (struct letter){.bytes = length, .columns = 1}
                       : (struct letter){.bytes = length, .columns = columns, .known = true};
}

/* Reads the text in a UTF-8 locale, which glibc always has, and then restores the locale of the
 * thread. Prints the text if `out` is not NULL. */
static size_t walk(const char *text, FILE *out)
{
    const locale_t utf8 = newlocale(LC_CTYPE_MASK, "C.UTF-8", (locale_t)0);
    const locale_t before = utf8 ? uselocale(utf8) : (locale_t)0;
    mbstate_t state = {0};
    size_t columns = 0;

    for (struct letter letter; *text; text += letter.bytes) {
        letter = next_letter(text, &state);
        columns += (size_t)letter.columns;
        if (out && letter.known) {
            (void)fwrite(text, 1, letter.bytes, out);
        } else if (out) {
            (void)fputc('?', out);
        }
    }
    if (utf8) {
        (void)uselocale(before);
        freelocale(utf8);
    }
    return columns;
}

size_t iso_columns_of(const char *utf8)
{
    return walk(utf8, NULL);
}

void iso_columns_print(FILE *out, const char *utf8, size_t columns)
{
    for (size_t taken = walk(utf8, out); taken < columns; taken++) {
        (void)fputc(' ', out);
    }
}
