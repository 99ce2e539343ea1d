#include "drivers/door/osdp/osdp_port.h"

#include <errno.h>
#include <poll.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/random.h>
#include <termios.h>
#include <unistd.h>

#include "drivers/door/osdp/osdp_serial.h"
#include "drivers/process/thread.h"

enum {
    TICK_MS = 250,   /* how often the thread looks at the time while nothing arrives */
    RETRY_MS = 1000, /* how often it tries to open a line that is gone */
    MARK = 0xFF,     /* before a reply, so that the line is at rest when the reply begins */
};

struct iso_osdp_port {
    char *path;
    struct iso_clock clock;
    pthread_t thread;
    int line;              /* -1: it is gone; used by the thread alone */
    int wake, event;       /* eventfd: ends the thread; tells the owner */
    pthread_mutex_t mutex; /* protects all members below */
    struct iso_osdp_peripheral *device;
    struct iso_osdp_port_status told; /* the state that the owner knows of or has been told of */
    bool realtime, line_gone;
    uint64_t late;
};

static void lock(struct iso_osdp_port *port)
{
    (void)pthread_mutex_lock(&port->mutex);
}

static void unlock(struct iso_osdp_port *port)
{
    (void)pthread_mutex_unlock(&port->mutex);
}

/* ---- the thread ---- */

static void read_status(const struct iso_osdp_port *port, struct iso_osdp_port_status *status)
{
    memset(status, 0, sizeof *status);
    iso_osdp_peripheral_status(port->device, iso_clock_now_ns(&port->clock), &status->device);
    status->realtime = port->realtime;
    status->line_gone = port->line_gone;
    status->late = port->late;
}

static bool is_shown(const struct iso_osdp_shown *a, const struct iso_osdp_shown *b)
{
    return a->lamp == b->lamp && a->buzzer == b->buzzer &&
           memcmp(a->text, b->text, sizeof a->text) == 0;
}

static bool is_news(const struct iso_osdp_port_status *a, const struct iso_osdp_port_status *b)
{
    const struct iso_osdp_status *x = &a->device, *y = &b->device;
    return a->line_gone != b->line_gone || x->online != y->online || x->secure != y->secure ||
           x->default_key != y->default_key || x->install != y->install ||
           x->address != y->address || x->baud != y->baud || x->undelivered != y->undelivered ||
           x->keys_set != y->keys_set || !is_shown(&x->shown, &y->shown);
}

/* Wakes the owner if there is something new. The mutex is held. */
static void tell_owner(struct iso_osdp_port *port)
{
    struct iso_osdp_port_status now;
    read_status(port, &now);
    if (is_news(&now, &port->told)) {
        port->told = now;
        (void)eventfd_write(port->event, 1);
    }
}

/* Sends mark and reply. Returns 0, or a negative errno: the line is gone. */
static int send_reply(const struct iso_osdp_port *port, const uint8_t *bytes, size_t n)
{
    int error = iso_osdp_serial_write(port->line, bytes, n);
    /* The new speed of COMSET must not touch the bytes of the reply. */
    if (!error && tcdrain(port->line) && errno != EINTR) {
        error = -errno;
    }
    return error;
}

static uint32_t note_sent(struct iso_osdp_port *port)
{
    lock(port);
    const uint32_t baud = iso_osdp_peripheral_sent(port->device);
    unlock(port);
    return baud;
}

/* Gives bytes to the device and sends its reply. */
static int handle(struct iso_osdp_port *port, const uint8_t *bytes, size_t n, uint32_t *baud)
{
    uint8_t reply[1 + ISO_OSDP_FRAME_BYTES] = {MARK};
    const int64_t arrived_ns = iso_clock_now_ns(&port->clock);
    lock(port);
    const size_t n_reply = iso_osdp_peripheral_receive(port->device, bytes, n, arrived_ns,
                                                       reply + 1);
    const bool late = iso_clock_now_ns(&port->clock) - arrived_ns > ISO_OSDP_REPLY_NS;
    port->late += n_reply > 0 && late;
    tell_owner(port);
    unlock(port);
    if (n_reply == 0 || late) {
        return 0;
    }
    const int error = send_reply(port, reply, 1 + n_reply);
    const uint32_t next = note_sent(port);
    if (!error && next != *baud) {
        *baud = next;
        return iso_osdp_serial_set_baud(port->line, next);
    }
    return error;
}

static void lose_line(struct iso_osdp_port *port)
{
    (void)close(port->line);
    port->line = -1;
    lock(port);
    port->line_gone = true;
    tell_owner(port);
    unlock(port);
}

static void find_line(struct iso_osdp_port *port, uint32_t baud)
{
    int line;
    if (iso_osdp_serial_open(port->path, baud, &line, NULL) == 0) {
        port->line = line;
        lock(port);
        port->line_gone = false;
        tell_owner(port);
        unlock(port);
    }
}

/* Reads what has arrived. Returns 0, or a negative errno: the line is gone. */
static int read_line(struct iso_osdp_port *port, uint32_t *baud)
{
    uint8_t bytes[256];
    const ssize_t n = read(port->line, bytes, sizeof bytes);
    if (n > 0) {
        return handle(port, bytes, (size_t)n, baud);
    }
    return n < 0 && (errno == EAGAIN || errno == EINTR) ? 0 : -EIO;
}

