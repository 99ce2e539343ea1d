#include "tests/bench/fleet/fleet_table.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

static _Noreturn void fail(const char *path)
{
    fprintf(stderr, "fleet bench: %s: %s\n", path, strerror(errno));
    exit(4);
}

int64_t fleet_table_now_ns(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

static struct fleet_table *map(const char *path, int fd, size_t size)
{
    void *memory = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
    if (memory == MAP_FAILED) {
        fail(path);
    }
    (void)close(fd);
    return memory;
}

struct fleet_table *fleet_table_make(const char *path, uint32_t n)
{
    const size_t size = sizeof(struct fleet_table) + n * sizeof(struct fleet_table_door);
    const int fd = open(path, O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    if (fd < 0 || ftruncate(fd, (off_t)size)) {
        fail(path);
    }
    struct fleet_table *table = map(path, fd, size);
    table->n = n;
    return table;
}

struct fleet_table *fleet_table_open(const char *path)
{
    struct stat about;
    const int fd = open(path, O_RDWR | O_CLOEXEC);
    if (fd < 0 || fstat(fd, &about)) {
        fail(path);
    }
    return map(path, fd, (size_t)about.st_size);
}
