#include "tests/support/disk/broken_disk.h"

#include <errno.h>
#include <fcntl.h>
#include <setjmp.h>
#include <sqlite3.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

struct broken_disk broken_disk;

static bool refuses(void)
{
    if (broken_disk.error) {
        errno = broken_disk.error;
    }
    return broken_disk.error != 0;
}

/* Directories, pipes and sockets are not on the broken disk. */
static bool refuses_file(int fd)
{
    struct stat status;
    return fstat(fd, &status) == 0 && S_ISREG(status.st_mode) && refuses();
}

static bool is_to_write(int flags)
{
    return (flags & O_ACCMODE) != O_RDONLY || (flags & O_CREAT);
}

/* ---- calls of statically linked code ---- */

int __real_open(const char *path, int flags, ...);
ssize_t __real_write(int fd, const void *bytes, size_t size);
ssize_t __real_pwrite(int fd, const void *bytes, size_t size, off_t at);
int __real_fsync(int fd);
int __real_fdatasync(int fd);
int __real_ftruncate(int fd, off_t size);
int __real_rename(const char *from, const char *to);
int __wrap_open(const char *path, int flags, ...);
ssize_t __wrap_write(int fd, const void *bytes, size_t size);
ssize_t __wrap_pwrite(int fd, const void *bytes, size_t size, off_t at);
int __wrap_fsync(int fd);
int __wrap_fdatasync(int fd);
int __wrap_ftruncate(int fd, off_t size);
int __wrap_rename(const char *from, const char *to);

int __wrap_open(const char *path, int flags, ...)
{
    va_list arguments;
    va_start(arguments, flags);
    const mode_t mode = flags & O_CREAT ? va_arg(arguments, mode_t) : 0;
    va_end(arguments);
    return is_to_write(flags) && refuses() ? -1 : __real_open(path, flags, mode);
}

ssize_t __wrap_write(int fd, const void *bytes, size_t size)
{
    return refuses_file(fd) ? -1 : __real_write(fd, bytes, size);
}

ssize_t __wrap_pwrite(int fd, const void *bytes, size_t size, off_t at)
{
    return refuses_file(fd) ? -1 : __real_pwrite(fd, bytes, size, at);
}

int __wrap_fsync(int fd)
{
    return refuses_file(fd) ? -1 : __real_fsync(fd);
}

int __wrap_fdatasync(int fd)
{
    return refuses_file(fd) ? -1 : __real_fdatasync(fd);
}

int __wrap_ftruncate(int fd, off_t size)
{
    return refuses_file(fd) ? -1 : __real_ftruncate(fd, size);
}

int __wrap_rename(const char *from, const char *to)
{
    return refuses() ? -1 : __real_rename(from, to);
}

/* ---- SQLite ---- */

static int for_sqlite_open(const char *path, int flags, int mode)
{
    return is_to_write(flags) && refuses() ? -1 : __real_open(path, flags, mode);
}

static int for_sqlite_fcntl(int fd, int command, ...)
{
    va_list arguments;
    va_start(arguments, command);
    void *argument = va_arg(arguments, void *);
    va_end(arguments);
    if (command == F_SETLK && broken_disk.locked &&
        ((const struct flock *)argument)->l_type != F_UNLCK) {
        errno = EAGAIN;
        return -1;
    }
    return fcntl(fd, command, argument);
}

void broken_disk_install(void)
{
    const struct {
        const char *name;
        sqlite3_syscall_ptr call;
    } calls[] = {
        {"open", (sqlite3_syscall_ptr)for_sqlite_open},
        {"write", (sqlite3_syscall_ptr)__wrap_write},
        {"pwrite", (sqlite3_syscall_ptr)__wrap_pwrite},
        {"pwrite64", (sqlite3_syscall_ptr)__wrap_pwrite},
        {"ftruncate", (sqlite3_syscall_ptr)__wrap_ftruncate},
        {"fcntl", (sqlite3_syscall_ptr)for_sqlite_fcntl},
    };
    sqlite3_vfs *vfs = sqlite3_vfs_find(NULL);
    assert_non_null(vfs);
    for (size_t i = 0; i < sizeof calls / sizeof *calls; i++) {
        assert_int_equal(vfs->xSetSystemCall(vfs, calls[i].name, calls[i].call), SQLITE_OK);
    }
}

/* SQLite waits for a lock by this call; a test must not wait. */
int usleep(useconds_t us)
{
    (void)us;
    return 0;
}
