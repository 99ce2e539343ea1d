#include "enroll/hub/store/hub_keys.h"

#include <errno.h>
#include <fcntl.h>
#include <sodium.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/base/bytes.h"
#include "drivers/file/directory.h"
#include "drivers/file/file.h"
#include "drivers/file/storage_fault.h"

static const char magic[8] = "ISOHKEYS";

enum {
    VERSION = 1,
    NONCE_BYTES = crypto_aead_xchacha20poly1305_ietf_NPUBBYTES,
    TAG_BYTES = crypto_aead_xchacha20poly1305_ietf_ABYTES,
    CONTENT_BYTES = sizeof magic + 4 + 32 + 64 + 32 + 32 + 32,
    FILE_BYTES = CONTENT_BYTES + ISO_FLEET_DIGEST_BYTES,
};

static void put_keys(struct iso_fleet_bytes *out, const struct hub_keys *keys)
{
    uint8_t digest[ISO_FLEET_DIGEST_BYTES];
    iso_fleet_put(out, magic, sizeof magic);
    iso_fleet_put_u32(out, VERSION);
    iso_fleet_put(out, keys->signs.public, sizeof keys->signs.public);
    iso_fleet_put(out, keys->signs.secret, sizeof keys->signs.secret);
    iso_fleet_put(out, keys->receives.public, sizeof keys->receives.public);
    iso_fleet_put(out, keys->receives.secret, sizeof keys->receives.secret);
    iso_fleet_put(out, keys->storage, sizeof keys->storage);
    iso_fleet_digest(out->bytes, out->size, digest);
    iso_fleet_put(out, digest, sizeof digest);
}

/* Writes a new file; a file that was not written whole is removed. */
static int write_new(const char *path, const void *bytes, size_t size, struct iso_fault *fault)
{
    int fd = -1;
    int error = iso_file_open(path, O_WRONLY | O_CREAT | O_EXCL, ISO_FILE_ANY_SIZE, &fd, fault);
    if (error) {
        return error;
    }
    const ssize_t written = write(fd, bytes, size);
    if (written != (ssize_t)size || fsync(fd)) {
        error = iso_storage_refused(path, written < 0 || errno ? -errno : -EIO, fault);
    }
    (void)close(fd);
    if (error) {
        (void)unlink(path);
        return error;
    }
    return iso_directory_sync(path, fault);
}

int hub_keys_make(const char *path, struct hub_keys *out, struct iso_fault *fault)
{
    struct hub_keys keys;
    struct iso_fleet_bytes file = {.bytes = NULL};
    int error = iso_fleet_start(fault);
    if (error) {
        return error;
    }
    (void)crypto_sign_keypair(keys.signs.public, keys.signs.secret);
    (void)crypto_box_keypair(keys.receives.public, keys.receives.secret);
    randombytes_buf(keys.storage, sizeof keys.storage);
    uint8_t *room = iso_fleet_bytes_room(&file, FILE_BYTES);
    file.size = 0;
    if (room) {
        put_keys(&file, &keys);
        error = write_new(path, file.bytes, file.size, fault);
    } else {
        error = iso_fault_set(fault, -ENOMEM, "%s: no memory", path);
    }
    if (!error) {
        *out = keys;
    }
    iso_fleet_bytes_free(&file);
    hub_keys_wipe(&keys);
    return error;
}

/* Others than the owner may neither read nor write the file. */
static int check_mode(const char *path, struct iso_fault *fault)
{
    struct stat s;
    if (lstat(path, &s)) {
        return iso_file_fault(path, -errno, fault);
    }
    if (s.st_mode & 077) {
        return iso_fault_set(fault, -EACCES,
                             "%s: others than its owner may use these keys (mode %04o, must be "
                             "0600)",
                             path, (unsigned)(s.st_mode & 07777));
    }
    return 0;
}

