#include "drivers/file/disk_wait.h"

#include <errno.h>
#include <stdatomic.h>
#include <unistd.h>

static atomic_bool lasts;
static _Thread_local bool watched;
static _Thread_local int depth;

void iso_disk_wait_watch(void)
{
    watched = true;
}

void iso_disk_wait_begin(void)
{
    if (depth++ == 0 && watched) {
        atomic_store(&lasts, true);
    }
}

void iso_disk_wait_end(void)
{
    if (--depth == 0 && watched) {
        atomic_store(&lasts, false);
    }
}

bool iso_disk_wait_lasts(void)
{
    return atomic_load(&lasts);
}

static int wait_for(int (*sync)(int fd), int fd)
{
    iso_disk_wait_begin();
    const int result = sync(fd);
    const int error = errno;
    iso_disk_wait_end();
    errno = error;
    return result;
}

int iso_disk_wait_fsync(int fd)
{
    return wait_for(fsync, fd);
}

int iso_disk_wait_fdatasync(int fd)
{
    return wait_for(fdatasync, fd);
}
