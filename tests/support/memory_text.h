/* The text of a stream in memory, for tests. */
#ifndef TESTS_SUPPORT_MEMORY_TEXT_H
#define TESTS_SUPPORT_MEMORY_TEXT_H

#include <stdlib.h>
#include <string.h>

/* Returns a copy of a text that open_memstream allocated, and frees that
 * text. The caller frees the copy. At -O3 gcc 12 takes the buffer itself for a pointer to the
 * variable that open_memstream filled in, and warns when a function returns it. */
static inline char *memory_text(char *text)
{
    char *copy = strdup(text);
    if (!copy) {
        abort(); /* no memory: the test fails */
    }
    free(text);
    return copy;
}

#endif
