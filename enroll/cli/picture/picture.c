#include "enroll/cli/picture/picture.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "firmware/contract/contract.h"

/* The daemon's pictures have at most 320x240 grey pixels. */
enum { PICTURE_BYTES_MAX = 1 << 20 };

/* ---- receiving ---- */

/* Reads the whole file from its start, because the daemon may have moved the offset. */
static int read_whole(int fd, uint8_t **png, size_t *size)
{
    struct stat status;
    if (fstat(fd, &status)) {
        return -errno;
    }
    if (!S_ISREG(status.st_mode) || status.st_size < 1 || status.st_size > PICTURE_BYTES_MAX) {
        return -EBADMSG;
    }
    const size_t length = (size_t)status.st_size;
    uint8_t *bytes = malloc(length);
    if (!bytes) {
        return -ENOMEM;
    }
    if (pread(fd, bytes, length, 0) != (ssize_t)length) {
        free(bytes);
        return -EBADMSG;
    }
    *png = bytes;
    *size = length;
    return 0;
}

static enum cli_exit ask(struct cli_daemon *daemon, uint8_t **png, size_t *size,
                         struct cli_fault *fault)
{
    sd_bus_message *reply = NULL;
    int fd = -1;
    enum cli_exit exit = cli_daemon_call(daemon, ISO_CONTRACT_PICTURE, &reply, fault);

    if (exit) {
        return exit;
    }
    int r = sd_bus_message_read(reply, "h", &fd);
    /* The descriptor is closed with the reply. */
    if (r >= 0) {
        r = read_whole(fd, png, size);
    }
    if (r < 0) {
        exit = cli_daemon_bad_reply(r, ISO_CONTRACT_PICTURE, fault);
    }
    sd_bus_message_unref(reply);
    return exit;
}

enum cli_exit cli_picture_take(struct cli_daemon *daemon, uint8_t **png, size_t *size,
                               struct cli_fault *fault)
{
    struct cli_fault ignored;
    enum cli_exit exit = cli_daemon_call(daemon, ISO_CONTRACT_CLAIM, NULL, fault);

    if (exit) {
        return exit;
    }
    exit = ask(daemon, png, size, fault);
    (void)!cli_daemon_call(daemon, ISO_CONTRACT_RELEASE, NULL, &ignored);
    return exit;
}

/* ---- saving ---- */

static enum cli_exit file_fault(struct cli_fault *fault, const char *path, int error)
{
    return cli_fault_set(fault, error == ENOENT ? CLI_EXIT_NOT_FOUND : CLI_EXIT_FAULT, "file",
                         "%s: %s", path, strerror(error));
}

/* Returns 0, or the errno of the call that failed. An incomplete write means that the disk is
 * full. */
static int write_whole(int fd, const uint8_t *png, size_t size)
{
    const ssize_t written = write(fd, png, size);
    if (written < 0) {
        return errno;
    }
    return (size_t)written < size ? ENOSPC : 0;
}

/* The mode is set explicitly, because a file that existed before may be readable for others. */
enum cli_exit cli_picture_save(const char *path, const uint8_t *png, size_t size,
                               struct cli_fault *fault)
{
    const int fd = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0600);
    if (fd < 0) {
        return file_fault(fault, path, errno);
    }
    struct stat status;
    int error = fstat(fd, &status) ? errno : 0;
    const bool regular = !error && S_ISREG(status.st_mode);
    if (!error) {
        error = regular && fchmod(fd, 0600) != 0 ? errno : write_whole(fd, png, size);
    }
    if (close(fd) && !error) {
        error = errno;
    }
    if (error) {
        if (regular) {
            (void)unlink(path);
        }
        return file_fault(fault, path, error);
    }
    return CLI_EXIT_OK;
}
