/* How the audit log's lines are sealed and chained. Pure; internal to the log.
 *
 *   isotherm-log 1 KEY FIRST LINK      the first line of a segment: number of the key in the ring,
 *                                      sequence of the first record, link before it (64 hex digits)
 *   SEQUENCE BASE64                    a record: the link before it, its knowledge of the other
 *                                      stores (heads.h) and one JSON object, sealed. Records of
 *                                      format 1, which can still be read, have no such knowledge.
 *
 * The link after a record is a keyed digest of its sequence, the link before it and its sealed
 * bytes. Without the key nobody can change a record, or make the link with which the next record
 * has to begin. The link after the last record is the head of the log. */
#ifndef ISO_FIRMWARE_AUDIT_AUDIT_LINE_H
#define ISO_FIRMWARE_AUDIT_AUDIT_LINE_H

#include <stddef.h>
#include <stdint.h>

#include "firmware/contract/json_line.h"
#include "firmware/keys/heads.h"
#include "firmware/keys/seal.h"

enum {
    ISO_AUDIT_LINK_BYTES = ISO_SEAL_DIGEST_BYTES,
    ISO_AUDIT_TEXT_MAX = sizeof((struct iso_json_line *)0)->text,
    ISO_AUDIT_SEALED_MAX = ISO_AUDIT_LINK_BYTES + ISO_HEADS_COUNT_BYTES + ISO_AUDIT_TEXT_MAX +
                           ISO_SEAL_OVERHEAD,
    ISO_AUDIT_LINE_MAX = 24 + ISO_AUDIT_SEALED_MAX * 4 / 3 + 4,
};

struct iso_audit_seal {
    uint32_t key_number;
    struct iso_seal_key key, link_key;
};

struct iso_audit_link {
    uint8_t bytes[ISO_AUDIT_LINK_BYTES];
};

struct iso_audit_header {
    uint32_t key_number;
    uint64_t first;
    struct iso_audit_link link;
};

/* The keys for sealing and chaining, derived from key `key_number` of the ring. */
struct iso_audit_seal iso_audit_seal_of(uint32_t key_number, const struct iso_seal_key *key);
void iso_audit_seal_wipe(struct iso_audit_seal *seal);

/* Writes the header's line with its newline. Returns its length. */
size_t iso_audit_header_put(const struct iso_audit_header *header, char line[ISO_AUDIT_LINE_MAX]);

/* Reads a header from a line without its newline. -EBADMSG. */
int iso_audit_header_get(const char *line, struct iso_audit_header *out)
    __attribute__((warn_unused_result));

/* Writes the line of a record (text of `size` bytes, at most ISO_AUDIT_TEXT_MAX) with its newline.
 * Returns its length. *link, the link before the record, becomes the link after it. */
size_t iso_audit_line_close(const struct iso_audit_seal *seal, uint64_t sequence,
                            const struct iso_heads *known, const char *text, size_t size,
                            char line[ISO_AUDIT_LINE_MAX], struct iso_audit_link *link);

struct iso_audit_opened {
    struct iso_audit_link before, behind;
    struct iso_heads known;
    size_t size;
    char text[ISO_AUDIT_TEXT_MAX + 1]; /* ends with a NUL */
};

/* Opens a line without its newline. -EBADMSG: it is not a record of this sequence under this
 * key. */
int iso_audit_line_open(const struct iso_audit_seal *seal, uint64_t sequence, const char *line,
                        size_t length, struct iso_audit_opened *out)
    __attribute__((warn_unused_result));

#endif
