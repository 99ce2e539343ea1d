#include "firmware/daemon/quit_signal.h"

#include <errno.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdint.h>
#include <sys/eventfd.h>
#include <unistd.h>

static atomic_int quit_fd = -1; /* used by the handler; a process has only one daemon */

/* This is a handler and not a signalfd, because a signalfd needs the signal blocked in all threads,
 * and the linear algebra library has started some before main(). */
static void on_quit_signal(int number)
{
    const int saved = errno;
    const uint64_t one = 1;
    (void)number;
    (void)!write(quit_fd, &one, sizeof one);
    errno = saved;
}

static int on_quit(sd_event_source *source, int fd, uint32_t events, void *context)
{
    (void)source;
    (void)fd;
    (void)events;
    *(bool *)context = true;
    return 0;
}

int iso_quit_signal_catch(sd_event *event, bool *quit)
{
    const struct sigaction action = {.sa_handler = on_quit_signal, .sa_flags = SA_RESTART};
    const int fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    quit_fd = fd;
    if (fd < 0 || sigaction(SIGTERM, &action, NULL) || sigaction(SIGINT, &action, NULL)) {
        return -errno;
    }
    return sd_event_add_io(event, NULL, fd, EPOLLIN, on_quit, quit);
}

/* The descriptor stays open until the process ends. The handler may still run in another thread,
 * and must not write to a file that was opened later under the same number. */
void iso_quit_signal_release(void)
{
    (void)signal(SIGTERM, SIG_DFL);
    (void)signal(SIGINT, SIG_DFL);
}