static int take_keys(const char *path, const void *bytes, size_t size, struct hub_keys *keys,
                     struct iso_fault *fault)
{
    uint8_t digest[ISO_FLEET_DIGEST_BYTES];
    struct iso_fleet_reader in = {.bytes = bytes, .left = size};
    const uint8_t *begin = iso_fleet_take(&in, sizeof magic);
    if (!begin || memcmp(begin, magic, sizeof magic) != 0) {
        return iso_fault_set(fault, -EBADMSG, "%s: this is no file of a hub's keys", path);
    }
    if (iso_fleet_take_u32(&in) != VERSION) {
        return iso_fault_set(fault, -EPROTONOSUPPORT, "%s: the keys are of a newer version", path);
    }
    iso_fleet_digest(bytes, size < CONTENT_BYTES ? size : CONTENT_BYTES, digest);
    if (size != FILE_BYTES ||
        memcmp((const uint8_t *)bytes + CONTENT_BYTES, digest, sizeof digest) != 0) {
        return iso_fault_set(fault, -EBADMSG, "%s: the keys are damaged", path);
    }
    iso_fleet_take_bytes(&in, keys->signs.public, sizeof keys->signs.public);
    iso_fleet_take_bytes(&in, keys->signs.secret, sizeof keys->signs.secret);
    iso_fleet_take_bytes(&in, keys->receives.public, sizeof keys->receives.public);
    iso_fleet_take_bytes(&in, keys->receives.secret, sizeof keys->receives.secret);
    iso_fleet_take_bytes(&in, keys->storage, sizeof keys->storage);
    return 0;
}

int hub_keys_read(const char *path, struct hub_keys *out, struct iso_fault *fault)
{
    struct hub_keys keys;
    char *bytes = NULL;
    size_t size = 0;
    int error = iso_fleet_start(fault);
    error = error ? error : iso_file_read(path, FILE_BYTES, &bytes, &size, fault);
    if (error) {
        return error;
    }
    error = check_mode(path, fault);
    error = error ? error : take_keys(path, bytes, size, &keys, fault);
    if (!error) {
        *out = keys;
        hub_keys_wipe(&keys);
    }
    sodium_memzero(bytes, size);
    free(bytes);
    return error;
}

void hub_keys_wipe(struct hub_keys *keys)
{
    sodium_memzero(keys, sizeof *keys);
}

/* What is bound to sealed bytes: whose they are, then what they are. */
static size_t bind(const char *use, const struct iso_fleet_id *owner, uint8_t bound[64])
{
    const size_t length = strnlen(use, 64 - sizeof owner->bytes);
    memcpy(bound, owner->bytes, sizeof owner->bytes);
    memcpy(bound + sizeof owner->bytes, use, length);
    return sizeof owner->bytes + length;
}

int hub_keys_seal(const struct hub_keys *keys, const char *use, const struct iso_fleet_id *owner,
                  const void *plain, size_t size, struct iso_fleet_bytes *out)
{
    uint8_t bound[64];
    const size_t bound_size = bind(use, owner, bound);
    uint8_t *room = iso_fleet_bytes_room(out, NONCE_BYTES + size + TAG_BYTES);
    if (!room) {
        return -ENOMEM;
    }
    randombytes_buf(room, NONCE_BYTES);
    (void)crypto_aead_xchacha20poly1305_ietf_encrypt(room + NONCE_BYTES, NULL, plain, size, bound,
                                                     bound_size, NULL, room, keys->storage);
    return 0;
}

int hub_keys_open(const struct hub_keys *keys, const char *use, const struct iso_fleet_id *owner,
                  const void *sealed, size_t size, struct iso_fleet_bytes *out)
{
    uint8_t bound[64];
    const size_t bound_size = bind(use, owner, bound);
    const uint8_t *bytes = sealed;
    struct iso_fleet_bytes plain = {.bytes = NULL};
    if (size < NONCE_BYTES + TAG_BYTES) {
        return -EKEYREJECTED;
    }
    /* One byte more, so that the room of empty contents exists. */
    uint8_t *room = iso_fleet_bytes_room(&plain, size - NONCE_BYTES - TAG_BYTES + 1);
    if (!room) {
        return -ENOMEM;
    }
    if (crypto_aead_xchacha20poly1305_ietf_decrypt(room, NULL, NULL, bytes + NONCE_BYTES,
                                                   size - NONCE_BYTES, bound, bound_size, bytes,
                                                   keys->storage)) {
        iso_fleet_bytes_free(&plain);
        return -EKEYREJECTED;
    }
    plain.size--;
    *out = plain;
    return 0;
}
