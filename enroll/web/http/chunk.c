#include "enroll/web/http/chunk.h"

#include <sodium.h>
#include <stdlib.h>

struct web_chunk *web_chunk_new(size_t size)
{
    struct web_chunk *chunk = NULL;

    if (size <= SIZE_MAX - sizeof *chunk) {
        chunk = malloc(sizeof *chunk + size);
    }
    if (chunk) {
        chunk->references = 1;
        chunk->size = size;
    }
    return chunk;
}

struct web_chunk *web_chunk_ref(struct web_chunk *chunk)
{
    chunk->references++;
    return chunk;
}

void web_chunk_unref(struct web_chunk *chunk)
{
    if (chunk && --chunk->references == 0) {
        sodium_memzero(chunk->bytes, chunk->size);
        free(chunk);
    }
}
