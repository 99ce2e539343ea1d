#include "enroll/hub/update/update_keep.h"

#include <errno.h>
#include <fcntl.h>
#include <gnutls/pkcs7.h>
#include <ini.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "drivers/file/directory.h"
#include "drivers/file/file.h"

enum {
    MESSAGE_BYTES_MAX = 1 << 20, /* certificates and manifest have some kilobytes */
    MANIFEST_BYTES_MAX = 64 << 10,
    PIECE_BYTES = 1 << 16,
};

static int no_bundle(const char *path, const char *why, struct iso_fault *fault)
{
    return iso_fault_set(fault, -EBADMSG, "%s: is no update: %s", path, why);
}

/* ---- the manifest ---- */

static bool read_at(int fd, void *out, size_t n, uint64_t at)
{
    for (size_t done = 0; done < n;) {
        const ssize_t r = pread(fd, (char *)out + done, n - done, (off_t)(at + done));
        if (r == 0 || (r < 0 && errno != EINTR)) {
            return false;
        }
        done += r > 0 ? (size_t)r : 0;
    }
    return true;
}

/* The CMS message at the end of the file, which the caller frees; NULL: there is none. */
static uint8_t *read_message(int fd, uint64_t file_size, size_t *size)
{
    uint8_t tail[8];
    uint64_t length = 0;
    if (file_size < sizeof tail || !read_at(fd, tail, sizeof tail, file_size - sizeof tail)) {
        return NULL;
    }
    for (size_t i = 0; i < sizeof tail; i++) {
        length = length << 8 | tail[i];
    }
    if (length == 0 || length > MESSAGE_BYTES_MAX || length > file_size - sizeof tail) {
        return NULL;
    }
    uint8_t *bytes = malloc(length);
    if (bytes && !read_at(fd, bytes, length, file_size - sizeof tail - length)) {
        free(bytes);
        return NULL;
    }
    *size = length;
    return bytes;
}

/* The manifest as a text, which the caller frees; NULL: the message has none. */
static char *read_manifest(const uint8_t *message, size_t size)
{
    const gnutls_datum_t bytes = {.data = (unsigned char *)(uintptr_t)message,
                                  .size = (unsigned)size};
    gnutls_datum_t embedded = {.data = NULL};
    gnutls_pkcs7_t cms = NULL;
    char *text = NULL;
    if (gnutls_pkcs7_init(&cms) == 0 &&
        gnutls_pkcs7_import(cms, &bytes, GNUTLS_X509_FMT_DER) == 0 &&
        gnutls_pkcs7_get_embedded_data(cms, 0, &embedded) == 0 && embedded.size > 0 &&
        embedded.size <= MANIFEST_BYTES_MAX) {
        text = strndup((const char *)embedded.data, embedded.size);
    }
    gnutls_free(embedded.data);
    if (cms) {
        gnutls_pkcs7_deinit(cms);
    }
    return text;
}

struct names {
    char *version, *board;
};

static int take(void *context, const char *section, const char *name, const char *value)
{
    const struct names *names = context;
    char *out = strcmp(name, "version") == 0      ? names->version
                : strcmp(name, "compatible") == 0 ? names->board
                                                  : NULL;
    if (strcmp(section, "update") == 0 && out && iso_fleet_update_word_is_good(value)) {
        (void)snprintf(out, ISO_FLEET_UPDATE_WORD_SIZE, "%s", value);
    }
    return 1;
}

/* Opens the file and reads its manifest; the caller closes *fd. */
static int open_bundle(const char *path, int *fd, struct hub_update_file *file,
                       struct iso_fault *fault)
{
    const struct names names = {file->version, file->board};
    struct stat s;
    size_t size = 0;
    int error = iso_file_open(path, O_RDONLY, ISO_FLEET_UPDATE_BYTES_MAX, fd, fault);
    if (error) {
        return error;
    }
    file->size = fstat(*fd, &s) ? 0 : (uint64_t)s.st_size;
    uint8_t *message = read_message(*fd, file->size, &size);
    char *manifest = message ? read_manifest(message, size) : NULL;
    if (!message || !manifest) {
        error = no_bundle(path, "it has no signed manifest of RAUC", fault);
    } else if (ini_parse_string(manifest, take, (void *)(uintptr_t)&names) != 0) {
        error = no_bundle(path, "its manifest cannot be read", fault);
    } else if (!*file->version || !*file->board) {
        error = no_bundle(path, "its manifest names no version or no board", fault);
    }
    free(message);
    free(manifest);
    if (error) {
        (void)close(*fd);
    }
    return error;
}

