#include "tests/enroll/rigs/setup_rig.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <png.h>
#include <poll.h>
#include <pty.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "enroll/cli/machine/text_file.h"
#include "tests/support/programs/private_bus.h"
#include "tests/support/scratch.h"

enum { SILENCE_MS = 60 * 1000 };

static struct private_bus bus;
static struct setup_rig rig;
static void *directory;

bool setup_rig_find_bus(void)
{
    return private_bus_start(&bus);
}

int setup_rig_stop_bus(void **state)
{
    (void)state;
    private_bus_stop(&bus);
    return 0;
}

const char *setup_rig_path(const char *name)
{
    return scratch_path(directory, name);
}

void setup_rig_set_devices(const char *lines)
{
    scratch_write_text(setup_rig_path("devices"), lines);
}

/* Writes a script that runs the real program. Only for --list-devices it prints the devices of the
 * rig. */
static void write_daemon(void)
{
    char text[2048];

    (void)snprintf(text, sizeof text,
                   "#!/bin/sh\n[ \"$1\" = --list-devices ] && exec cat '%s'\nexec "
                   "'" ISOTHERM_BINARY_DIR "/firmware/isothermd' \"$@\"\n",
                   setup_rig_path("devices"));
    scratch_write_text(setup_rig_path("isothermd"), text);
    assert_int_equal(chmod(setup_rig_path("isothermd"), 0700), 0);
}

int setup_rig_setup(void **state)
{
    if (scratch_setup(&directory)) {
        return -1;
    }
    rig = (struct setup_rig){
        .places =
            {
                .config = strdup(setup_rig_path("etc/isotherm.conf")),
                .boards = ISOTHERM_SOURCE_DIR "/board",
                .cameras = strdup(setup_rig_path("cameras")),
                .daemon = strdup(setup_rig_path("isothermd")),
                .sys = strdup(setup_rig_path("sys")),
                .dev = strdup(setup_rig_path("dev")),
                .unit = "isothermd.service",
                .manager = {.address = bus.address},
                .daemon_wait_s = 1,
            },
    };
    write_daemon();
    setup_rig_set_devices("");
    *state = &rig;
    return 0;
}

int setup_rig_teardown(void **state)
{
    (void)state;
    setup_rig_end(&rig);
    free(rig.said);
    free((void *)(uintptr_t)rig.places.config);
    free((void *)(uintptr_t)rig.places.cameras);
    free((void *)(uintptr_t)rig.places.daemon);
    free((void *)(uintptr_t)rig.places.sys);
    free((void *)(uintptr_t)rig.places.dev);
    return scratch_teardown(&directory);
}

void setup_rig_begin(struct setup_rig *at, const struct fake_manager_script *manager,
                     const struct fake_script *daemon)
{
    /* An earlier run has installed handlers for these signals. The processes that start here must
     * end at them. */
    (void)signal(SIGTERM, SIG_DFL);
    (void)signal(SIGINT, SIG_DFL);
    if (manager) {
        fake_manager_start(&at->manager, bus.address, manager);
    }
    if (daemon) {
        fake_daemon_start(&at->daemon, bus.address, daemon);
    }
    at->has_manager = manager != NULL;
    at->has_daemon = daemon != NULL;
}

void setup_rig_end(struct setup_rig *at)
{
    at->daemon_calls = at->has_daemon ? fake_daemon_stop(&at->daemon) : "";
    at->calls = at->has_manager ? fake_manager_stop(&at->manager) : "";
    at->has_manager = at->has_daemon = false;
}

static struct cli_setup_wish complete_wish(const struct cli_setup_wish *wish)
{
    struct cli_setup_wish whole = *wish;

    whole.bus = (struct cli_bus){.address = bus.address};
    whole.picture = setup_rig_path("picture.png");
    return whole;
}

enum cli_exit setup_rig_run(struct setup_rig *at, const struct cli_setup_wish *wish,
                            const struct fake_manager_script *manager,
                            const struct fake_script *daemon)
{
    const struct cli_setup_wish whole = complete_wish(wish);
    size_t size;

    free(at->said);
    at->said = NULL;
    at->fault = (struct cli_fault){0};
    struct cli_dialogue dialogue = {.in = STDIN_FILENO, .out = open_memstream(&at->said, &size)};
    assert_non_null(dialogue.out);
    setup_rig_begin(at, manager, daemon);
    const enum cli_exit exit = cli_setup_run(&at->places, &whole, &dialogue, &at->fault);
    setup_rig_end(at);
    assert_int_equal(fclose(dialogue.out), 0);
    return exit;
}

