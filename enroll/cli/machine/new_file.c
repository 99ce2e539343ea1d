#include "enroll/cli/machine/new_file.h"

#include <errno.h>
#include <fcntl.h>
#include <libgen.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { BACKUPS_A_SECOND = 9 };

static enum cli_exit refuse(struct cli_fault *fault, const char *path, const char *what, int error)
{
    return cli_fault_set(fault, CLI_EXIT_FAULT, "no-file", "%.150s %s: %s", path, what,
                         strerror(error));
}

/* Synchronises the folder, so that a rename is on the disk. */
static int sync_folder_of(const char *path)
{
    char copy[PATH_MAX];

    (void)snprintf(copy, sizeof copy, "%s", path);
    const int fd = open(dirname(copy), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    const int error = fd < 0 || fsync(fd) < 0 ? errno : 0;
    if (fd >= 0) {
        close(fd);
    }
    return error;
}

static int make_folder_of(const char *path)
{
    char copy[PATH_MAX];

    (void)snprintf(copy, sizeof copy, "%s", path);
    return mkdir(dirname(copy), 0755) < 0 && errno != EEXIST ? errno : 0;
}

static int write_all(int fd, const char *text)
{
    for (size_t left = strlen(text); left > 0;) {
        const ssize_t n = write(fd, text, left);
        if (n < 0 && errno != EINTR) {
            return errno;
        }
        text += n > 0 ? n : 0;
        left -= n > 0 ? (size_t)n : 0;
    }
    return 0;
}

enum cli_exit cli_new_file_write(const char *path, const char *text, struct cli_new_file *out,
                                 struct cli_fault *fault)
{
    *out = (struct cli_new_file){.placed = false};
    if (strlen(path) >= PATH_MAX - sizeof ".bak-YYYYMMDD-HHMMSS-N") {
        return refuse(fault, path, "cannot be written", ENAMETOOLONG);
    }
    (void)snprintf(out->path, sizeof out->path, "%s", path);
    int error = make_folder_of(path);
    if (error) {
        return refuse(fault, path, "cannot be written", error);
    }
    (void)snprintf(out->draft, sizeof out->draft, "%.*s.new-XXXXXX", PATH_MAX - 16, path);
    const int fd = mkostemp(out->draft, O_CLOEXEC);
    if (fd < 0) {
        error = errno;
        out->draft[0] = '\0';
        return refuse(fault, path, "cannot be written", error);
    }
    error = write_all(fd, text);
    if (!error) {
        error = fchmod(fd, 0644) < 0 || fsync(fd) < 0 ? errno : 0;
    }
    if (close(fd) < 0 && !error) {
        error = errno;
    }
    if (error) {
        cli_new_file_done(out);
        return refuse(fault, path, "cannot be written", error);
    }
    return CLI_EXIT_OK;
}

/* Links the old file to the name of the backup. Returns 0, also if there is no old file, or an
 * errno. */
static int keep_old(struct cli_new_file *file)
{
    const time_t now = time(NULL);
    struct tm parts;
    char stamp[32];

    (void)strftime(stamp, sizeof stamp, "%Y%m%d-%H%M%S", localtime_r(&now, &parts));
    for (int i = 1; i <= BACKUPS_A_SECOND; i++) {
        char number[8] = "";
        if (i > 1) {
            (void)snprintf(number, sizeof number, "-%d", i);
        }
        (void)snprintf(file->backup, sizeof file->backup, "%.*s.bak-%s%s", PATH_MAX - 48,
                       file->path, stamp, number);
        if (link(file->path, file->backup) == 0) {
            return 0;
        }
        const int error = errno;
        file->backup[0] = '\0';
        if (error != EEXIST) {
            return error == ENOENT ? 0 : error;
        }
    }
    return EEXIST;
}

enum cli_exit cli_new_file_place(struct cli_new_file *file, struct cli_fault *fault)
{
    int error = keep_old(file);

    if (error) {
        return refuse(fault, file->path, "cannot be kept under another name", error);
    }
    if (rename(file->draft, file->path) < 0) {
        error = errno;
        if (file->backup[0]) {
            (void)unlink(file->backup);
            file->backup[0] = '\0';
        }
        return refuse(fault, file->path, "cannot be replaced", error);
    }
    file->draft[0] = '\0';
    file->placed = true;
    error = sync_folder_of(file->path);
    return error ? refuse(fault, file->path, "may not be on the disk yet", error) : CLI_EXIT_OK;
}

enum cli_exit cli_new_file_undo(struct cli_new_file *file, struct cli_fault *fault)
{
    const bool had_old = file->backup[0] != '\0';

    if (!file->placed) {
        return CLI_EXIT_OK;
    }
    if ((had_old ? rename(file->backup, file->path) : unlink(file->path)) < 0) {
        const int error = errno;
        char what[PATH_MAX + 64];
        (void)snprintf(what, sizeof what, "cannot be put back%s%s", had_old ? " from " : "",
                       file->backup);
        return refuse(fault, file->path, what, error);
    }
    file->placed = false;
    file->backup[0] = '\0';
    const int error = sync_folder_of(file->path);
    return error ? refuse(fault, file->path, "may not be on the disk yet", error) : CLI_EXIT_OK;
}

void cli_new_file_done(struct cli_new_file *file)
{
    if (file->draft[0]) {
        (void)unlink(file->draft);
        file->draft[0] = '\0';
    }
}
