/* Bytes that several clients receive, kept until the last of them has sent them. One thread. */
#ifndef WEB_HTTP_CHUNK_H
#define WEB_HTTP_CHUNK_H

#include <stddef.h>
#include <stdint.h>

struct web_chunk {
    int references;
    size_t size;
    uint8_t bytes[];
};

/* A chunk of `size` bytes, not initialised, with one reference. NULL: there is no memory. */
struct web_chunk *web_chunk_new(size_t size);

/* One reference more; returns the chunk. */
struct web_chunk *web_chunk_ref(struct web_chunk *chunk);

/* One reference less; the last one wipes and frees the chunk. NULL is accepted. */
void web_chunk_unref(struct web_chunk *chunk);

#endif
