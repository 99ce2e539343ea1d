/* Freeing memory that holds a face. */
#ifndef ISO_CORE_BASE_WIPE_H
#define ISO_CORE_BASE_WIPE_H

#include <malloc.h>
#include <stdlib.h>
#include <string.h>

/* Overwrites a block of the heap with zeros and frees it. NULL is accepted. The daemon's heap wipes
 * every block that is freed; other users of the library have only this. */
static inline void iso_wipe_free(void *block)
{
    if (block) {
        explicit_bzero(block, malloc_usable_size(block));
    }
    free(block);
}

#endif
