/* How much may still be written to a disk without taking the room that the log and the records of
 * people need. */
#ifndef ISO_DRIVERS_FILE_DISK_ROOM_H
#define ISO_DRIVERS_FILE_DISK_ROOM_H

#include <stdint.h>

/* So many bytes of each disk stay free for them. */
#define ISO_DISK_RESERVE_BYTES (UINT64_C(64) << 20)

/* The free bytes of the disk of an existing file or folder beyond the reserve; 0 if there are none,
 * or if the disk cannot be asked. */
uint64_t iso_disk_room(const char *path);

/* What the disk could have free beyond the reserve if it were empty; 0 if it cannot be asked. */
uint64_t iso_disk_size(const char *path);

#endif
