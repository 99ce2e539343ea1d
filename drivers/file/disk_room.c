#include "drivers/file/disk_room.h"

#include <sys/statvfs.h>

static uint64_t beyond_reserve(uint64_t bytes)
{
    return bytes > ISO_DISK_RESERVE_BYTES ? bytes - ISO_DISK_RESERVE_BYTES : 0;
}

uint64_t iso_disk_room(const char *path)
{
    struct statvfs disk;
    return statvfs(path, &disk) < 0 ? 0 : beyond_reserve((uint64_t)disk.f_bavail * disk.f_frsize);
}

uint64_t iso_disk_size(const char *path)
{
    struct statvfs disk;
    return statvfs(path, &disk) < 0 ? 0 : beyond_reserve((uint64_t)disk.f_blocks * disk.f_frsize);
}
