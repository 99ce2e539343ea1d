#include "drivers/file/disk_room.h"

#include <sys/statvfs.h>

uint64_t iso_disk_room(const char *path)
{
    struct statvfs disk;
    if (statvfs(path, &disk) < 0) {
        return 0;
    }
    const uint64_t room = (uint64_t)disk.f_bavail * disk.f_frsize;
    return room > ISO_DISK_RESERVE_BYTES ? room - ISO_DISK_RESERVE_BYTES : 0;
}
