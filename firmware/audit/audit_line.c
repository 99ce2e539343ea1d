#include "firmware/audit/audit_line.h"

#include <errno.h>
#include <inttypes.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>

enum {
    HEAD_BYTES = ISO_AUDIT_LINK_BYTES + ISO_HEADS_COUNT_BYTES,
    PLAIN_MAX_BYTES = HEAD_BYTES + ISO_AUDIT_TEXT_MAX,
};

static const int variant = sodium_base64_VARIANT_ORIGINAL_NO_PADDING;

struct iso_audit_seal iso_audit_seal_of(uint32_t key_number, const struct iso_seal_key *key)
{
    return (struct iso_audit_seal){
        .key_number = key_number,
        .key = iso_seal_key_derive(key, 1, "isoaudit"),
        .link_key = iso_seal_key_derive(key, 2, "isoaudit"),
    };
}

void iso_audit_seal_wipe(struct iso_audit_seal *seal)
{
    sodium_memzero(seal, sizeof *seal);
}

/* ---- the header ---- */

size_t iso_audit_header_put(const struct iso_audit_header *header, char line[ISO_AUDIT_LINE_MAX])
{
    char hex[2 * ISO_AUDIT_LINK_BYTES + 1];
    (void)sodium_bin2hex(hex, sizeof hex, header->link.bytes, sizeof header->link.bytes);
    return (size_t)snprintf(line, ISO_AUDIT_LINE_MAX, "isotherm-log 1 %" PRIu32 " %" PRIu64 " %s\n",
                            header->key_number, header->first, hex);
}

int iso_audit_header_get(const char *line, struct iso_audit_header *out)
{
    struct iso_audit_header header = {0};
    char again[ISO_AUDIT_LINE_MAX];
    int at = -1;
    if (sscanf(line, "isotherm-log 1 %10" SCNu32 " %20" SCNu64 " %n", &header.key_number,
               &header.first, &at) != 2 ||
        at < 0) {
        return -EBADMSG;
    }
    if (strlen(line + at) != 2 * ISO_AUDIT_LINK_BYTES ||
        sodium_hex2bin(header.link.bytes, sizeof header.link.bytes, line + at,
                       2 * ISO_AUDIT_LINK_BYTES, NULL, NULL, NULL)) {
        return -EBADMSG;
    }
    /* A header can be written in one way only; any other text is refused. */
    const size_t length = iso_audit_header_put(&header, again);
    if (length != strlen(line) + 1 || memcmp(again, line, length - 1) != 0) {
        return -EBADMSG;
    }
    *out = header;
    return 0;
}

/* ---- records ---- */

static const char format_1[] = "isotherm log record 1", format_2[] = "isotherm log record 2";

static struct iso_seal_label record_label(const char *format, const struct iso_audit_seal *seal,
                                          uint64_t sequence)
{
    struct iso_seal_label label = iso_seal_label_of(format);
    iso_seal_label_number(&label, seal->key_number);
    iso_seal_label_number(&label, sequence);
    return label;
}

static struct iso_audit_link link_behind(const struct iso_audit_seal *seal, uint64_t sequence,
                                         const struct iso_audit_link *before, const uint8_t *sealed,
                                         size_t size)
{
    struct iso_seal_label label = iso_seal_label_of("isotherm log link 1");
    struct iso_audit_link behind;
    iso_seal_label_number(&label, sequence);
    iso_seal_label_bytes(&label, before->bytes, sizeof before->bytes);
    iso_seal_digest(&seal->link_key, &label, sealed, size, behind.bytes);
    return behind;
}

size_t iso_audit_line_close(const struct iso_audit_seal *seal, uint64_t sequence,
                            const struct iso_heads *known, const char *text, size_t size,
                            char line[ISO_AUDIT_LINE_MAX], struct iso_audit_link *link)
{
    const struct iso_seal_label label = record_label(format_2, seal, sequence);
    uint8_t plain[PLAIN_MAX_BYTES], sealed[ISO_AUDIT_SEALED_MAX];
    const size_t plain_size = HEAD_BYTES + size;
    memcpy(plain, link->bytes, ISO_AUDIT_LINK_BYTES);
    iso_heads_put_counts(known, plain + ISO_AUDIT_LINK_BYTES);
    memcpy(plain + HEAD_BYTES, text, size);
    iso_seal_close(&seal->key, &label, plain, plain_size, sealed);
    sodium_memzero(plain, sizeof plain);
    *link = link_behind(seal, sequence, link, sealed, plain_size + ISO_SEAL_OVERHEAD);

    size_t length = (size_t)snprintf(line, ISO_AUDIT_LINE_MAX, "%" PRIu64 " ", sequence);
    (void)sodium_bin2base64(line + length, ISO_AUDIT_LINE_MAX - length, sealed,
                            plain_size + ISO_SEAL_OVERHEAD, variant);
    length += strlen(line + length);
    line[length++] = '\n';
    return length;
}

/* Opens a record of either format. Returns the number of bytes before its text, or 0 if it is not a
 * record. */
static size_t open_record(const struct iso_audit_seal *seal, uint64_t sequence,
                          const uint8_t *sealed, size_t size, uint8_t plain[PLAIN_MAX_BYTES])
{
    const struct iso_seal_label now = record_label(format_2, seal, sequence);
    const struct iso_seal_label before = record_label(format_1, seal, sequence);
    if (size >= ISO_SEAL_OVERHEAD + HEAD_BYTES &&
        iso_seal_open(&seal->key, &now, sealed, size, plain) == 0) {
        return HEAD_BYTES;
    }
    if (size >= ISO_SEAL_OVERHEAD + ISO_AUDIT_LINK_BYTES &&
        size <= ISO_SEAL_OVERHEAD + ISO_AUDIT_LINK_BYTES + ISO_AUDIT_TEXT_MAX &&
        iso_seal_open(&seal->key, &before, sealed, size, plain) == 0) {
        return ISO_AUDIT_LINK_BYTES;
    }
    return 0;
}

int iso_audit_line_open(const struct iso_audit_seal *seal, uint64_t sequence, const char *line,
                        size_t length, struct iso_audit_opened *out)
{
    static const struct iso_heads nothing;
    uint8_t sealed[ISO_AUDIT_SEALED_MAX], plain[PLAIN_MAX_BYTES];
    size_t size = 0, head = 0;
    char begin[32];
    const size_t skip = (size_t)snprintf(begin, sizeof begin, "%" PRIu64 " ", sequence);
    if (length <= skip || memcmp(line, begin, skip) != 0 ||
        sodium_base642bin(sealed, sizeof sealed, line + skip, length - skip, NULL, &size, NULL,
                          variant) ||
        (head = open_record(seal, sequence, sealed, size, plain)) == 0) {
        return -EBADMSG;
    }
    memcpy(out->before.bytes, plain, ISO_AUDIT_LINK_BYTES);
    out->known = head == HEAD_BYTES ? iso_heads_get_counts(plain + ISO_AUDIT_LINK_BYTES) : nothing;
    out->size = size - ISO_SEAL_OVERHEAD - head;
    memcpy(out->text, plain + head, out->size);
    out->text[out->size] = '\0';
    out->behind = link_behind(seal, sequence, &out->before, sealed, size);
    sodium_memzero(plain, sizeof plain);
    return 0;
}
