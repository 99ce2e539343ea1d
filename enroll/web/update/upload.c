#include "enroll/web/update/upload.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

#include "drivers/file/disk_room.h"

#define PART    "bundle.part"
#define BUNDLE  "bundle.raucb"
#define RESTART "restart"
#define TAKEN   "page.raucb"

static void path_of(const struct web_upload *upload, const char *name, char path[PATH_MAX])
{
    (void)snprintf(path, PATH_MAX, "%s/page/%s", upload->folder, name);
}

void web_upload_init(struct web_upload *upload, const char *folder)
{
    *upload = (struct web_upload){.folder = folder, .fd = -1};
}

bool web_upload_is_possible(const struct web_upload *upload)
{
    struct stat status;
    char path[PATH_MAX];

    path_of(upload, "", path);
    return stat(path, &status) == 0 && S_ISDIR(status.st_mode);
}

bool web_upload_is_coming(const struct web_upload *upload)
{
    return upload->fd >= 0;
}

/* The unit has still to take the bundle, or has taken it and has not done with it. */
bool web_upload_is_handed_over(const struct web_upload *upload)
{
    struct stat status;
    char given[PATH_MAX], taken[PATH_MAX];

    path_of(upload, BUNDLE, given);
    (void)snprintf(taken, sizeof taken, "%s/" TAKEN, upload->folder);
    return lstat(given, &status) == 0 || lstat(taken, &status) == 0;
}

uint64_t web_upload_room(const struct web_upload *upload)
{
    char path[PATH_MAX];

    path_of(upload, "", path);
    const uint64_t room = iso_disk_room(path);
    return room < WEB_UPLOAD_MOST_BYTES ? room : WEB_UPLOAD_MOST_BYTES;
}

/* A bundle is no secret, and root reads it by its rights; others need not. */
static int open_part(struct web_upload *upload)
{
    char path[PATH_MAX];

    path_of(upload, PART, path);
    upload->fd = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC, 0600);
    return upload->fd < 0 ? -errno : 0;
}

int web_upload_begin(struct web_upload *upload, const void *owner, uint64_t size)
{
    if (!web_upload_is_possible(upload)) {
        return -ENOENT;
    }
    if (web_upload_is_coming(upload) || web_upload_is_handed_over(upload)) {
        return -EBUSY;
    }
    if (size > web_upload_room(upload)) {
        return -ENOSPC;
    }
    upload->size = size;
    upload->received = 0;
    upload->owner = owner;
    return open_part(upload);
}

int web_upload_take(struct web_upload *upload, const void *bytes, size_t size)
{
    const char *from = bytes;

    if (size > upload->size - upload->received) {
        return -EMSGSIZE;
    }
    upload->received += size;
    while (size > 0) {
        const ssize_t n = write(upload->fd, from, size);
        if (n < 0 && errno != EINTR) {
            return -errno;
        }
        from += n < 0 ? 0 : n;
        size -= n < 0 ? 0 : (size_t)n;
    }
    return 0;
}

bool web_upload_is_complete(const struct web_upload *upload)
{
    return upload->fd >= 0 && upload->received == upload->size;
}

static int end(struct web_upload *upload)
{
    const int r = close(upload->fd);

    upload->fd = -1;
    upload->owner = NULL;
    return r < 0 ? -errno : 0;
}

static void remove_part(const struct web_upload *upload)
{
    char path[PATH_MAX];

    path_of(upload, PART, path);
    (void)unlink(path);
}

int web_upload_hand_over(struct web_upload *upload)
{
    char from[PATH_MAX], to[PATH_MAX];
    int r = end(upload);

    path_of(upload, PART, from);
    path_of(upload, BUNDLE, to);
    if (r == 0 && rename(from, to) < 0) {
        r = -errno;
    }
    if (r < 0) {
        remove_part(upload);
    }
    return r;
}

void web_upload_drop(struct web_upload *upload, const void *owner)
{
    if (upload->fd >= 0 && upload->owner == owner) {
        (void)end(upload);
        remove_part(upload);
    }
}

int web_upload_wish_restart(const struct web_upload *upload)
{
    char path[PATH_MAX];

    path_of(upload, RESTART, path);
    const int fd = open(path, O_WRONLY | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0600);
    return fd < 0 || close(fd) < 0 ? -errno : 0;
}