/* ---- at a terminal ---- */

void setup_rig_open(struct setup_rig *at, const struct cli_setup_wish *wish,
                    struct setup_terminal *terminal)
{
    const struct cli_setup_wish whole = complete_wish(wish);
    const struct winsize window = {.ws_row = 24, .ws_col = 80};

    *terminal = (struct setup_terminal){.length = 0};
    terminal->pid = forkpty(&terminal->fd, NULL, NULL, &window);
    assert_true(terminal->pid >= 0);
    if (terminal->pid == 0) {
        const struct cli_dialogue dialogue = {.in = STDIN_FILENO, .out = stdout, .terminal = true};
        (void)prctl(PR_SET_PDEATHSIG, SIGKILL);
        (void)setenv("TERM", "xterm", 1);
        (void)unsetenv("NO_COLOR");
        const enum cli_exit exit = cli_setup_run(&at->places, &whole, &dialogue, &at->fault);
        printf("fault: %s\n", at->fault.text);
        (void)fflush(stdout);
        _exit((int)exit);
    }
}

/* Waits for output of the program and adds it to the text. Returns false at the end of the output.
 */
static bool take_output(struct setup_terminal *terminal)
{
    struct pollfd waiting = {.fd = terminal->fd, .events = POLLIN};

    if (poll(&waiting, 1, SILENCE_MS) != 1) {
        fail_msg("the program hangs; it said: %s", terminal->text);
    }
    const ssize_t n = read(terminal->fd, terminal->text + terminal->length,
                           sizeof terminal->text - 1 - terminal->length);
    terminal->length += n > 0 ? (size_t)n : 0;
    terminal->text[terminal->length] = '\0';
    return n > 0;
}

void setup_rig_answer(struct setup_terminal *terminal, const char *question, const char *answer)
{
    while (!strstr(terminal->text + terminal->asked, question)) {
        if (!take_output(terminal)) {
            fail_msg("'%s' was never asked; but: %s", question, terminal->text);
        }
    }
    terminal->asked = terminal->length;
    assert_int_equal(write(terminal->fd, answer, strlen(answer)), strlen(answer));
}

int setup_rig_close(struct setup_terminal *terminal)
{
    int status;

    while (take_output(terminal)) {
    }
    close(terminal->fd);
    assert_int_equal(waitpid(terminal->pid, &status, 0), terminal->pid);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
}

/* ---- the state of the machine ---- */

const char *setup_rig_png(size_t *size)
{
    static const uint8_t grey[] = {0, 80, 160, 240};
    static uint8_t png[512];
    png_image image = {
        .version = PNG_IMAGE_VERSION, .width = 2, .height = 2, .format = PNG_FORMAT_GRAY};
    png_alloc_size_t length = sizeof png;

    assert_int_not_equal(png_image_write_to_memory(&image, png, &length, 0, grey, 0, NULL), 0);
    *size = length;
    return (const char *)png;
}

size_t setup_rig_count_files(void)
{
    DIR *folder = opendir(setup_rig_path("etc"));
    const struct dirent *entry;
    size_t n = 0;

    while (folder && (entry = readdir(folder))) {
        n += entry->d_name[0] != '.';
    }
    if (folder) {
        closedir(folder);
    }
    return n;
}

void setup_rig_expect_config(const char *text)
{
    char *found = cli_text_file_read(rig.places.config, NULL);

    if (!text) {
        assert_null(found);
        return;
    }
    assert_non_null(found);
    assert_string_equal(found, text);
    free(found);
}

/* ---- shared by the tests ---- */

const char setup_rig_old_text[] = "# By hand.\n[sensor]\nbackend = openni2\n[decision]\n"
                                  "level = strict\n";

const char setup_rig_one_camera[] =
    "{\"sensor\":\"openni2\",\"id\":\"2bc5/0401@1/5\",\"label\":\"Orbbec Astra\"}\n";

void setup_rig_write_old(void)
{
    scratch_mkdir(setup_rig_path("etc"));
    scratch_write_text(setup_rig_path("etc/isotherm.conf"), setup_rig_old_text);
}

void setup_rig_expect_in(const char *text, const char *part)
{
    if (!strstr(text, part)) {
        fail_msg("'%s' is not in: %s", part, text);
    }
}
