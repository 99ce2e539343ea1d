#include "firmware/keys/sealed_file.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/bytes.h"
#include "drivers/file/data_file.h"
#include "drivers/file/directory.h"
#include "drivers/file/storage_fault.h"

enum { MAGIC_BYTES = 8, HEAD_BYTES = ISO_SEALED_FILE_HEAD_BYTES };

static struct iso_seal_label label_of(const struct iso_sealed_file *kind, uint32_t number)
{
    struct iso_seal_label label = iso_seal_label_of(kind->kind);
    iso_seal_label_number(&label, number);
    return label;
}

bool iso_sealed_file_is(const struct iso_sealed_file *kind, const void *bytes, size_t size)
{
    return size >= MAGIC_BYTES && memcmp(bytes, kind->magic, MAGIC_BYTES) == 0;
}

int iso_sealed_file_open(const struct iso_sealed_file *kind, const struct iso_key_ring *ring,
                         const void *bytes, size_t size, void *plain, size_t *plain_size)
{
    const uint8_t *p = bytes;
    if (!iso_sealed_file_is(kind, bytes, size) ||
        size < HEAD_BYTES + ISO_SEAL_OVERHEAD + kind->plain_min ||
        size > HEAD_BYTES + ISO_SEAL_OVERHEAD + kind->plain_max) {
        return -EBADMSG;
    }
    const uint32_t number = iso_get_u32(p + MAGIC_BYTES);
    const struct iso_seal_key *key = iso_key_ring_find(ring, kind->use, number);
    const struct iso_seal_label label = label_of(kind, number);
    if (!key || iso_seal_open(key, &label, p + HEAD_BYTES, size - HEAD_BYTES, plain)) {
        return -EBADMSG;
    }
    *plain_size = size - HEAD_BYTES - ISO_SEAL_OVERHEAD;
    return 0;
}

int iso_sealed_file_read(const char *path, const struct iso_sealed_file *kind,
                         const struct iso_key_ring *ring, void *plain, size_t *plain_size,
                         struct iso_fault *fault)
{
    struct iso_fault why = {.text = ""};
    void *bytes = NULL;
    size_t size = 0;
    int error = iso_data_file_read(path, HEAD_BYTES + ISO_SEAL_OVERHEAD + kind->plain_max, &bytes,
                                   &size, &why);
    if (error) {
        return error == -ENOENT ? error
                                : iso_fault_set_code(fault, why.code, error, "%s", why.text);
    }
    error = iso_sealed_file_open(kind, ring, bytes, size, plain, plain_size);
    free(bytes);
    return error;
}

/* Writes the bytes of the file, which may have been written in spite of an error. */
static int replace(const char *path, const uint8_t *bytes, size_t size, struct iso_fault *fault)
{
    struct iso_fault why = {.text = ""};
    const int error = iso_data_file_replace(path, bytes, size, &why);
    if (error && iso_data_file_holds(path, bytes, size)) {
        return iso_directory_sync(path, fault);
    }
    if (iso_storage_is_refusal(error)) {
        return iso_storage_refused(path, error, fault);
    }
    return error ? iso_fault_set_code(fault, why.code, error, "%s: cannot be written: %s", path,
                                      why.text[0] ? why.text : strerror(-error))
                 : 0;
}

int iso_sealed_file_write(const char *path, const struct iso_sealed_file *kind,
                          const struct iso_seal_key *key, uint32_t number, const void *plain,
                          size_t size, struct iso_fault *fault)
{
    const struct iso_seal_label label = label_of(kind, number);
    uint8_t *bytes = malloc(HEAD_BYTES + ISO_SEAL_OVERHEAD + size);
    if (!bytes) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", path);
    }
    memcpy(bytes, kind->magic, MAGIC_BYTES);
    (void)iso_put_u32(bytes + MAGIC_BYTES, number);
    iso_seal_close(key, &label, plain, size, bytes + HEAD_BYTES);
    const int error = replace(path, bytes, HEAD_BYTES + ISO_SEAL_OVERHEAD + size, fault);
    free(bytes);
    return error;
}
