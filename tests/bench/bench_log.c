/* Measures the audit log on a slow disk: the records a second while its queue is always full, and
 * the wait for the record of a grant while 400 other records a second are posted.
 *
 * usage: bench_log [MS]     each synchronisation takes MS milliseconds, 20 by default */
#include <errno.h>
#include <ftw.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "firmware/audit/audit_writer.h"

enum { SECONDS = 5, GRANTS = 40, POSTS_A_SECOND = 400, WAIT_MS = 250 };

/* ---- the disk ---- */

static int sync_ms = 20;

int __wrap_fsync(int fd);
int __wrap_fdatasync(int fd);

static void sleep_ms(double ms)
{
    const struct timespec time = {.tv_sec = (time_t)(ms / 1000),
                                  .tv_nsec = (long)(1e6 * ms) % 1000000000};
    (void)nanosleep(&time, NULL);
}

int __wrap_fsync(int fd)
{
    (void)fd;
    sleep_ms(sync_ms);
    return 0;
}

int __wrap_fdatasync(int fd)
{
    return __wrap_fsync(fd);
}

/* ---- the log ---- */

static char directory[] = "/tmp/isotherm-bench-XXXXXX";
static struct iso_times times;
static struct iso_key_ring *ring;
static struct iso_audit *audit;
static struct iso_audit_writer *writer;

static void fail(const char *what)
{
    fprintf(stderr, "bench_log: %s\n", what);
    exit(1);
}

static int open_log(struct iso_fault *fault)
{
    char keys[64], key[64], path[64];
    (void)snprintf(keys, sizeof keys, "%s/keys", directory);
    (void)snprintf(key, sizeof key, "%s/key", directory);
    (void)snprintf(path, sizeof path, "%s/log", directory);
    const struct iso_key_place place = {.ring = keys, .file = key};
    int error = iso_key_ring_open(&place, &ring, fault);
    const struct iso_audit_options options = {.path = path, .sync = true, .ring = ring};
    times = iso_times_system();
    if (!error) {
        error = iso_audit_open(&options, &times, &audit, fault);
    }
    return error ? error : iso_audit_writer_new(audit, &times, true, &writer);
}

static int remove_entry(const char *path, const struct stat *status, int type, struct FTW *walk)
{
    (void)status, (void)type, (void)walk;
    return remove(path);
}

static void close_log(void)
{
    iso_audit_writer_free(writer);
    iso_audit_close(audit);
    iso_key_ring_close(ring);
    (void)nftw(directory, remove_entry, 16, FTW_DEPTH | FTW_PHYS);
}

/* ---- measurements ---- */

static double now_s(void)
{
    return (double)iso_times_now_ns(&times) / (double)ISO_NS_PER_S;
}

static double records_a_second(void)
{
    const struct iso_audit_record record = iso_audit_record_of("door");
    const uint64_t before = iso_audit_writer_last(writer);
    const double begin_s = now_s();
    while (now_s() - begin_s < SECONDS) {
        if (iso_audit_writer_post(writer, &record, NULL)) {
            sleep_ms(1);
        }
    }
    return (double)(iso_audit_writer_last(writer) - before) / (now_s() - begin_s);
}

static int compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void grants_among_others(void)
{
    const struct iso_audit_record door = iso_audit_record_of("door"),
                                  grant = iso_audit_record_of("grant");
    double took_ms[GRANTS];
    int n = 0;
    for (int i = 0; i < GRANTS; i++) {
        for (int k = 0; k < POSTS_A_SECOND / 8; k++) { /* an eighth of a second */
            (void)!iso_audit_writer_post(writer, &door, NULL);
            sleep_ms(1000.0 / POSTS_A_SECOND);
        }
        const double begin_s = now_s();
        if (!iso_audit_writer_append(writer, &grant, WAIT_MS * ISO_NS_PER_MS, NULL, NULL)) {
            took_ms[n++] = 1000 * (now_s() - begin_s);
        }
    }
    qsort(took_ms, (size_t)n, sizeof *took_ms, compare);
    printf("grants among %d records a second: %d of %d on record in %d ms", POSTS_A_SECOND, n,
           GRANTS, WAIT_MS);
    if (n > 0) {
        printf(", median %.0f ms, longest %.0f ms", took_ms[n / 2], took_ms[n - 1]);
    }
    printf("\n");
}

int main(int argc, char **argv)
{
    struct iso_fault fault = {.text = ""};
    sync_ms = argc > 1 ? atoi(argv[1]) : sync_ms;
    if (!mkdtemp(directory)) {
        fail("no directory");
    }
    if (open_log(&fault)) {
        fail(fault.text);
    }
    printf("a synchronisation takes %d ms\n", sync_ms);
    grants_among_others();
    printf("records a second: %.0f\n", records_a_second());
    close_log();
    return 0;
}
