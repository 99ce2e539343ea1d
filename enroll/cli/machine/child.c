#include "enroll/cli/machine/child.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "enroll/cli/machine/interrupt.h"

enum { KEPT_BYTES = 256 * 1024, PATIENCE_S = 30, SLICE_MS = 200 };

struct stream {
    int fd; /* -1 after the end of the stream */
    char *text;
    size_t size, room; /* room: bytes of the text */
};

static int spawn(const char *const argv[], int in_fd, int out_fd, int err_fd, pid_t *pid)
{
    posix_spawn_file_actions_t actions;

    int error = posix_spawn_file_actions_init(&actions);
    if (error) {
        return error;
    }
    error = in_fd >= 0 ? posix_spawn_file_actions_adddup2(&actions, in_fd, STDIN_FILENO)
                       : posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null",
                                                          O_RDONLY, 0);
    if (!error) {
        error = posix_spawn_file_actions_adddup2(&actions, out_fd, STDOUT_FILENO);
    }
    if (!error) {
        error = posix_spawn_file_actions_adddup2(&actions, err_fd, STDERR_FILENO);
    }
    if (!error) {
        error = posix_spawn(pid, argv[0], &actions, NULL, (char *const *)(uintptr_t)argv, environ);
    }
    (void)posix_spawn_file_actions_destroy(&actions);
    return error;
}

/* Reads the available output. Output beyond the limit is dropped, so that the program can
 * continue. */
static void take(struct stream *stream)
{
    char piece[4096];
    const ssize_t n = read(stream->fd, piece, sizeof piece);

    if (n < 0 && (errno == EINTR || errno == EAGAIN)) {
        return;
    }
    if (n <= 0) {
        close(stream->fd);
        stream->fd = -1;
        return;
    }
    const size_t room = stream->room - 1 - stream->size;
    const size_t kept = (size_t)n < room ? (size_t)n : room;
    memcpy(stream->text + stream->size, piece, kept);
    stream->size += kept;
    stream->text[stream->size] = '\0';
}

/* Reads both streams to their ends. Returns false if that took too long or was interrupted. */
static bool drain(struct stream streams[2])
{
    struct timespec start, now;

    clock_gettime(CLOCK_MONOTONIC, &start);
    while (streams[0].fd >= 0 || streams[1].fd >= 0) {
        struct pollfd fds[2] = {{.fd = streams[0].fd, .events = POLLIN},
                                {.fd = streams[1].fd, .events = POLLIN}};
        const int ready = poll(fds, 2, SLICE_MS);
        for (int i = 0; ready > 0 && i < 2; i++) {
            if (fds[i].revents) {
                take(&streams[i]);
            }
        }
        clock_gettime(CLOCK_MONOTONIC, &now);
        if (now.tv_sec - start.tv_sec > PATIENCE_S || cli_interrupted()) {
            return false;
        }
    }
    return true;
}

static enum cli_exit run(const char *const argv[], int in_fd, int pipes[2][2],
                         struct stream streams[2], int *code, struct cli_fault *fault)
{
    pid_t pid = 0;
    int status = 0;
    const int error = spawn(argv, in_fd, pipes[0][1], pipes[1][1], &pid);

    close(pipes[0][1]);
    close(pipes[1][1]);
    if (error) {
        return cli_fault_set(fault, CLI_EXIT_FAULT, "no-program", "%s cannot be run: %s", argv[0],
                             strerror(error));
    }
    const bool ended = drain(streams);
    if (!ended) {
        kill(pid, SIGKILL);
    }
    while (waitpid(pid, &status, 0) < 0 && errno == EINTR) {
    }
    if (!ended) {
        return cli_interrupted()
                   ? CLI_EXIT_INTERRUPTED
                   : cli_fault_set(fault, CLI_EXIT_FAULT, "no-program",
                                   "%s has not ended within %d seconds", argv[0], PATIENCE_S);
    }
    *code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return CLI_EXIT_OK;
}

enum cli_exit cli_child_run(const char *const argv[], struct cli_child *out,
                            struct cli_fault *fault)
{
    return cli_child_feed(argv, -1, KEPT_BYTES, out, fault);
}

enum cli_exit cli_child_feed(const char *const argv[], int in_fd, size_t kept_bytes,
                             struct cli_child *out, struct cli_fault *fault)
{
    struct stream streams[2] = {
        {.fd = -1, .text = calloc(1, kept_bytes), .room = kept_bytes},
        {.fd = -1, .text = calloc(1, kept_bytes), .room = kept_bytes},
    };
    int pipes[2][2] = {{-1, -1}, {-1, -1}};
    enum cli_exit exit;

    if (!streams[0].text || !streams[1].text || pipe2(pipes[0], O_CLOEXEC) < 0 ||
        pipe2(pipes[1], O_CLOEXEC) < 0) {
        exit = cli_fault_set(fault, CLI_EXIT_FAULT, "internal", "%s: %s", argv[0], strerror(errno));
        close(pipes[0][0]);
        close(pipes[0][1]);
    } else {
        streams[0].fd = pipes[0][0];
        streams[1].fd = pipes[1][0];
        exit = run(argv, in_fd, pipes, streams, &out->exit, fault);
    }
    for (int i = 0; i < 2; i++) {
        if (streams[i].fd >= 0) {
            close(streams[i].fd);
        }
    }
    if (exit) {
        free(streams[0].text);
        free(streams[1].text);
        return exit;
    }
    out->out = streams[0].text;
    out->err = streams[1].text;
    return CLI_EXIT_OK;
}

void cli_child_done(struct cli_child *child)
{
    free(child->out);
    free(child->err);
    *child = (struct cli_child){0};
}
