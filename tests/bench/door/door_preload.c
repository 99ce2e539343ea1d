/* The library that bench_door loads into the daemon. It replaces libgpiod's chips with one in
 * shared memory, and delays each fsync and the reading of each picture by the times that bench_door
 * sets. It also notes what the thread that switches the relay waited for. The daemon itself is not
 * changed. */
#include <dlfcn.h>
#include <errno.h>
#include <gpiod.h>
#include <png.h>
#include <poll.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

#include "tests/bench/door/door_bench.h"

struct gpiod_line {
    unsigned offset;
};

struct gpiod_chip {
    struct gpiod_line lines[DOOR_BENCH_LINES];
};

static struct door_bench *shared;
static int edges_fd, switchings_fd;

__attribute__((constructor)) static void connect_to_bench(void)
{
    const char *text = getenv(DOOR_BENCH_VARIABLE);
    int memory_fd = -1;
    if (!text || sscanf(text, "%d %d %d", &memory_fd, &edges_fd, &switchings_fd) != 3) {
        return;
    }
    void *memory = mmap(NULL, sizeof *shared, PROT_READ | PROT_WRITE, MAP_SHARED, memory_fd, 0);
    shared = memory == MAP_FAILED ? NULL : memory;
}

static int64_t now_ns(clockid_t id)
{
    struct timespec now;
    (void)clock_gettime(id, &now);
    return now.tv_sec * INT64_C(1000000000) + now.tv_nsec;
}

/* ---- the disk ---- */

static int delay_sync(const char *name, int fd)
{
    int (*real)(int) = NULL;
    const int ms = shared ? atomic_load(&shared->sync_ms) : 0;
    const struct timespec wait = {ms / 1000, ms % 1000 * 1000000L};
    *(void **)&real = dlsym(RTLD_NEXT, name);
    if (shared) {
        atomic_fetch_add(&shared->syncs, 1);
    }
    (void)nanosleep(&wait, NULL);
    return real(fd);
}

int fsync(int fd)
{
    return delay_sync("fsync", fd);
}

int fdatasync(int fd)
{
    return delay_sync("fdatasync", fd);
}

/* ---- frames ---- */

/* The daemon calls this at the end of each frame's picture. It keeps the thread as busy as a slow
 * recognition would. */
void png_read_end(png_structrp png, png_inforp info)
{
    void (*real)(png_structrp, png_inforp) = NULL;
    *(void **)&real = dlsym(RTLD_NEXT, "png_read_end");
    real(png, info);
    if (shared) {
        const int64_t end_ns = now_ns(CLOCK_THREAD_CPUTIME_ID) +
                               atomic_load(&shared->frame_ms) * INT64_C(1000000);
        atomic_fetch_add(&shared->frames, 1);
        while (now_ns(CLOCK_THREAD_CPUTIME_ID) < end_ns) {
        }
    }
}

/* ---- what a thread waits for ---- */

/* The times of the thread that accesses it. */
static __thread struct {
    int64_t read_ns, woken_ns, lock_ns;
} own;

int poll(struct pollfd *fds, nfds_t n, int timeout_ms)
{
    static int (*real)(struct pollfd *, nfds_t, int);
    if (!real) {
        *(void **)&real = dlsym(RTLD_NEXT, "poll");
    }
    const int ready = real(fds, n, timeout_ms);
    own.woken_ns = now_ns(CLOCK_MONOTONIC);
    own.lock_ns = 0;
    return ready;
}

int pthread_mutex_lock(pthread_mutex_t *mutex)
{
    static int (*real)(pthread_mutex_t *);
    if (pthread_mutex_trylock(mutex) == 0) {
        return 0;
    }
    if (!real) {
        *(void **)&real = dlsym(RTLD_NEXT, "pthread_mutex_lock");
    }
    const int64_t begin_ns = now_ns(CLOCK_MONOTONIC);
    const int error = real(mutex);
    own.lock_ns += now_ns(CLOCK_MONOTONIC) - begin_ns;
    return error;
}

/* ---- lines ---- */

struct gpiod_chip *gpiod_chip_open_lookup(const char *descr)
{
    struct gpiod_chip *chip = NULL;
    if (!shared || strcmp(descr, "bench") != 0) {
        errno = ENOENT;
        return NULL;
    }
    chip = calloc(1, sizeof *chip);
    for (unsigned i = 0; chip && i < DOOR_BENCH_LINES; i++) {
        chip->lines[i].offset = i;
    }
    return chip;
}

struct gpiod_chip *gpiod_chip_open(const char *path)
{
    return gpiod_chip_open_lookup(path);
}

void gpiod_chip_close(struct gpiod_chip *chip)
{
    free(chip);
}

unsigned gpiod_chip_num_lines(struct gpiod_chip *chip)
{
    (void)chip;
    return DOOR_BENCH_LINES;
}

struct gpiod_line *gpiod_chip_get_line(struct gpiod_chip *chip, unsigned offset)
{
    return &chip->lines[offset];
}

const char *gpiod_line_name(struct gpiod_line *line)
{
    (void)line;
    return NULL;
}

const char *gpiod_line_consumer(struct gpiod_line *line)
{
    (void)line;
    return NULL;
}

int gpiod_line_set_value(struct gpiod_line *line, int value)
{
    const struct door_bench_switching switching = {
        .t_ns = now_ns(CLOCK_MONOTONIC),
        .line = (int32_t)line->offset,
        .level = value,
        .read_ns = own.read_ns,
        .woken_ns = own.woken_ns,
        .lock_ns = own.lock_ns,
    };
    const int before = atomic_exchange(&shared->level[line->offset], value);
    if (before == value) {
        return 0;
    }
    return write(switchings_fd, &switching, sizeof switching) == sizeof switching ? 0 : -1;
}

int gpiod_line_get_value(struct gpiod_line *line)
{
    return atomic_load(&shared->level[line->offset]);
}

int gpiod_line_request(struct gpiod_line *line, const struct gpiod_line_request_config *config,
                       int default_val)
{
    if (config->request_type == GPIOD_LINE_REQUEST_DIRECTION_OUTPUT) {
        return gpiod_line_set_value(line, default_val);
    }
    return 0;
}

int gpiod_line_event_get_fd(struct gpiod_line *line)
{
    (void)line;
    return edges_fd;
}

int gpiod_line_event_read_fd(int fd, struct gpiod_line_event *event)
{
    struct door_bench_edge edge;
    if (read(fd, &edge, sizeof edge) != sizeof edge) {
        return -1;
    }
    if (edge.level) {
        own.read_ns = now_ns(CLOCK_MONOTONIC);
    }
    event->ts.tv_sec = (time_t)(edge.t_ns / 1000000000);
    event->ts.tv_nsec = (long)(edge.t_ns % 1000000000);
    event->event_type = edge.level ? GPIOD_LINE_EVENT_RISING_EDGE : GPIOD_LINE_EVENT_FALLING_EDGE;
    return 0;
}
