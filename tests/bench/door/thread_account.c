#include "tests/bench/door/thread_account.h"

#include <dirent.h>
#include <sched.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static FILE *open_of(pid_t process, pid_t thread, const char *what)
{
    char path[96];
    (void)snprintf(path, sizeof path, "/proc/%d/task/%d/%s", (int)process, (int)thread, what);
    return fopen(path, "re");
}

static bool has_name(pid_t process, pid_t thread, const char *name)
{
    char own[32] = "";
    FILE *file = open_of(process, thread, "comm");
    const bool has = file && fscanf(file, "%31s", own) == 1 && strcmp(own, name) == 0;
    if (file) {
        (void)fclose(file);
    }
    return has;
}

pid_t bench_thread_named(pid_t process, const char *name)
{
    char path[64];
    pid_t found = 0;
    (void)snprintf(path, sizeof path, "/proc/%d/task", (int)process);
    DIR *directory = opendir(path);
    const struct dirent *entry = NULL;
    while (directory && !found && (entry = readdir(directory))) {
        const pid_t thread = (pid_t)strtol(entry->d_name, NULL, 10);
        found = thread > 0 && has_name(process, thread, name) ? thread : 0;
    }
    if (directory) {
        (void)closedir(directory);
    }
    return found;
}

static void read_faults(pid_t process, pid_t thread, struct bench_account *out)
{
    FILE *file = open_of(process, thread, "stat");
    if (file) {
        (void)fscanf(file, "%*d (%*[^)]) %*c %*d %*d %*d %*d %*d %*u %ld %*d %ld", &out->minor,
                     &out->major);
        (void)fclose(file);
    }
}

static void read_stolen(struct bench_account *out)
{
    long long ticks = 0;
    FILE *file = fopen("/proc/stat", "re");
    if (file) {
        if (fscanf(file, "cpu %*d %*d %*d %*d %*d %*d %*d %lld", &ticks) == 1) {
            out->stolen_ns = ticks * (INT64_C(1000000000) / sysconf(_SC_CLK_TCK));
        }
        (void)fclose(file);
    }
}

struct bench_account bench_account_of(pid_t process, pid_t thread)
{
    struct bench_account out = {.waited_ns = 0};
    long long waited_ns = 0;
    FILE *file = open_of(process, thread, "schedstat");
    if (file) {
        out.waited_ns = fscanf(file, "%*d %lld", &waited_ns) == 1 ? waited_ns : 0;
        (void)fclose(file);
    }
    read_faults(process, thread, &out);
    read_stolen(&out);
    return out;
}

struct bench_account bench_account_between(const struct bench_account *earlier,
                                           const struct bench_account *later)
{
    return (struct bench_account){
        .waited_ns = later->waited_ns - earlier->waited_ns,
        .stolen_ns = later->stolen_ns - earlier->stolen_ns,
        .minor = later->minor - earlier->minor,
        .major = later->major - earlier->major,
    };
}

const char *bench_thread_policy(pid_t thread, char *text, size_t size)
{
    struct sched_param parameters = {.sched_priority = 0};
    if (sched_getscheduler(thread) == SCHED_FIFO && !sched_getparam(thread, &parameters)) {
        (void)snprintf(text, size, "SCHED_FIFO, priority %d", parameters.sched_priority);
    } else {
        (void)snprintf(text, size, "no real-time priority");
    }
    return text;
}

long bench_locked_kib(pid_t process)
{
    char path[64], line[128];
    long kib = 0;
    (void)snprintf(path, sizeof path, "/proc/%d/status", (int)process);
    FILE *file = fopen(path, "re");
    while (file && fgets(line, sizeof line, file)) {
        (void)sscanf(line, "VmLck: %ld", &kib);
    }
    if (file) {
        (void)fclose(file);
    }
    return kib;
}
