#include "tests/e2e/appliance.h"
#include "tests/support/child_end.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "sim/door/slot.h"
#include "tests/support/devices/camera_bench.h"
#include "tests/support/scratch.h"

#define DATA ISOTHERM_SOURCE_DIR "/core/data/"

/* The times are short, so that the tests are short. Only those of the sensor are long, because the
 * machine may be busy with other work. Scores and counts are those of the product, except that of
 * the hints: a stored visit has three frames, and a slow machine may miss one of them. */
static const char configuration[] = "[sensor]\nretry_ms = 50\nretry_max_ms = 100\n"
                                    "stale_ms = 5000\npause_ms = 5000\n%s%s%s\n"
                                    "[door]\nbackend = null\nunlock_ms = 200\n"
                                    "[decision]\ngap_ms = %s\n"
                                    "[hint]\nhold_frames = 2\n"
                                    "[gallery]\npath = %s/gallery.db\n"
                                    "[log]\npath = %s/audit.log\nsync = no\n"
                                    "[bus]\naddress = %s\n"
                                    "[model]\nhead = " DATA "head.model\n"
                                    "metric = " DATA "face.metric\n%s";

/* The virtual camera repeats its recording. A machine that takes as long for a frame as the
 * recording lasts sees the same frame every time and would report a frozen picture. */
static const char looping[] = "backend = openni2\n[motion]\nfrozen_frames = 0";

enum { READY_MS = 60 * 1000 };

const char appliance_isotherm[] = ISOTHERM_BINARY_DIR "/enroll/isotherm";

static const char isothermd[] = ISOTHERM_BINARY_DIR "/firmware/isothermd";
static const char simulator[] = ISOTHERM_BINARY_DIR "/sim/isotherm-sim";

void appliance_configure(const struct appliance *appliance)
{
    FILE *file = fopen(appliance->configuration, "w");

    assert_non_null(file);
    const bool replay = !appliance->bench[0];
    assert_true(fprintf(file, configuration, replay ? "backend = replay\npath = " : looping,
                        replay ? appliance->slot : "",
                        replay && !appliance->strict ? "\nrepeats = yes" : "", appliance->gap_ms,
                        appliance->directory, appliance->directory, appliance->bus.address,
                        appliance->keys) > 0);
    assert_int_equal(fclose(file), 0);
}

/* Replaces the service manager: a socket on which the daemon reports its state. */
static int listen_to_daemon(const struct appliance *appliance)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    const int fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);

    assert_true(fd >= 0);
    (void)snprintf(address.sun_path, sizeof address.sun_path, "%s/notify", appliance->directory);
    assert_int_equal(bind(fd, (const struct sockaddr *)&address, sizeof address), 0);
    assert_int_equal(setenv("NOTIFY_SOCKET", address.sun_path, 1), 0);
    return fd;
}

void appliance_start_daemon(struct appliance *appliance)
{
    const char *const argv[] = {isothermd, "--config", appliance->configuration, NULL};
    struct pollfd ready = {.fd = appliance->notify_fd, .events = POLLIN};
    char text[512] = "";

    run_free(&appliance->daemon); /* frees the output of an earlier daemon of this test */
    run_start(&appliance->daemon, argv);
    while (!strstr(text, "READY=1")) {
        if (poll(&ready, 1, READY_MS) <= 0) {
            run_finish(&appliance->daemon);
            fail_msg("the daemon is not ready: %s", appliance->daemon.err);
        }
        const ssize_t n = recv(appliance->notify_fd, text, sizeof text - 1, 0);
        text[n > 0 ? n : 0] = '\0';
    }
}

void appliance_end_daemon(struct appliance *appliance, int signal)
{
    kill(appliance->daemon.pid, signal);
    run_finish(&appliance->daemon);
}

static struct appliance the_appliance;

