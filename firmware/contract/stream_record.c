#include "firmware/contract/stream_record.h"

#include <errno.h>
#include <string.h>

#include "core/base/bytes.h"

enum { LOCKDOWN = 1, LOCKED_OUT = 2 };

/* ---- writing ---- */

static uint8_t *put_head(uint8_t *p, const struct iso_stream_head *head, enum iso_stream_kind kind)
{
    *p++ = ISO_STREAM_VERSION;
    *p++ = (uint8_t)kind;
    p = iso_put_u16(p, head->missed);
    p = iso_put_u32(p, head->sequence);
    return iso_put_u64(p, (uint64_t)head->t_ns);
}

/* Writes a word into a field of `size` bytes, the last of which is NUL. */
static uint8_t *put_word(uint8_t *p, const char *word, size_t size)
{
    memset(p, 0, size);
    memcpy(p, word, strnlen(word, size - 1));
    return p + size;
}

size_t iso_outline_record_write(const struct iso_outline_record *record, uint8_t *bytes)
{
    uint8_t *p = put_head(bytes, &record->head, ISO_STREAM_OUTLINE);
    p = iso_put_u16(p, record->distance_mm);
    *p++ = (uint8_t)((record->lockdown ? LOCKDOWN : 0) | (record->locked_out ? LOCKED_OUT : 0));
    *p++ = (uint8_t)record->n_points;
    p = put_word(p, record->mode, sizeof record->mode);
    p = put_word(p, record->hint, sizeof record->hint);
    p = put_word(p, record->verdict, sizeof record->verdict);
    p = put_word(p, record->reason, sizeof record->reason);
    p = iso_put_bytes(p, record->silhouette, sizeof record->silhouette);
    for (int i = 0; i < ISO_OUTLINE_POINTS; i++) {
        const bool has = i < record->n_points;
        p = iso_put_u16(p, has ? (uint16_t)record->outline[i][0] : 0);
        p = iso_put_u16(p, has ? (uint16_t)record->outline[i][1] : 0);
    }
    return (size_t)(p - bytes);
}

size_t iso_relief_record_write(const struct iso_relief_record *record, uint8_t *bytes)
{
    uint8_t *p = put_head(bytes, &record->head, ISO_STREAM_RELIEF);
    p = iso_put_u16(p, (uint16_t)record->columns);
    p = iso_put_u16(p, (uint16_t)record->rows);
    for (int i = 0; i < record->columns * record->rows; i++) {
        p = iso_put_u16(p, record->depth_mm[i]);
    }
    return (size_t)(p - bytes);
}

void iso_stream_record_set_missed(uint8_t *bytes, uint16_t missed)
{
    (void)iso_put_u16(bytes + 2, missed);
}

/* ---- reading ---- */

static int get_head(const uint8_t *bytes, size_t size, enum iso_stream_kind kind,
                    struct iso_stream_head *out)
{
    if (size < ISO_STREAM_HEAD_BYTES + 4 || bytes[0] != ISO_STREAM_VERSION || bytes[1] != kind) {
        return -EBADMSG;
    }
    *out = (struct iso_stream_head){
        .kind = kind,
        .missed = iso_get_u16(bytes + 2),
        .sequence = iso_get_u32(bytes + 4),
        .t_ns = (int64_t)iso_get_u64(bytes + 8),
    };
    return 0;
}

/* Reads the word of a field of `size` bytes; returns the byte after it, or NULL for a bad word. */
static const uint8_t *get_word(const uint8_t *p, char *word, size_t size)
{
    size_t length = 0;
    while (length < size && ((p[length] >= 'a' && p[length] <= 'z') || p[length] == '-')) {
        length++;
    }
    for (size_t i = length; i < size; i++) {
        if (p[i]) {
            return NULL;
        }
    }
    if (length == size) {
        return NULL;
    }
    memcpy(word, p, size);
    return p + size;
}

static bool is_count_of_points(int n)
{
    return n == 0 || (n >= 3 && n <= ISO_OUTLINE_POINTS);
}

int iso_outline_record_read(const uint8_t *bytes, size_t size, struct iso_outline_record *out)
{
    *out = (struct iso_outline_record){.n_points = 0};
    if (size != ISO_OUTLINE_BYTES || get_head(bytes, size, ISO_STREAM_OUTLINE, &out->head) ||
        !is_count_of_points(bytes[19])) {
        return -EBADMSG;
    }
    out->distance_mm = iso_get_u16(bytes + 16);
    out->lockdown = bytes[18] & LOCKDOWN;
    out->locked_out = bytes[18] & LOCKED_OUT;
    const uint8_t *p = get_word(bytes + 20, out->mode, sizeof out->mode);
    p = p ? get_word(p, out->hint, sizeof out->hint) : NULL;
    p = p ? get_word(p, out->verdict, sizeof out->verdict) : NULL;
    p = p ? get_word(p, out->reason, sizeof out->reason) : NULL;
    if (!p) {
        return -EBADMSG;
    }
    memcpy(out->silhouette, p, sizeof out->silhouette);
    p += sizeof out->silhouette;
    out->n_points = bytes[19];
    for (int i = 0; i < out->n_points; i++) {
        out->outline[i][0] = (int16_t)iso_get_u16(p + (size_t)4 * (size_t)i);
        out->outline[i][1] = (int16_t)iso_get_u16(p + (size_t)4 * (size_t)i + 2);
    }
    return 0;
}

int iso_relief_record_read(const uint8_t *bytes, size_t size, struct iso_relief_record *out)
{
    *out = (struct iso_relief_record){.columns = 0};
    if (get_head(bytes, size, ISO_STREAM_RELIEF, &out->head)) {
        return -EBADMSG;
    }
    const int columns = iso_get_u16(bytes + 16);
    const int rows = iso_get_u16(bytes + 18);
    if (columns < 1 || columns > ISO_RELIEF_COLUMNS || rows < 1 || rows > ISO_RELIEF_ROWS ||
        size != (size_t)20 + (size_t)2 * (size_t)columns * (size_t)rows) {
        return -EBADMSG;
    }
    out->columns = columns;
    out->rows = rows;
    for (int i = 0; i < columns * rows; i++) {
        out->depth_mm[i] = iso_get_u16(bytes + 20 + (size_t)2 * (size_t)i);
    }
    return 0;
}
