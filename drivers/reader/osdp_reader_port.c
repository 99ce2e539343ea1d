#include "drivers/reader/osdp_reader_port.h"

#include <errno.h>
#include <poll.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/random.h>
#include <unistd.h>

#include "drivers/door/osdp/osdp_serial.h"
#include "drivers/process/thread.h"

static const int64_t retry_ns = INT64_C(1000000000);

enum {
    PRIORITY = 20, /* of SCHED_FIFO, as that of the other readers (wiegand_in.h) */
    MARK = 0xFF,   /* before a command, so that the line is at rest when the command begins */
};

struct iso_osdp_reader_port {
    char *path;
    uint32_t baud;
    struct iso_clock clock;
    pthread_t thread;
    int line; /* -1: it is gone; used by the thread alone */
    int64_t retry_at_ns;
    int end_fd;            /* readable: the thread ends */
    int news_fd;           /* readable: an event waits, or the fault has changed */
    pthread_mutex_t mutex; /* protects all members below */
    struct iso_osdp_reader *reader;
    struct iso_fault line_fault;
    enum iso_osdp_reader_problem told;
    uint64_t told_events;
};

static int64_t now_ns(const struct iso_osdp_reader_port *port)
{
    return iso_clock_now_ns(&port->clock);
}

static void lock(struct iso_osdp_reader_port *port)
{
    (void)pthread_mutex_lock(&port->mutex);
}

static void unlock(struct iso_osdp_reader_port *port)
{
    (void)pthread_mutex_unlock(&port->mutex);
}

/* ---- the thread ---- */

/* Wakes the owner if there is something new. The mutex is held. */
static void tell_owner(struct iso_osdp_reader_port *port)
{
    struct iso_osdp_reader_status status;
    iso_osdp_reader_status(port->reader, &status);
    if (status.events != port->told_events || status.problem != port->told) {
        port->told_events = status.events;
        port->told = status.problem;
        (void)eventfd_write(port->news_fd, 1);
    }
}

static void lose_line(struct iso_osdp_reader_port *port)
{
    (void)close(port->line);
    port->line = -1;
    port->retry_at_ns = now_ns(port) + retry_ns;
    lock(port);
    (void)iso_fault_set_code(&port->line_fault, ISO_FAULT_READER_LOST, -ENODEV,
                             "card reader: %s is gone", port->path);
    (void)eventfd_write(port->news_fd, 1);
    unlock(port);
}

/* Tries to open the line. */
static void find_line(struct iso_osdp_reader_port *port)
{
    struct iso_fault fault = {.text = ""};
    const int error = iso_osdp_serial_open(port->path, port->baud, &port->line, &fault);
    if (error) { /* the serial line speaks of the access panel */
        (void)iso_fault_recode(&fault, ISO_FAULT_READER_LOST, error);
    }
    port->retry_at_ns = now_ns(port) + retry_ns;
    lock(port);
    if (strcmp(fault.text, port->line_fault.text) != 0) {
        port->line_fault = fault;
        (void)eventfd_write(port->news_fd, 1);
    }
    if (!error) {
        iso_osdp_reader_restart(port->reader, now_ns(port));
    }
    unlock(port);
}

/* Sends what is due. Returns 0, or a negative errno: the line is gone. */
static int send_command(struct iso_osdp_reader_port *port)
{
    uint8_t bytes[1 + ISO_OSDP_FRAME_BYTES] = {MARK};
    lock(port);
    const size_t n = iso_osdp_reader_send(port->reader, now_ns(port), bytes + 1);
    tell_owner(port);
    unlock(port);
    return n > 0 ? iso_osdp_serial_write(port->line, bytes, 1 + n) : 0;
}

/* Reads what has arrived. Returns 0, or a negative errno: the line is gone. */
static int read_line(struct iso_osdp_reader_port *port)
{
    uint8_t bytes[256];
    const ssize_t n = read(port->line, bytes, sizeof bytes);
    if (n > 0) {
        lock(port);
        iso_osdp_reader_receive(port->reader, bytes, (size_t)n, now_ns(port));
        tell_owner(port);
        unlock(port);
        explicit_bzero(bytes, sizeof bytes);
        return 0;
    }
    return n < 0 && (errno == EAGAIN || errno == EINTR) ? 0 : -EIO;
}

/* How long to wait for a reply, in milliseconds, rounded up. */
static int wait_ms(struct iso_osdp_reader_port *port)
{
    lock(port);
    const int64_t due_ns = port->line < 0 ? port->retry_at_ns
                                          : iso_osdp_reader_due_ns(port->reader);
    unlock(port);
    const int64_t left_ns = due_ns - now_ns(port);
    return left_ns <= 0 ? 0 : (int)((left_ns + 999999) / 1000000);
}

