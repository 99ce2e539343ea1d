#include "firmware/visit/lockout_file.h"

#include <errno.h>
#include <inttypes.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/bytes.h"
#include "core/base/crc32.h"
#include "drivers/base/times.h"
#include "drivers/file/data_file.h"
#include "drivers/file/directory.h"
#include "firmware/keys/sealed_file.h"

static const struct iso_sealed_file kind = {.magic = "ISOLOCK2",
                                            .kind = "isotherm lockout 2",
                                            .use = ISO_KEY_ANCHOR,
                                            .plain_min = ISO_LOCKOUT_PLAIN_BYTES,
                                            .plain_max = ISO_LOCKOUT_PLAIN_BYTES};

enum { TEXT_SIZE = 160, FILE_MAX_BYTES = 4096 };

/* Rounded up, so that a lock that ends in less than a millisecond is still a lock. */
static int64_t remaining_ms(const struct iso_lockout_record *record)
{
    return record->remaining_ns > INT64_MAX - ISO_NS_PER_MS
               ? INT64_MAX / ISO_NS_PER_MS
               : (record->remaining_ns + ISO_NS_PER_MS - 1) / ISO_NS_PER_MS;
}

/* ---- format 1 ---- */

static size_t print_record(const struct iso_lockout_record *record, char text[TEXT_SIZE])
{
    int n = snprintf(text, TEXT_SIZE, "isotherm-lockout 1 %d %d %d %" PRId64 " %s ",
                     record->failures, record->attacks, record->locks, remaining_ms(record),
                     record->lockdown ? "lockdown" : "open");
    const uint32_t crc = iso_crc32(0, text, (size_t)n);
    n += snprintf(text + n, TEXT_SIZE - (size_t)n, "%08" PRIx32 "\n", crc);
    return (size_t)n;
}

int iso_lockout_parse(const char *text, size_t size, struct iso_lockout_record *out)
{
    struct iso_lockout_record record;
    char word[9], again[TEXT_SIZE];
    int64_t left_ms;
    if (size >= TEXT_SIZE || strlen(text) != size ||
        sscanf(text, "isotherm-lockout 1 %9d %9d %9d %12" SCNd64 " %8s", &record.failures,
               &record.attacks, &record.locks, &left_ms, word) != 5) {
        return -EBADMSG;
    }
    record.lockdown = strcmp(word, "lockdown") == 0;
    record.remaining_ns = left_ms * ISO_NS_PER_MS;
    /* There is only one way to write a record. Any other text was not written by this program. */
    const size_t length = print_record(&record, again);
    if (left_ms < 0 || length != size || memcmp(text, again, size) != 0) {
        return -EBADMSG;
    }
    *out = record;
    return 0;
}

/* ---- format 2 ---- */

void iso_lockout_put(const struct iso_lockout_file *file, uint8_t plain[ISO_LOCKOUT_PLAIN_BYTES])
{
    const struct iso_lockout_record *record = &file->record;
    uint8_t *p = iso_put_u64(plain, file->number);
    p = iso_put_u32(p, (uint32_t)record->failures);
    p = iso_put_u32(p, (uint32_t)record->attacks);
    p = iso_put_u32(p, (uint32_t)record->locks);
    p = iso_put_u64(p, (uint64_t)remaining_ms(record));
    *p++ = record->lockdown;
    iso_heads_put(&file->known, p);
}

int iso_lockout_get(const uint8_t *plain, size_t size, struct iso_lockout_file *out)
{
    if (size != ISO_LOCKOUT_PLAIN_BYTES) {
        return -EBADMSG;
    }
    const uint32_t failures = iso_get_u32(plain + 8), attacks = iso_get_u32(plain + 12),
                   locks = iso_get_u32(plain + 16);
    const uint64_t left_ms = iso_get_u64(plain + 20);
    if (iso_get_u64(plain) == 0 || failures > INT_MAX || attacks > INT_MAX || locks > INT_MAX ||
        left_ms > INT64_MAX / ISO_NS_PER_MS || plain[28] > 1) {
        return -EBADMSG;
    }
    *out = (struct iso_lockout_file){
        .number = iso_get_u64(plain),
        .record = {.failures = (int)failures,
                   .attacks = (int)attacks,
                   .locks = (int)locks,
                   .remaining_ns = (int64_t)left_ms * ISO_NS_PER_MS,
                   .lockdown = plain[28]},
        .known = iso_heads_get(plain + 29),
    };
    return 0;
}

