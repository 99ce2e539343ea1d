#include "firmware/daemon/reader_key.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "drivers/door/osdp/osdp_secure.h"
#include "drivers/file/file.h"

enum { DIGITS = 2 * ISO_OSDP_KEY_BYTES, FILE_MAX_BYTES = DIGITS + 2 };

static int check_owner(const char *path, int fd, uid_t owner, struct iso_fault *fault)
{
    struct stat status;
    if (fstat(fd, &status)) {
        return iso_file_fault(path, -errno, fault);
    }
    if (status.st_uid != owner) {
        return iso_fault_set(fault, -EPERM, "%s: belongs to user %u, not to user %u", path,
                             (unsigned)status.st_uid, (unsigned)owner);
    }
    if (status.st_mode & (S_IWGRP | S_IRWXO)) {
        return iso_fault_set(fault, -EPERM,
                             "%s: others than its owner and group may read it, or "
                             "its group may write it",
                             path);
    }
    return 0;
}

/* The value of a digit, or -1. */
static int value_of(char digit)
{
    return digit >= '0' && digit <= '9'   ? digit - '0'
           : digit >= 'a' && digit <= 'f' ? digit - 'a' + 10
           : digit >= 'A' && digit <= 'F' ? digit - 'A' + 10
                                          : -1;
}

/* Whether everyone knows such a key. */
static bool is_known(const uint8_t *key)
{
    bool equal = true;
    for (size_t i = 1; i < ISO_OSDP_KEY_BYTES; i++) {
        equal = equal && key[i] == key[0];
    }
    return equal || memcmp(key, iso_osdp_default_key, ISO_OSDP_KEY_BYTES) == 0;
}

/* Reads a line of n bytes, which may end with a newline. Returns whether it is a key. */
static bool parse(const char *text, size_t n, uint8_t key[ISO_OSDP_KEY_BYTES])
{
    n -= n > 0 && text[n - 1] == '\n';
    n -= n > 0 && text[n - 1] == '\r';
    if (n != DIGITS) {
        return false;
    }
    for (size_t i = 0; i < ISO_OSDP_KEY_BYTES; i++) {
        const int high = value_of(text[2 * i]), low = value_of(text[2 * i + 1]);
        if (high < 0 || low < 0) {
            return false;
        }
        key[i] = (uint8_t)(high << 4 | low);
    }
    return true;
}

static int read_key(const char *path, int fd, uint8_t key[ISO_OSDP_KEY_BYTES],
                    struct iso_fault *fault)
{
    char text[FILE_MAX_BYTES + 1];
    uint8_t found[ISO_OSDP_KEY_BYTES];
    int error = 0;
    const ssize_t n = read(fd, text, sizeof text);
    if (n < 0) {
        error = iso_file_fault(path, -errno, fault);
    } else if (!parse(text, (size_t)n, found)) {
        error = iso_fault_set(fault, -EBADMSG, "%s: is not one line of %d hexadecimal digits", path,
                              (int)DIGITS);
    } else if (is_known(found)) {
        error = iso_fault_set(fault, -EBADMSG, "%s: everyone knows this key", path);
    } else {
        memcpy(key, found, sizeof found);
    }
    explicit_bzero(text, sizeof text);
    explicit_bzero(found, sizeof found);
    return error;
}

int iso_reader_key_read(const char *path, uid_t owner, uint8_t key[ISO_OSDP_KEY_BYTES],
                        struct iso_fault *fault)
{
    int fd = -1;
    int error = iso_file_open(path, O_RDONLY, FILE_MAX_BYTES, &fd, fault);
    if (error) {
        return error;
    }
    error = check_owner(path, fd, owner, fault);
    error = error ? error : read_key(path, fd, key, fault);
    (void)close(fd);
    return error;
}
