#include "drivers/sensor/openni2/openni2_player.h"

#include <dirent.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum {
    NAP_MS = 3,
    LOOKS = 500,     /* the largest number of looks at the threads, one each millisecond */
    FRESH_LOOKS = 2, /* a nap that began at most so many looks ago lasts for some more */
    LONG_LOOKS = 30, /* a sleep of so many looks is none of the player's naps of 10 ms */
};

static const char times_key[] = "voluntary_ctxt_switches:";

static void wait_ms(int ms)
{
    const struct timespec while_ns = {0, ms * 1000000L};
    (void)nanosleep(&while_ns, NULL);
}

void iso__openni2_threads_list(struct iso__openni2_threads *threads)
{
    DIR *folder = opendir("/proc/self/task");
    const struct dirent *entry = NULL;
    threads->n = 0;
    while (folder && threads->n < ISO__OPENNI2_THREADS && (entry = readdir(folder))) {
        const long id = strtol(entry->d_name, NULL, 10);
        if (id > 0) {
            threads->ids[threads->n++] = (pid_t)id;
        }
    }
    if (folder) {
        (void)closedir(folder);
    }
}

static bool has(const struct iso__openni2_threads *threads, pid_t id)
{
    for (int i = 0; i < threads->n; i++) {
        if (threads->ids[i] == id) {
            return true;
        }
    }
    return false;
}

void iso__openni2_threads_new(const struct iso__openni2_threads *before,
                              struct iso__openni2_threads *threads)
{
    int n = 0;
    iso__openni2_threads_list(threads);
    for (int i = 0; before->n > 0 && i < threads->n; i++) {
        if (!has(before, threads->ids[i])) {
            threads->ids[n++] = threads->ids[i];
        }
    }
    threads->n = n;
}

/* A thread as the kernel sees it. */
struct look {
    bool sleeps;
    long times; /* how often it has gone to sleep */
};

/* Reads the lines that count (proc(5), /proc/pid/status). False: the thread has ended. */
static bool look_at(pid_t id, struct look *look)
{
    char path[64], line[256];
    (void)snprintf(path, sizeof path, "/proc/self/task/%ld/status", (long)id);
    FILE *file = fopen(path, "re");
    if (!file) {
        return false;
    }
    *look = (struct look){.times = 0};
    while (fgets(line, sizeof line, file)) {
        look->sleeps = look->sleeps || strncmp(line, "State:\tS", 8) == 0;
        if (strncmp(line, times_key, sizeof times_key - 1) == 0) {
            look->times = strtol(line + sizeof times_key - 1, NULL, 10);
        }
    }
    (void)fclose(file);
    return true;
}

void iso__openni2_threads_await_sleep(const struct iso__openni2_threads *threads)
{
    long times[ISO__OPENNI2_THREADS] = {0};
    int since[ISO__OPENNI2_THREADS] = {0}; /* the look at which `times` was new; 0: the first */
    if (threads->n == 0) {
        wait_ms(NAP_MS);
        return;
    }
    for (int n = 0; n < LOOKS; n++, wait_ms(1)) {
        bool all = true;
        for (int i = 0; i < threads->n; i++) {
            struct look look;
            if (!look_at(threads->ids[i], &look)) {
                continue;
            }
            if (n == 0 || look.times != times[i]) {
                times[i] = look.times;
                since[i] = n;
            }
            const bool fell_asleep = since[i] > 0 && n - since[i] <= FRESH_LOOKS;
            all = all && look.sleeps && (fell_asleep || n - since[i] >= LONG_LOOKS);
        }
        if (all) {
            return;
        }
    }
}
