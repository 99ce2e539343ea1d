#include "firmware/lockout_file.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "core/math/crc32.h"
#include "drivers/file/file.h"
#include "firmware/data_file.h"
#include "firmware/directory.h"
#include "firmware/storage_fault.h"
#include "firmware/times.h"

enum { TEXT_SIZE = 160 };

static size_t print(const struct iso_lockout_record *record, char text[TEXT_SIZE])
{
    /* Rounded up: a lock of which anything is left is still one. */
    const int64_t remaining_ms = (record->remaining_ns + ISO_NS_PER_MS - 1) / ISO_NS_PER_MS;
    int n = snprintf(text, TEXT_SIZE, "isotherm-lockout 1 %d %d %d %" PRId64 " %s ",
                     record->failures, record->attacks, record->locks, remaining_ms,
                     record->lockdown ? "lockdown" : "open");
    const uint32_t crc = iso_crc32(0, text, (size_t)n);
    n += snprintf(text + n, TEXT_SIZE - (size_t)n, "%08" PRIx32 "\n", crc);
    return (size_t)n;
}

int iso_lockout_parse(const char *text, size_t size, struct iso_lockout_record *out)
{
    struct iso_lockout_record record;
    char word[9], again[TEXT_SIZE];
    int64_t remaining_ms;
    if (size >= TEXT_SIZE || strlen(text) != size ||
        sscanf(text, "isotherm-lockout 1 %9d %9d %9d %12" SCNd64 " %8s", &record.failures,
               &record.attacks, &record.locks, &remaining_ms, word) != 5) {
        return -EBADMSG;
    }
    record.lockdown = strcmp(word, "lockdown") == 0;
    record.remaining_ns = remaining_ms * ISO_NS_PER_MS;
    /* There is one way to write a record: what is not written so was not written by us. */
    const size_t length = print(&record, again);
    if (remaining_ms < 0 || length != size || memcmp(text, again, size) != 0) {
        return -EBADMSG;
    }
    *out = record;
    return 0;
}

int iso_lockout_load(const char *path, struct iso_lockout_record *out, struct iso_fault *fault)
{
    struct iso_fault why = {""};
    void *bytes = NULL;
    size_t size = 0;
    int error = iso_data_file_read(path, TEXT_SIZE, &bytes, &size, &why);
    if (error == -ENOENT) {
        return error;
    }
    if (error) {
        return iso_fault_set(fault, error, "%s", why.text);
    }
    char text[TEXT_SIZE + 1] = "";
    memcpy(text, bytes, size);
    free(bytes);
    error = iso_lockout_parse(text, size, out);
    return error ? iso_fault_set(fault, error, "%s: damaged", path) : 0;
}

static int write_file(const char *path, const char *text, size_t size, struct iso_fault *fault)
{
    int fd = -1;
    int error = iso_file_open(path, O_WRONLY | O_CREAT | O_TRUNC, ISO_FILE_ANY_SIZE, &fd, fault);
    if (error) {
        return error;
    }
    const ssize_t n = write(fd, text, size);
    error = n < 0 ? -errno : (size_t)n < size ? -ENOSPC : 0;
    if (!error && fdatasync(fd)) {
        error = -errno;
    }
    if (close(fd) && !error) {
        error = -errno;
    }
    return error;
}

int iso_lockout_save(const char *path, const struct iso_lockout_record *record,
                     struct iso_fault *fault)
{
    char text[TEXT_SIZE], beside[PATH_MAX];
    const size_t size = print(record, text);
    const int n = snprintf(beside, sizeof beside, "%s.new", path);
    if (n < 0 || (size_t)n >= sizeof beside) {
        return iso_fault_set(fault, -ENAMETOOLONG, "%s: the name is too long", path);
    }
    struct iso_fault why = {""};
    int error = write_file(beside, text, size, &why);
    if (!error && rename(beside, path)) {
        error = -errno;
    }
    if (error && !iso_data_file_holds(path, text, size)) { /* it may be there nevertheless */
        (void)unlink(beside);
        return iso_storage_is_refusal(error)
                   ? iso_storage_refused(path, error, fault)
                   : iso_fault_set(fault, error, "%s: cannot be written: %s", path,
                                   why.text[0] ? why.text : strerror(-error));
    }
    return iso_directory_sync(path, fault);
}