int hub_update_read(const char *path, char version[ISO_FLEET_UPDATE_WORD_SIZE],
                    char board[ISO_FLEET_UPDATE_WORD_SIZE], struct iso_fault *fault)
{
    struct hub_update_file file = {.size = 0};
    int fd = -1;
    const int error = open_bundle(path, &fd, &file, fault);
    if (!error) {
        memcpy(version, file.version, sizeof file.version);
        memcpy(board, file.board, sizeof file.board);
        (void)close(fd);
    }
    return error;
}

/* ---- the copy ---- */

static int write_all(int fd, const uint8_t *bytes, size_t size)
{
    for (size_t done = 0; done < size;) {
        const ssize_t n = write(fd, bytes + done, size - done);
        if (n < 0 && errno != EINTR) {
            return -errno;
        }
        done += n > 0 ? (size_t)n : 0;
    }
    return 0;
}

/* Copies the whole file and computes its digest. -ESTALE it has changed meanwhile. */
static int copy(int from, int to, struct hub_update_file *file)
{
    static uint8_t piece[PIECE_BYTES];
    crypto_hash_sha256_state state;
    int error = 0;
    (void)crypto_hash_sha256_init(&state);
    for (uint64_t at = 0; !error && at < file->size;) {
        const uint64_t left = file->size - at;
        const size_t n = left < sizeof piece ? (size_t)left : sizeof piece;
        if (!read_at(from, piece, n, at)) {
            return -ESTALE;
        }
        (void)crypto_hash_sha256_update(&state, piece, n);
        error = write_all(to, piece, n);
        at += n;
    }
    (void)crypto_hash_sha256_final(&state, file->sha256);
    return error ? error : fsync(to) ? -errno : 0;
}

/* Puts a copy into its place, where it stays if the row cannot be stored: the same file may be
 * there already for another row, and the next attempt uses it. */
static int place(struct hub_store *store, int from, struct hub_update_file *file,
                 struct iso_fault *fault)
{
    char path[HUB_UPDATE_PATH_SIZE], made[HUB_UPDATE_PATH_SIZE];
    if (mkdir(store->updates, 0700) && errno != EEXIST) {
        return iso_file_fault(store->updates, -errno, fault);
    }
    (void)snprintf(made, sizeof made, "%s/.new.XXXXXX", store->updates);
    const int to = mkstemp(made);
    if (to < 0) {
        return iso_file_fault(store->updates, -errno, fault);
    }
    int error = copy(from, to, file);
    hub_update_path(store, file->sha256, path);
    if (close(to) && !error) {
        error = -errno;
    }
    if (!error && rename(made, path)) {
        error = -errno;
    }
    if (error) {
        (void)unlink(made);
        return iso_file_fault(made, error, fault);
    }
    return iso_directory_sync(path, fault);
}

/* Ends the list at a file of the same version and board. */
static int is_same(void *context, const struct hub_update_file *file)
{
    const struct hub_update_file *other = context;
    return strcmp(file->version, other->version) == 0 && strcmp(file->board, other->board) == 0;
}

/* Before the copy, so that a file that is refused does not stay in the folder. */
static int check_new(struct hub_store *store, struct hub_update_file *file, struct iso_fault *fault)
{
    const int found = hub_update_each(store, is_same, file, fault);
    return found > 0 ? iso_fault_set(fault, -EEXIST, "version %s for the board %s is here already",
                                     file->version, file->board)
                     : found;
}

int hub_update_keep(struct hub_store *store, const char *path, struct hub_update_file *out,
                    struct iso_fault *fault)
{
    struct hub_update_file file = {.added_s = store->now_s()};
    int fd = -1;
    int error = open_bundle(path, &fd, &file, fault);
    if (error) {
        return error;
    }
    error = check_new(store, &file, fault);
    error = error ? error : place(store, fd, &file, fault);
    (void)close(fd);
    error = error ? error : hub_update_add(store, &file, fault);
    if (!error) {
        *out = file;
    }
    return error;
}