static int open_sealed(const uint8_t *bytes, size_t size, const struct iso_key_ring *ring,
                       struct iso_lockout_file *out)
{
    uint8_t plain[ISO_LOCKOUT_PLAIN_BYTES];
    size_t n = 0;
    const int error = iso_sealed_file_open(&kind, ring, bytes, size, plain, &n);
    return error ? error : iso_lockout_get(plain, n, out);
}

/* ---- the file ---- */

int iso_lockout_read(const char *path, const struct iso_key_ring *ring,
                     struct iso_lockout_file *out, struct iso_fault *fault)
{
    struct iso_fault why = {.text = ""};
    struct iso_lockout_file file = {.number = 0};
    void *bytes = NULL;
    size_t size = 0;
    int error = iso_data_file_read(path, FILE_MAX_BYTES, &bytes, &size, &why);
    if (error) {
        return error == -ENOENT ? error
                                : iso_fault_set_code(fault, why.code, error, "%s", why.text);
    }
    char text[TEXT_SIZE + 1] = "";
    if (iso_sealed_file_is(&kind, bytes, size)) {
        error = open_sealed(bytes, size, ring, &file);
    } else if (size <= TEXT_SIZE) {
        memcpy(text, bytes, size);
        error = iso_lockout_parse(text, size, &file.record);
    } else {
        error = -EBADMSG;
    }
    free(bytes);
    if (error) {
        return iso_fault_set_code(fault, ISO_FAULT_LOCKOUT_DAMAGED, error, "%s: damaged", path);
    }
    *out = file;
    return 0;
}

int iso_lockout_load(const char *path, const struct iso_key_ring *ring,
                     struct iso_lockout_file *out, struct iso_fault *fault)
{
    struct iso_heads_board *board = iso_key_ring_board(ring);
    struct iso_lockout_file file;
    int error = iso_lockout_read(path, ring, &file, fault);
    if (!error) {
        /* The last write may not be on the disk yet, and a power failure could still undo it. So
         * the directory is synchronised before the other stores learn of the file. */
        error = iso_directory_sync(path, fault);
    }
    if (error && error != -ENOENT) {
        return error;
    }
    if (!error) {
        iso_heads_found(board, ISO_HEAD_LOCKOUT, path, file.number);
        iso_heads_claim(board, path, &file.known);
    }
    const uint64_t needed = iso_heads_now(board).count[ISO_HEAD_LOCKOUT];
    if (error) {
        return needed == 0
                   ? error
                   : iso_fault_set_code(fault, ISO_FAULT_LOCKOUT_MISSING, -ESTALE,
                                        "%s: is gone, and the other stores know of it", path);
    }
    if (file.number < needed) {
        return iso_fault_set_code(fault, ISO_FAULT_LOCKOUT_OLD, -ESTALE, "%s: from an earlier time",
                                  path);
    }
    *out = file;
    return 0;
}

int iso_lockout_save(const char *path, const struct iso_key_ring *ring,
                     const struct iso_lockout_record *record, struct iso_fault *fault)
{
    struct iso_heads_board *board = iso_key_ring_board(ring);
    const uint32_t number = iso_key_ring_newest(ring, ISO_KEY_ANCHOR);
    struct iso_lockout_file file = {.record = *record, .known = iso_heads_now(board)};
    uint8_t plain[ISO_LOCKOUT_PLAIN_BYTES];
    file.number = file.known.count[ISO_HEAD_LOCKOUT] + 1;
    iso_lockout_put(&file, plain);
    const int error = iso_sealed_file_write(path, &kind,
                                            iso_key_ring_find(ring, ISO_KEY_ANCHOR, number), number,
                                            plain, sizeof plain, fault);
    if (error) {
        return error;
    }
    iso_heads_wrote(board, ISO_HEAD_LOCKOUT, file.number, NULL);
    return 0;
}
