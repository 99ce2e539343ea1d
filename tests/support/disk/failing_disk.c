#include "tests/support/disk/failing_disk.h"

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

const char *const failing_disk_names[FAILING_DISK_KINDS] = {
    [FAILING_DISK_ONCE] = "fails once",
    [FAILING_DISK_FULL] = "is full once",
    [FAILING_DISK_SHORT] = "writes short",
    [FAILING_DISK_LIES] = "fails, but does it",
    [FAILING_DISK_BROKEN] = "fails for good",
    [FAILING_DISK_DEAD] = "is dead",
    [FAILING_DISK_KILLS] = "with a kill before it",
    [FAILING_DISK_KILLS_BEHIND] = "with a kill behind it",
};

static struct {
    atomic_bool armed;
    enum failing_disk_kind kind;
    long nth;
    atomic_long calls, writes;
    long kernel_writes; /* when it was armed */
    atomic_bool journal_pending;
} disk;

/* The kernel's count of write calls of this process, without those that fail; -1: not known. */
static long count_of_kernel(void)
{
    char text[400] = "";
    const int fd = (int)syscall(SYS_openat, AT_FDCWD, "/proc/self/io", O_RDONLY | O_CLOEXEC);
    const ssize_t n = fd < 0 ? -1 : syscall(SYS_read, fd, text, sizeof text - 1);
    const char *count = n > 0 ? strstr(text, "syscw: ") : NULL;
    if (fd >= 0) {
        (void)close(fd);
    }
    return count ? atol(count + strlen("syscw: ")) : -1;
}

void failing_disk_arm(enum failing_disk_kind kind, long nth)
{
    disk.kind = kind;
    disk.nth = nth;
    disk.calls = 0;
    disk.writes = 0;
    disk.kernel_writes = count_of_kernel();
    disk.journal_pending = false;
    disk.armed = true;
}

long failing_disk_writes(void)
{
    return disk.writes;
}

long failing_disk_kernel_writes(void)
{
    const long now = count_of_kernel();
    return now < 0 || disk.kernel_writes < 0 ? -1 : now - disk.kernel_writes;
}

bool failing_disk_journal_may_return(void)
{
    return disk.journal_pending;
}

long failing_disk_heal(void)
{
    disk.armed = false;
    return disk.calls;
}

/* Whether it is a file or a directory of the disk; memory files have no name. */
static bool is_on_disk(int fd)
{
    struct stat status;
    return fstat(fd, &status) == 0 &&
           (S_ISDIR(status.st_mode) || (S_ISREG(status.st_mode) && status.st_nlink > 0));
}

enum fate { WORKS, FAILS, LIES, HALF };

/* Counts a call that writes, and decides whether it fails. */
static enum fate fate_of_call(void)
{
    if (!disk.armed) {
        return WORKS;
    }
    const long call = ++disk.calls;
    const bool lasts = disk.kind == FAILING_DISK_BROKEN || disk.kind == FAILING_DISK_DEAD;
    if (call < disk.nth || (call > disk.nth && !lasts)) {
        return WORKS;
    }
    switch (disk.kind) {
    case FAILING_DISK_LIES:
    case FAILING_DISK_KILLS_BEHIND:
        return LIES;
    case FAILING_DISK_SHORT:
        return HALF;
    default:
        return FAILS;
    }
}

static enum fate fate_of_file(int fd)
{
    return disk.armed && is_on_disk(fd) ? fate_of_call() : WORKS;
}

static int refuse(void)
{
    if (disk.kind == FAILING_DISK_KILLS || disk.kind == FAILING_DISK_KILLS_BEHIND) {
        (void)kill(getpid(), SIGKILL);
    }
    errno = disk.kind == FAILING_DISK_FULL ? ENOSPC : EIO;
    return -1;
}

/* Whether a call that reads fails. */
static bool is_dead(void)
{
    return disk.armed && disk.kind == FAILING_DISK_DEAD && disk.calls >= disk.nth;
}

/* ---- writing ---- */

static ssize_t write_at(int fd, const void *bytes, size_t size, off_t at)
{
    const enum fate fate = fate_of_file(fd);
    if (fate == FAILS) {
        return refuse();
    }
    size = fate == HALF ? size / 2 : size;
    disk.writes++;
    const ssize_t written = at < 0 ? syscall(SYS_write, fd, bytes, size)
                                   : syscall(SYS_pwrite64, fd, bytes, size, at);
    return fate == LIES ? refuse() : written;
}

ssize_t write(int fd, const void *bytes, size_t size)
{
    return write_at(fd, bytes, size, -1);
}

ssize_t pwrite(int fd, const void *bytes, size_t size, off_t at)
{
    return write_at(fd, bytes, size, at);
}

ssize_t pwrite64(int fd, const void *bytes, size_t size, off_t at)
{
    return write_at(fd, bytes, size, at);
}