bool appliance_find(void)
{
    static const char *const needed[] = {APPLIANCE_CORPUS "/manifest.csv", DATA "head.model",
                                         DATA "face.metric"};

    for (size_t i = 0; i < sizeof needed / sizeof *needed; i++) {
        if (!scratch_exists(needed[i])) {
            print_message("skipped: %s is missing\n", needed[i]);
            return false;
        }
    }
    return private_bus_start(&the_appliance.bus);
}

static void make_directory(struct appliance *appliance)
{
    void *directory = NULL;

    assert_int_equal(scratch_setup(&directory), 0);
    appliance->directory = directory;
    (void)snprintf(appliance->slot, sizeof appliance->slot, "%s/slot", appliance->directory);
    (void)snprintf(appliance->configuration, sizeof appliance->configuration, "%s/isotherm.conf",
                   appliance->directory);
    (void)snprintf(appliance->people, sizeof appliance->people, "%s", APPLIANCE_CORPUS);
    appliance->strict = false;
    appliance->keys = "";
    appliance->gap_ms = "300";
    appliance->settle_ms = "400";
}

/* The virtual camera is a library in the daemon's process, so it may read only what the daemon may
 * read (firmware/daemon/confine.h): temporary files, but not the source tree. */
static void copy_people(struct appliance *appliance)
{
    (void)snprintf(appliance->people, sizeof appliance->people, "%s/people", appliance->directory);
    const char *const argv[] = {"/bin/cp", "-r", APPLIANCE_CORPUS, appliance->people, NULL};
    struct run run;

    run_start(&run, argv);
    run_finish(&run);
    run_expect(&run, 0);
    run_free(&run);
}

static void set_up(struct appliance *appliance)
{
    appliance_configure(appliance);
    appliance->notify_fd = listen_to_daemon(appliance);
    appliance_start_daemon(appliance);
}

int appliance_setup(void **state)
{
    make_directory(&the_appliance);
    set_up(&the_appliance);
    *state = &the_appliance;
    return 0;
}

/* The runtime finds its drivers next to the path from which it is loaded. */
int appliance_setup_openni2(void **state)
{
    struct appliance *appliance = &the_appliance;

    make_directory(appliance);
    (void)snprintf(appliance->bench, sizeof appliance->bench, "%s/bench", appliance->directory);
    (void)snprintf(appliance->slot, sizeof appliance->slot, "%s/bench/slot", appliance->directory);
    copy_people(appliance);
    (void)camera_bench_make(appliance->bench, scratch_path(appliance->people, "p01-v1"), false);
    scratch_write_text(scratch_path(appliance->bench, "noise"), "");
    appliance_show(appliance, NULL);
    /* The camera makes 30 frames a second and does not wait for a slow machine: with sanitizers on
     * a busy machine the computation of a frame takes seconds. */
    appliance->gap_ms = "4000";
    appliance->settle_ms = "6000";
    assert_int_equal(setenv("LD_LIBRARY_PATH", ISOTHERM_BINARY_DIR "/tests/openni2/runtime", 1), 0);
    set_up(appliance);
    *state = appliance;
    return 0;
}

int appliance_teardown(void **state)
{
    struct appliance *appliance = &the_appliance; /* *state is not set if the set-up failed */
    void *directory = appliance->directory;

    (void)state;
    if (appliance->daemon.pid > 0) { /* otherwise a test failed between an end and a start */
        appliance_end_daemon(appliance, SIGTERM);
    }
    if (appliance->daemon.exit != 0) {
        print_message("the daemon ended with %d: %s\n", appliance->daemon.exit,
                      appliance->daemon.err);
    }
    run_free(&appliance->daemon);
    close(appliance->notify_fd);
    private_bus_stop(&appliance->bus);
    return scratch_teardown(&directory) || appliance->daemon.exit != 0;
}

