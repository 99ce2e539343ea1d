/* Memory of the heap that holds a face: how it is freed, and how it grows. */
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
        /* malloc() may return a larger block than requested. This function overwrites the whole
         * block. Packages are built with _FORTIFY_SOURCE: if the compiler knows the requested size,
         * a program that overwrites more than this size is aborted. The volatile pointer prevents
         * this, because the compiler cannot know to which block it points. */
        void *volatile whole = block;
        explicit_bzero(whole, malloc_usable_size(block));
    }
    free(block);
}

/* Moves the first `used` items of a block to a new block with room for `capacity` items, of which
 * the others are zero. Wipes and frees the old block, which may be NULL if `used` is 0. Returns the
 * new block; NULL if there is no memory for it, and then the old block stays as it is. realloc()
 * does not wipe: it may leave a copy of the face in the old memory. */
static inline void *iso_wipe_grow(void *block, size_t used, size_t capacity, size_t item_size)
{
    void *larger = calloc(capacity, item_size);
    if (!larger) {
        return NULL;
    }
    if (used > 0) {
        memcpy(larger, block, used * item_size);
    }
    iso_wipe_free(block);
    return larger;
}

#endif
