#include "drivers/sensor/openni2/openni2_player.h"

#include <dirent.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum {
    NAP_MS = 3,
    LOOKS = 500, /* the largest number of looks at a thread, one each millisecond */
};

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

/* The state is the letter after the thread's name, which stands in parentheses and may hold any
 * character (proc(5), /proc/pid/stat). 'R' is a thread that runs or waits for a processor. */
static bool is_awake(pid_t id)
{
    char path[64], line[512] = "";
    (void)snprintf(path, sizeof path, "/proc/self/task/%ld/stat", (long)id);
    FILE *file = fopen(path, "re");
    if (!file) {
        return false; /* it has ended */
    }
    const size_t length = fread(line, 1, sizeof line - 1, file);
    (void)fclose(file);
    line[length] = '\0';
    const char *name_end = strrchr(line, ')');
    return name_end && strncmp(name_end, ") S", 3) != 0;
}

void iso__openni2_threads_await_sleep(const struct iso__openni2_threads *threads)
{
    int looks = 0;
    if (threads->n == 0) {
        wait_ms(NAP_MS);
    }
    for (int i = 0; i < threads->n; i++) {
        for (; is_awake(threads->ids[i]) && looks < LOOKS; looks++) {
            wait_ms(1);
        }
    }
}
