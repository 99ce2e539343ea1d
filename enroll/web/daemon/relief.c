#include "enroll/web/daemon/relief.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <unistd.h>
#include <zlib.h>

#include "core/base/bytes.h"
#include "firmware/contract/stream_record.h"

enum { HEAD_BYTES = 20, LENGTH_BYTES = 4, LEVEL = 1 };

struct web_relief {
    sd_event_source *records; /* NULL: the daemon has ended it */
    void (*on_chunk)(void *context, struct web_chunk *chunk);
    void *context;
    z_stream zlib;
    uint8_t packet[ISO_STREAM_BYTES_MAX + 1];
    struct iso_relief_record record;
    uint8_t deltas[2 * ISO_RELIEF_COLUMNS * ISO_RELIEF_ROWS];
};

/* ---- memory of zlib, which holds depths, too ---- */

static void *allocate(void *context, unsigned items, unsigned size)
{
    const size_t bytes = (size_t)items * size;
    size_t *memory = calloc(1, bytes + 2 * sizeof *memory);
    (void)context;
    if (!memory) {
        return NULL;
    }
    *memory = bytes;
    return memory + 2; /* so that it stays aligned for every type */
}

static void wipe(void *context, void *address)
{
    size_t *memory = (size_t *)address - 2;
    (void)context;
    explicit_bzero(address, *memory);
    free(memory);
}

/* ---- one record ---- */

/* Writes each depth as the difference to its left neighbour. Returns the length. */
static size_t put_deltas(const struct iso_relief_record *record, uint8_t *p)
{
    const uint8_t *begin = p;
    for (int row = 0; row < record->rows; row++) {
        const uint16_t *depth_mm = record->depth_mm + (size_t)row * (size_t)record->columns;
        uint16_t left = 0;
        for (int column = 0; column < record->columns; column++) {
            p = iso_put_u16(p, (uint16_t)(depth_mm[column] - left));
            left = depth_mm[column];
        }
    }
    return (size_t)(p - begin);
}

/* Compresses the deltas behind the head of the record. Returns the chunk, or NULL. */
static struct web_chunk *compress_deltas(struct web_relief *relief, const uint8_t *head,
                                         size_t size)
{
    z_stream *zlib = &relief->zlib;
    const size_t room = deflateBound(zlib, (uLong)size);
    struct web_chunk *chunk = deflateReset(zlib) == Z_OK
                                  ? web_chunk_new(LENGTH_BYTES + HEAD_BYTES + room)
                                  : NULL;
    if (!chunk) {
        return NULL;
    }
    zlib->next_in = relief->deltas;
    zlib->avail_in = (uInt)size;
    zlib->next_out = chunk->bytes + LENGTH_BYTES + HEAD_BYTES;
    zlib->avail_out = (uInt)room;
    if (deflate(zlib, Z_FINISH) != Z_STREAM_END) {
        web_chunk_unref(chunk);
        return NULL;
    }
    chunk->size = LENGTH_BYTES + HEAD_BYTES + zlib->total_out;
    memcpy(iso_put_u32(chunk->bytes, (uint32_t)(HEAD_BYTES + zlib->total_out)), head, HEAD_BYTES);
    return chunk;
}

struct web_chunk *web_relief_chunk(struct web_relief *relief, const uint8_t *bytes, size_t size)
{
    struct web_chunk *chunk = NULL;
    if (iso_relief_record_read(bytes, size, &relief->record) == 0) {
        chunk = compress_deltas(relief, bytes, put_deltas(&relief->record, relief->deltas));
    }
    explicit_bzero(&relief->record, sizeof relief->record);
    explicit_bzero(relief->deltas, sizeof relief->deltas);
    return chunk;
}

/* ---- the stream ---- */

static int on_records(sd_event_source *source, int fd, uint32_t events, void *context)
{
    struct web_relief *relief = context;
    (void)source;
    (void)events;
    for (;;) {
        const ssize_t size = recv(fd, relief->packet, sizeof relief->packet, MSG_DONTWAIT);
        if (size == 0 || (size < 0 && errno != EAGAIN && errno != EINTR)) {
            relief->records = sd_event_source_disable_unref(relief->records);
            return 0;
        }
        if (size < 0 && errno == EAGAIN) {
            return 0;
        }
        struct web_chunk *chunk = size > 0 ? web_relief_chunk(relief, relief->packet, (size_t)size)
                                           : NULL;
        explicit_bzero(relief->packet, sizeof relief->packet);
        if (chunk) {
            relief->on_chunk(relief->context, chunk);
            web_chunk_unref(chunk);
        }
    }
}

int web_relief_new(sd_event *event, int fd,
                   void (*on_chunk)(void *context, struct web_chunk *chunk), void *context,
                   struct web_relief **out)
{
    struct web_relief *relief = calloc(1, sizeof *relief);
    if (!relief) {
        (void)close(fd);
        return -ENOMEM;
    }
    relief->on_chunk = on_chunk;
    relief->context = context;
    relief->zlib = (z_stream){.zalloc = allocate, .zfree = wipe};
    if (deflateInit(&relief->zlib, LEVEL) != Z_OK) {
        (void)close(fd);
        free(relief);
        return -ENOMEM;
    }
    const int r = sd_event_add_io(event, &relief->records, fd, EPOLLIN, on_records, relief);
    if (r < 0) {
        (void)close(fd);
        web_relief_free(relief);
        return r;
    }
    (void)sd_event_source_set_io_fd_own(relief->records, 1);
    *out = relief;
    return 0;
}

void web_relief_free(struct web_relief *relief)
{
    if (relief) {
        sd_event_source_disable_unref(relief->records);
        (void)deflateEnd(&relief->zlib);
        explicit_bzero(relief, sizeof *relief);
        free(relief);
    }
}
