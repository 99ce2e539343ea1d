/* The records of the streams that the method Watch opens. A stream is a socket of type
 * SOCK_SEQPACKET: each packet that the client receives is one record. All numbers are little
 * endian; a client that reads from another machine gets the same bytes.
 *
 *   offset
 *        0  uint8   version, 1
 *        1  uint8   kind: enum iso_stream_kind
 *        2  uint16  missed: how many records before this one the client did not get, because it had
 *                   not read the earlier ones; 65535 means that many or more
 *        4  uint32  sequence: counts the frames of the sensor that were examined
 *        8  int64   time of the frame, nanoseconds on the machine's monotonic clock
 *
 * ISO_STREAM_OUTLINE, ISO_OUTLINE_BYTES in all:
 *       16  uint16  distance of the nose tip, millimetres; 0: there is no face
 *       18  uint8   flags: 1 lockdown, 2 locked out
 *       19  uint8   n: points of the outline, 0 or 3..ISO_OUTLINE_POINTS
 *       20  char    mode[12], hint[20], verdict[8], reason[16]: words, padded with NUL
 *       76  uint8   silhouette[60][10]: row by row from the top; the highest bit of a byte is its
 *                   leftmost point. 1: something is near there
 *      676  int16   outline[64][2]: x, y of the points, clockwise, in 1/32 of a silhouette point
 * from the corner at the top left; points beyond n are 0. A point may lie outside
 *
 * ISO_STREAM_RELIEF:
 *       16  uint16  columns, 1..ISO_RELIEF_COLUMNS
 *       18  uint16  rows, 1..ISO_RELIEF_ROWS
 *       20  uint16  depth[rows][columns], millimetres; 0: not measured
 *
 * The outline tells people apart as little as possible: it is that of the mean head, which is the
 * same for everybody. SECURITY.md says what a client can learn. Pure. */
#ifndef ISO_FIRMWARE_CONTRACT_STREAM_RECORD_H
#define ISO_FIRMWARE_CONTRACT_STREAM_RECORD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    ISO_STREAM_VERSION = 1,
    ISO_STREAM_HEAD_BYTES = 16,
    ISO_SILHOUETTE_COLUMNS = 80,
    ISO_SILHOUETTE_ROWS = 60,
    ISO_SILHOUETTE_STRIDE = ISO_SILHOUETTE_COLUMNS / 8, /* bytes of a row */
    ISO_OUTLINE_POINTS = 64,
    ISO_OUTLINE_UNITS = 32, /* of a coordinate in one silhouette point */
    ISO_OUTLINE_BYTES = 676 + 4 * ISO_OUTLINE_POINTS,
    ISO_RELIEF_COLUMNS = 160,
    ISO_RELIEF_ROWS = 120,
    ISO_STREAM_BYTES_MAX = 20 + 2 * ISO_RELIEF_COLUMNS * ISO_RELIEF_ROWS
};

enum iso_stream_kind { ISO_STREAM_OUTLINE = 1, ISO_STREAM_RELIEF = 2 };

struct iso_stream_head {
    enum iso_stream_kind kind;
    uint16_t missed;
    uint32_t sequence;
    int64_t t_ns;
};

struct iso_outline_record {
    struct iso_stream_head head;
    uint16_t distance_mm;
    bool lockdown, locked_out;
    char mode[12];   /* "watch", "claimed", "enroll", "verify", "identify" */
    char hint[20];   /* what most of the last frames say: a word of isotherm/capture.h */
    char verdict[8]; /* of the visit that goes on: "allow", "deny"; "": not yet, or nobody there */
    char reason[16]; /* of that verdict: a word of firmware/visit/decision.h; else "" */
    uint8_t silhouette[ISO_SILHOUETTE_ROWS][ISO_SILHOUETTE_STRIDE];
    int n_points;
    int16_t outline[ISO_OUTLINE_POINTS][2];
};

struct iso_relief_record {
    struct iso_stream_head head;
    int columns, rows;
    uint16_t depth_mm[ISO_RELIEF_COLUMNS * ISO_RELIEF_ROWS];
};

/* Writes a record. A word that is too long is cut. `bytes` has room for ISO_OUTLINE_BYTES or
 * ISO_STREAM_BYTES_MAX. Returns the length. The counts have to be in the ranges above. */
size_t iso_outline_record_write(const struct iso_outline_record *record, uint8_t *bytes);
size_t iso_relief_record_write(const struct iso_relief_record *record, uint8_t *bytes);

/* Writes how many records were missed into a record that was written before. */
void iso_stream_record_set_missed(uint8_t *bytes, uint16_t missed);

/* Reads a record of any length and content. -EBADMSG: it is not a record of this kind and version,
 * its length is wrong, a count is out of range, or a word has no end or a character other than a
 * to z and '-'. */
int iso_outline_record_read(const uint8_t *bytes, size_t size, struct iso_outline_record *out)
    __attribute__((warn_unused_result));
int iso_relief_record_read(const uint8_t *bytes, size_t size, struct iso_relief_record *out)
    __attribute__((warn_unused_result));

/* Whether a point of the silhouette is set. */
static inline bool iso_silhouette_is_set(const uint8_t silhouette[][ISO_SILHOUETTE_STRIDE],
                                         int column, int row)
{
    return (silhouette[row][column / 8] >> (7 - column % 8)) & 1;
}

#endif