static void *run(void *context)
{
    struct iso_osdp_reader_port *port = context;
    iso_thread_set_name("card reader");
    for (;;) {
        struct pollfd waits[] = {{.fd = port->end_fd, .events = POLLIN},
                                 {.fd = port->line, .events = POLLIN}};
        const int n = poll(waits, 2, wait_ms(port));
        if (n > 0 && waits[0].revents) {
            return NULL;
        }
        if (port->line < 0) {
            if (now_ns(port) >= port->retry_at_ns) {
                find_line(port);
            }
            continue;
        }
        int error = n > 0 && waits[1].revents ? read_line(port) : 0;
        error = error ? error : send_command(port);
        if (error) {
            lose_line(port);
        }
    }
}

/* ---- its owner ---- */

static int make_random(void *context, void *bytes, size_t n)
{
    (void)context;
    return getentropy(bytes, n) ? -errno : 0;
}

static int make_parts(struct iso_osdp_reader_port *port, const char *path,
                      const struct iso_osdp_reader_setup *setup, struct iso_fault *fault)
{
    struct iso_osdp_reader_setup with_random = *setup;
    with_random.random = make_random;
    const int error = iso_osdp_reader_new(&with_random, now_ns(port), &port->reader);
    explicit_bzero(&with_random, sizeof with_random);
    if (error) {
        return iso_fault_set(fault, error, "card reader: %s",
                             error == -ENOMEM ? "out of memory" : "this setup is not possible");
    }
    port->path = strdup(path);
    port->end_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    port->news_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    if (!port->path || port->end_fd < 0 || port->news_fd < 0) {
        return iso_fault_set(fault, -ENOMEM, "card reader: out of memory");
    }
    return 0;
}

static void free_parts(struct iso_osdp_reader_port *port)
{
    const int fds[] = {port->line, port->end_fd, port->news_fd};
    for (size_t i = 0; i < sizeof fds / sizeof *fds; i++) {
        if (fds[i] >= 0) {
            (void)close(fds[i]);
        }
    }
    iso_osdp_reader_free(port->reader);
    (void)pthread_mutex_destroy(&port->mutex);
    free(port->path);
    free(port);
}

int iso_osdp_reader_port_new(const char *path, const struct iso_osdp_reader_setup *setup,
                             const struct iso_clock *clock, struct iso_osdp_reader_port **out,
                             struct iso_fault *fault)
{
    struct iso_osdp_reader_port *new = calloc(1, sizeof *new);
    if (!new) {
        return iso_fault_set(fault, -ENOMEM, "card reader: out of memory");
    }
    new->line = new->end_fd = new->news_fd = -1;
    new->clock = *clock;
    new->baud = setup->baud;
    iso_thread_mutex_init(&new->mutex);
    int error = make_parts(new, path, setup, fault);
    if (!error) {
        find_line(new);
        if (new->line < 0) {
            *fault = new->line_fault;
        }
        error = iso_thread_start_realtime(&new->thread, run, new, PRIORITY, NULL);
        if (error) {
            (void)iso_fault_set(fault, error, "card reader: no thread can be started");
        }
    }
    if (error) {
        free_parts(new);
        return error;
    }
    *out = new;
    return 0;
}

void iso_osdp_reader_port_free(struct iso_osdp_reader_port *port)
{
    if (port) {
        (void)eventfd_write(port->end_fd, 1);
        (void)pthread_join(port->thread, NULL);
        free_parts(port);
    }
}

int iso_osdp_reader_port_fd(const struct iso_osdp_reader_port *port)
{
    return port->news_fd;
}

bool iso_osdp_reader_port_take(struct iso_osdp_reader_port *port, struct iso_reader_event *out)
{
    eventfd_t count;
    lock(port);
    const bool has = iso_osdp_reader_take(port->reader, out);
    if (!has) {
        (void)eventfd_read(port->news_fd, &count);
    }
    unlock(port);
    return has;
}

void iso_osdp_reader_port_fault(struct iso_osdp_reader_port *port, struct iso_fault *out)
{
    static const char *const texts[ISO_OSDP_READER_PROBLEMS] = {
        [ISO_OSDP_READER_SILENT] = "does not answer",
        [ISO_OSDP_READER_OTHER_KEY] = "has another key than the one that is configured",
        [ISO_OSDP_READER_REFUSES] = "refuses the secure channel",
        [ISO_OSDP_READER_WANTS_KEY] = "works in the secure channel only, and no key is configured",
        [ISO_OSDP_READER_TAMPERED] = "says that somebody has opened it",
    };
    struct iso_osdp_reader_status status;
    lock(port);
    iso_osdp_reader_status(port->reader, &status);
    if (*port->line_fault.text || !texts[status.problem]) {
        *out = port->line_fault;
    } else {
        (void)iso_fault_set(out, -EIO, "card reader: the reader on %s %s", port->path,
                            texts[status.problem]);
    }
    unlock(port);
}

void iso_osdp_reader_port_show(struct iso_osdp_reader_port *port, bool allow)
{
    lock(port);
    iso_osdp_reader_show(port->reader, allow);
    unlock(port);
}

void iso_osdp_reader_port_status(struct iso_osdp_reader_port *port,
                                 struct iso_osdp_reader_status *status)
{
    lock(port);
    iso_osdp_reader_status(port->reader, status);
    unlock(port);
}
