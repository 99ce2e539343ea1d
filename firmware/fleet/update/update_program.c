/* isotherm(1), which asks RAUC for the slots: it knows RAUC's interface. */
#include <errno.h>
#include <jansson.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/mman.h>
#include <sys/pidfd.h>
#include <sys/wait.h>
#include <unistd.h>

#include "firmware/fleet/update/update_inner.h"

enum { KILLED = 255 };

/* The two descriptors of the program's output are the file in memory; its signals are as usual,
 * because the event loop blocks some of them. It has no connection of this process: libmosquitto
 * and libcurl leave theirs open in other programs, and as long as another program has a socket, the
 * kernel reports events of it to the loop here, although its source is gone. */
static int spawn(const char *const argv[], int out_fd, pid_t *pid)
{
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    sigset_t none;
    int error = posix_spawn_file_actions_init(&actions);

    if (error) {
        return -error;
    }
    error = posix_spawnattr_init(&attributes);
    if (!error) {
        (void)sigemptyset(&none);
        error = posix_spawnattr_setsigmask(&attributes, &none);
        error = error ? error : posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
        error = error ? error : posix_spawn_file_actions_adddup2(&actions, out_fd, STDOUT_FILENO);
        error = error ? error : posix_spawn_file_actions_adddup2(&actions, out_fd, STDERR_FILENO);
        error = error ? error
                      : posix_spawn_file_actions_addclosefrom_np(&actions, STDERR_FILENO + 1);
        error = error ? error
                      : posix_spawn(pid, argv[0], &actions, &attributes,
                                    (char *const *)(uintptr_t)argv, environ);
        (void)posix_spawnattr_destroy(&attributes);
    }
    (void)posix_spawn_file_actions_destroy(&actions);
    return -error;
}

int link_update_run(struct link_update *u,
                    int (*on_end)(sd_event_source *source, int fd, uint32_t events, void *context))
{
    const char *const argv[] = {u->setup.program, "update", "--json", NULL};
    struct link_update_child *child = &u->child;

    link_update_child_free(child);
    child->out_fd = memfd_create("isotherm-update", MFD_CLOEXEC);
    if (child->out_fd < 0) {
        return -errno;
    }
    int r = spawn(argv, child->out_fd, &child->pid);
    if (r < 0) {
        child->pid = 0;
    } else {
        child->pid_fd = pidfd_open(child->pid, 0);
        r = child->pid_fd < 0 ? -errno
                              : sd_event_add_io(u->setup.event, &child->source, child->pid_fd,
                                                EPOLLIN, on_end, u);
    }
    if (r < 0) {
        link_update_child_free(child);
    }
    return r < 0 ? r : 0;
}

int link_update_ended(struct link_update *u, char *text, size_t size)
{
    struct link_update_child *child = &u->child;
    int status = 0;
    const pid_t pid = waitpid(child->pid, &status, 0);
    const ssize_t n = pread(child->out_fd, text, size - 1, 0);

    child->pid = 0;
    text[n > 0 ? n : 0] = '\0';
    link_update_child_free(child);
    return pid > 0 && WIFEXITED(status) ? WEXITSTATUS(status) : KILLED;
}

void link_update_child_free(struct link_update_child *child)
{
    sd_event_source_disable_unref(child->source);
    if (child->pid > 0) {
        (void)kill(child->pid, SIGTERM);
        (void)waitpid(child->pid, NULL, 0);
    }
    if (child->pid_fd >= 0) {
        (void)close(child->pid_fd);
    }
    if (child->out_fd >= 0) {
        (void)close(child->out_fd);
    }
    *child = (struct link_update_child){.pid_fd = -1, .out_fd = -1};
}

static bool take_word(const json_t *text, char out[ISO_FLEET_UPDATE_WORD_SIZE])
{
    const char *word = json_string_value(text);

    if (!word || !iso_fleet_update_word_is_good(word)) {
        return false;
    }
    (void)snprintf(out, ISO_FLEET_UPDATE_WORD_SIZE, "%s", word);
    return true;
}

int link_update_slots_read(const char *text, struct link_update_slots *out)
{
    struct link_update_slots read = {.good = false};
    json_t *object = json_loads(text, JSON_DISABLE_EOF_CHECK, NULL);
    const json_t *slots = json_object_get(object, "slots");
    bool has_running = false;

    for (size_t i = 0; i < json_array_size(slots); i++) {
        const json_t *slot = json_array_get(slots, i);
        const bool running = json_is_true(json_object_get(slot, "running"));
        const bool next = json_is_true(json_object_get(slot, "next"));
        has_running = has_running || running;
        read.good = read.good || (running && json_is_true(json_object_get(slot, "good")));
        read.waiting = read.waiting || (!running && next);
        if (!running && !take_word(json_object_get(slot, "version"), read.other)) {
            read.other[0] = '\0';
        }
    }
    const bool is_read = has_running &&
                         take_word(json_object_get(object, "version"), read.version) &&
                         take_word(json_object_get(object, "board"), read.board);
    /* As long as nobody has said it, it is not: check-health says it soon after the start. */
    read.proven = json_is_true(json_object_get(object, "proven"));
    json_decref(object);
    if (!is_read) {
        return -EBADMSG;
    }
    *out = read;
    return 0;
}