static void *run_port(void *context)
{
    struct iso_osdp_port *port = context;
    iso_thread_set_name("isothermd-osdp");
    uint32_t baud = note_sent(port);
    for (;;) {
        struct pollfd waits[] = {{.fd = port->wake, .events = POLLIN},
                                 {.fd = port->line, .events = POLLIN}};
        const int n = poll(waits, 2, port->line < 0 ? RETRY_MS : TICK_MS);
        if (n > 0 && waits[0].revents) {
            return NULL;
        }
        if (port->line < 0) {
            find_line(port, baud);
        } else if (n > 0 && waits[1].revents && read_line(port, &baud)) {
            lose_line(port);
        }
        lock(port);
        iso_osdp_peripheral_tick(port->device, iso_clock_now_ns(&port->clock));
        tell_owner(port);
        unlock(port);
    }
}

/* ---- its owner ---- */

static int make_random(void *context, void *bytes, size_t n)
{
    (void)context;
    return getentropy(bytes, n) ? -errno : 0;
}

static int make_parts(struct iso_osdp_port *port, const char *path,
                      const struct iso_osdp_setup *setup, struct iso_fault *fault)
{
    struct iso_osdp_setup with_random = *setup;
    with_random.random = make_random;
    const int error = iso_osdp_peripheral_new(&with_random, &port->device);
    explicit_bzero(&with_random, sizeof with_random);
    if (error) {
        return iso_fault_set(fault, error, "osdp: %s",
                             error == -ENOMEM ? "out of memory" : "this setup is not possible");
    }
    port->path = strdup(path);
    port->wake = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    port->event = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    if (!port->path || port->wake < 0 || port->event < 0) {
        return iso_fault_set(fault, -ENOMEM, "osdp: out of memory");
    }
    return 0;
}

/* Opens the line, or leaves it gone. */
static int open_line(struct iso_osdp_port *port, uint32_t baud, struct iso_fault *absent,
                     struct iso_fault *fault)
{
    struct iso_fault why = {.text = ""};
    const int error = iso_osdp_serial_open(port->path, baud, &port->line, &why);
    port->line_gone = error == -ENODEV || error == -EACCES || error == -EBUSY || error == -EIO;
    if (error && !port->line_gone) {
        return iso_fault_set_code(fault, why.code, error, "%s", why.text);
    }
    *absent = why;
    return 0;
}

static void free_parts(struct iso_osdp_port *port)
{
    const int fds[] = {port->line, port->wake, port->event};
    for (size_t i = 0; i < sizeof fds / sizeof *fds; i++) {
        if (fds[i] >= 0) {
            (void)close(fds[i]);
        }
    }
    iso_osdp_peripheral_free(port->device);
    (void)pthread_mutex_destroy(&port->mutex);
    free(port->path);
    free(port);
}

int iso_osdp_port_new(const char *path, const struct iso_osdp_setup *setup,
                      const struct iso_clock *clock, struct iso_osdp_port **out,
                      struct iso_fault *absent, struct iso_fault *fault)
{
    struct iso_osdp_port *new = calloc(1, sizeof *new);
    if (!new) {
        return iso_fault_set(fault, -ENOMEM, "osdp: out of memory");
    }
    new->line = new->wake = new->event = -1;
    new->clock = *clock;
    iso_thread_mutex_init(&new->mutex);
    struct iso_fault why = {.text = ""};
    int error = make_parts(new, path, setup, fault);
    if (!error) {
        error = open_line(new, setup->saved.baud, &why, fault);
    }
    if (!error) {
        read_status(new, &new->told);
        bool realtime = false;
        error = iso_thread_start_realtime(&new->thread, run_port, new, ISO_OSDP_PRIORITY,
                                          &realtime);
        lock(new);
        new->realtime = realtime;
        unlock(new);
        if (error) {
            (void)iso_fault_set(fault, error, "osdp: no thread: %s", strerror(-error));
        }
    }
    if (error) {
        free_parts(new);
        return error;
    }
    *absent = why;
    *out = new;
    return 0;
}

void iso_osdp_port_free(struct iso_osdp_port *port)
{
    if (port) {
        (void)eventfd_write(port->wake, 1);
        (void)pthread_join(port->thread, NULL);
        free_parts(port);
    }
}

int iso_osdp_port_event_fd(const struct iso_osdp_port *port)
{
    return port->event;
}

void iso_osdp_port_look(struct iso_osdp_port *port, struct iso_osdp_port_status *status)
{
    eventfd_t count;
    lock(port);
    (void)eventfd_read(port->event, &count);
    read_status(port, status);
    port->told = *status;
    unlock(port);
}

int iso_osdp_port_card(struct iso_osdp_port *port, const uint8_t *bytes, size_t bits)
{
    lock(port);
    const int error = iso_osdp_peripheral_card(port->device, bytes, bits);
    unlock(port);
    return error;
}

int iso_osdp_port_digits(struct iso_osdp_port *port, const char *digits)
{
    lock(port);
    const int error = iso_osdp_peripheral_digits(port->device, digits);
    unlock(port);
    return error;
}

void iso_osdp_port_set_tamper(struct iso_osdp_port *port, bool tamper)
{
    lock(port);
    iso_osdp_peripheral_set_tamper(port->device, tamper);
    unlock(port);
}

void iso_osdp_port_set_reader(struct iso_osdp_port *port, uint8_t reader)
{
    lock(port);
    iso_osdp_peripheral_set_reader(port->device, reader);
    unlock(port);
}

void iso_osdp_port_set_input(struct iso_osdp_port *port, unsigned input, bool active)
{
    lock(port);
    iso_osdp_peripheral_set_input(port->device, input, active);
    unlock(port);
}

void iso_osdp_port_install(struct iso_osdp_port *port)
{
    lock(port);
    iso_osdp_peripheral_install(port->device, iso_clock_now_ns(&port->clock));
    tell_owner(port);
    unlock(port);
}