void appliance_show(const struct appliance *appliance, const char *recording)
{
    struct iso_fault fault = {.text = ""};
    const int error = recording
                          ? sim_slot_point(appliance->slot, appliance->people, recording, &fault)
                          : sim_slot_clear(appliance->slot, &fault);

    if (error) {
        fail_msg("%s", fault.text);
    }
}

static const struct appliance_result *result_of(struct run *run)
{
    static struct appliance_result result;

    run_finish(run);
    result.exit = run->exit;
    (void)snprintf(result.what, sizeof result.what, "%s", run->what);
    (void)snprintf(result.out, sizeof result.out, "%s", run->out);
    (void)snprintf(result.err, sizeof result.err, "%s", run->err);
    run_free(run);
    return &result;
}

const struct appliance_result *appliance_run(const struct appliance *appliance, const char *words,
                                             const char *recording)
{
    const char *argv[24] = {appliance_isotherm, "--bus", appliance->bus.address};
    size_t argc = 3;
    char copy[512];
    struct run run;

    (void)snprintf(copy, sizeof copy, "%s", words);
    for (char *word = strtok(copy, " "); word; word = strtok(NULL, " ")) {
        assert_true(argc < sizeof argv / sizeof *argv - 1);
        argv[argc++] = word;
    }
    run_start(&run, argv);
    if (recording) {
        run_until(&run, "straight at the camera.");
        appliance_show(appliance, recording);
    }
    const struct appliance_result *result = result_of(&run);
    appliance_show(appliance, NULL);
    return result;
}

void appliance_expect(const struct appliance_result *result, int exit)
{
    child_expect_code(result->what, result->exit, exit, result->out, result->err);
}

json_t *appliance_run_json(const struct appliance *appliance, const char *words,
                           const char *recording, int exit)
{
    char with_json[512];
    json_error_t error;

    (void)snprintf(with_json, sizeof with_json, "%s --json", words);
    const struct appliance_result *result = appliance_run(appliance, with_json, recording);
    json_t *document = json_loads(result->out, 0, &error);
    appliance_expect(result, exit);
    if (!document) {
        fail_msg("%s: not JSON: %s", words, result->out);
    }
    return document;
}

/* Makes a corpus of some recordings: links to them, and their rows of the manifest. */
static void make_corpus(const char *directory, const char *people, const char *const recordings[])
{
    size_t size;
    char *bytes = scratch_read(scratch_path(people, "manifest.csv"), &size);
    char *manifest = strndup(bytes, size), *rest = manifest, *line;
    char *text = NULL;
    FILE *out = open_memstream(&text, &size);

    fprintf(out, "%s\n", strsep(&rest, "\n"));
    while ((line = strsep(&rest, "\n"))) {
        for (size_t i = 0; recordings[i]; i++) {
            const size_t length = strlen(recordings[i]);
            if (strncmp(line, recordings[i], length) != 0 || line[length] != ',') {
                continue;
            }
            fprintf(out, "%s\n", line);
            const char *link = scratch_path(directory, recordings[i]);
            (void)unlink(link);
            assert_int_equal(symlink(scratch_path(people, recordings[i]), link), 0);
        }
    }
    assert_int_equal(fclose(out), 0);
    scratch_write_text(scratch_path(directory, "manifest.csv"), text);
    free(text);
    free(manifest);
    free(bytes);
}

const struct appliance_result *appliance_visit(const struct appliance *appliance,
                                               const char *const recordings[])
{
    const char *corpus = scratch_path(appliance->directory, "corpus");
    const char *const argv[] = {simulator,     "visit",
                                "--corpus",    corpus,
                                "--slot",      appliance->slot,
                                "--bus",       appliance->bus.address,
                                "--out",       appliance->directory,
                                "--settle-ms", appliance->settle_ms,
                                NULL};
    struct run run;

    if (!scratch_exists(corpus)) {
        scratch_mkdir(corpus);
    }
    make_corpus(corpus, appliance->people, recordings);
    run_start(&run, argv);
    return result_of(&run);
}