static bool is_directory(int fd)
{
    struct stat status;
    return fstat(fd, &status) == 0 && S_ISDIR(status.st_mode);
}

/* With FAILING_DISK_LIES nothing depends on whether the data was synchronised. */
int fsync(int fd)
{
    if (fate_of_file(fd) != WORKS) {
        return refuse();
    }
    if (is_directory(fd)) {
        disk.journal_pending = false;
    }
    return 0;
}

int fdatasync(int fd)
{
    return fsync(fd);
}

int ftruncate(int fd, off_t size)
{
    const enum fate fate = fate_of_file(fd);
    if (fate == FAILS || fate == HALF) {
        return refuse();
    }
    const int result = (int)syscall(SYS_ftruncate, fd, size);
    return fate == LIES ? refuse() : result;
}

int ftruncate64(int fd, off_t size)
{
    return ftruncate(fd, size);
}

/* ---- names of files ---- */

int renameat2(int from_fd, const char *from, int to_fd, const char *to, unsigned flags)
{
    const enum fate fate = fate_of_call();
    if (fate == FAILS || fate == HALF) {
        return refuse();
    }
    const int result = (int)syscall(SYS_renameat2, from_fd, from, to_fd, to, flags);
    return fate == LIES ? refuse() : result;
}

int rename(const char *from, const char *to)
{
    return renameat2(AT_FDCWD, from, AT_FDCWD, to, 0);
}

/* Whether it is the journal of a database of SQLite. */
static bool is_journal(const char *path)
{
    static const char end[] = "-journal";
    const size_t length = strlen(path);
    return length >= sizeof end && strcmp(path + length - (sizeof end - 1), end) == 0;
}

int unlink(const char *path)
{
    const enum fate fate = fate_of_call();
    if (fate == FAILS || fate == HALF) {
        return refuse();
    }
    const int result = (int)syscall(SYS_unlinkat, AT_FDCWD, path, 0);
    if (result == 0 && is_journal(path)) {
        disk.journal_pending = true;
    }
    return fate == LIES ? refuse() : result;
}

static int open_with(const char *path, int flags, mode_t mode)
{
    const enum fate fate = flags & O_CREAT ? fate_of_call() : WORKS;
    if (fate == FAILS || fate == HALF || is_dead()) {
        return refuse();
    }
    const int fd = (int)syscall(SYS_openat, AT_FDCWD, path, flags, mode);
    if (fate == LIES && fd >= 0) {
        (void)close(fd);
        return refuse();
    }
    return fd;
}

int open(const char *path, int flags, ...)
{
    va_list arguments;
    va_start(arguments, flags);
    const mode_t mode = flags & O_CREAT ? va_arg(arguments, mode_t) : 0;
    va_end(arguments);
    return open_with(path, flags, mode);
}

int open64(const char *path, int flags, ...)
{
    va_list arguments;
    va_start(arguments, flags);
    const mode_t mode = flags & O_CREAT ? va_arg(arguments, mode_t) : 0;
    va_end(arguments);
    return open_with(path, flags, mode);
}

/* ---- reading ---- */

ssize_t read(int fd, void *bytes, size_t size)
{
    return is_dead() && is_on_disk(fd) ? refuse() : syscall(SYS_read, fd, bytes, size);
}

ssize_t pread(int fd, void *bytes, size_t size, off_t at)
{
    return is_dead() && is_on_disk(fd) ? refuse() : syscall(SYS_pread64, fd, bytes, size, at);
}

ssize_t pread64(int fd, void *bytes, size_t size, off_t at)
{
    return pread(fd, bytes, size, at);
}

/* ---- streams, whose calls stay within the C library ---- */

static ssize_t write_stream(void *cookie, const char *bytes, size_t size)
{
    const ssize_t written = write((int)(intptr_t)cookie, bytes, size);
    return written < 0 ? 0 : written; /* 0 is an error here */
}

static ssize_t read_stream(void *cookie, char *bytes, size_t size)
{
    return read((int)(intptr_t)cookie, bytes, size);
}

static int seek_stream(void *cookie, off64_t *offset, int whence)
{
    const off_t at = lseek((int)(intptr_t)cookie, *offset, whence);
    *offset = at;
    return at < 0 ? -1 : 0;
}

static int close_stream(void *cookie)
{
    return close((int)(intptr_t)cookie);
}

FILE *fdopen(int fd, const char *mode)
{
    const cookie_io_functions_t calls = {read_stream, write_stream, seek_stream, close_stream};
    return fopencookie((void *)(intptr_t)fd, mode, calls); // NOLINT(performance-no-int-to-ptr)
}

FILE *fopen(const char *path, const char *mode)
{
    static FILE *(*real)(const char *path, const char *mode);
    if (is_dead()) {
        (void)refuse();
        return NULL;
    }
    if (!real) {
        void *found = dlsym(RTLD_NEXT, "fopen");
        memcpy(&real, &found, sizeof real);
    }
    return real(path, mode);
}
