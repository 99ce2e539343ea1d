#include "drivers/reader/wiegand_in.h"

#include <errno.h>
#include <poll.h>
#include <pthread.h>
#include <stdlib.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "drivers/base/times.h"
#include "drivers/process/thread.h"

static const int64_t retry_ns = INT64_C(1000000000);

enum {
    PRIORITY = 20, /* of SCHED_FIFO, as that of the sender (wiegand_out.h) */
    ASK_MS = 1000, /* how often quiet lines are asked whether they are still there */
};

struct iso_wiegand_in {
    pthread_t thread;
    int end_fd;  /* readable: the thread ends */
    int news_fd; /* readable: the queue is not empty, or the fault has changed */
    struct iso_gpio_spec specs[2];

    /* Of the thread. */
    struct iso_gpio_line *lines[2];
    struct iso_wiegand_frame frame;
    int64_t retry_at_ns;

    pthread_mutex_t mutex; /* protects the members below */
    struct iso_reader_event events[ISO_WIEGAND_IN_EVENTS];
    int first, n;
    struct iso_fault fault;
};

static void tell_news(const struct iso_wiegand_in *reader)
{
    const uint64_t one = 1;
    (void)!write(reader->news_fd, &one, sizeof one);
}

static void set_fault(struct iso_wiegand_in *reader, const struct iso_fault *fault)
{
    (void)pthread_mutex_lock(&reader->mutex);
    reader->fault = *fault;
    (void)pthread_mutex_unlock(&reader->mutex);
    tell_news(reader);
}

/* ---- the thread ---- */

static void close_lines(struct iso_wiegand_in *reader)
{
    for (int i = 0; i < 2; i++) {
        iso_gpio_line_close(reader->lines[i]);
        reader->lines[i] = NULL;
    }
    reader->frame = (struct iso_wiegand_frame){.n = 0};
    reader->retry_at_ns = iso_monotonic_ns() + retry_ns;
}

static int open_lines(struct iso_wiegand_in *reader, struct iso_fault *fault)
{
    int error = 0;
    for (int i = 0; !error && i < 2; i++) {
        error = iso_gpio_line_open_input(&reader->specs[i], &reader->lines[i], fault);
    }
    if (error) {
        close_lines(reader);
    }
    return error;
}

static void mend_lines(struct iso_wiegand_in *reader)
{
    struct iso_fault fault = {.text = ""};
    if (iso_monotonic_ns() >= reader->retry_at_ns && open_lines(reader, &fault) == 0) {
        set_fault(reader, &(struct iso_fault){.text = ""});
    }
}

static void queue(struct iso_wiegand_in *reader, const struct iso_reader_event *event)
{
    if (event->kind == ISO_READER_NOTHING) {
        return;
    }
    (void)pthread_mutex_lock(&reader->mutex);
    if (reader->n < ISO_WIEGAND_IN_EVENTS) {
        reader->events[(reader->first + reader->n++) % ISO_WIEGAND_IN_EVENTS] = *event;
    }
    (void)pthread_mutex_unlock(&reader->mutex);
    tell_news(reader);
}

/* Takes the edges of a line; a pulse begins when the line becomes active. */
static int read_line(struct iso_wiegand_in *reader, int line)
{
    struct iso_gpio_edge edge;
    int error = 0;
    while (!(error = iso_gpio_line_next_edge(reader->lines[line], &edge))) {
        if (edge.active) {
            iso_wiegand_frame_pulse(&reader->frame, line == 1, edge.t_ns);
        }
    }
    return error == -EAGAIN ? 0 : error;
}

/* A chip that disappears does not wake the thread on every kernel, so the lines are asked. */
static int ask_line(const struct iso_wiegand_in *reader, int line)
{
    bool active;
    return iso_gpio_line_get(reader->lines[line], &active);
}

/* `quiet`: nothing has come for a while. */
static void read_lines(struct iso_wiegand_in *reader, bool quiet)
{
    int error = read_line(reader, 0);
    error = error ? error : read_line(reader, 1);
    if (!error && quiet) {
        error = ask_line(reader, 0);
        error = error ? error : ask_line(reader, 1);
    }
    if (error) {
        struct iso_fault fault = {.text = ""};
        (void)iso_fault_set_code(&fault, iso_gpio_fault_code(error), error,
                                 "the lines of the card reader are gone");
        close_lines(reader);
        set_fault(reader, &fault);
    }
}

/* How long to wait for an edge, in milliseconds, rounded up. */
static int wait_ms(const struct iso_wiegand_in *reader)
{
    const int64_t due_ns = reader->lines[0] ? iso_wiegand_frame_due_ns(&reader->frame)
                                            : reader->retry_at_ns;
    if (due_ns == INT64_MAX) {
        return ASK_MS;
    }
    const int64_t left_ns = due_ns - iso_monotonic_ns();
    return left_ns <= 0 ? 0 : (int)((left_ns + 999999) / 1000000);
}

static void *run(void *context)
{
    struct iso_wiegand_in *reader = context;
    iso_thread_set_name("card reader");
    for (;;) {
        struct pollfd fds[3] = {{.fd = reader->end_fd, .events = POLLIN}};
        for (int i = 0; i < 2; i++) {
            fds[i + 1] = (struct pollfd){
                .fd = reader->lines[i] ? iso_gpio_line_fd(reader->lines[i]) : -1, .events = POLLIN};
        }
        const int ready = poll(fds, 3, wait_ms(reader));
        if (fds[0].revents) {
            return NULL;
        }
        if (reader->lines[0]) {
            read_lines(reader, ready == 0);
        } else {
            mend_lines(reader);
        }
        const struct iso_reader_event event = iso_wiegand_frame_time(&reader->frame,
                                                                     iso_monotonic_ns());
        queue(reader, &event);
    }
}

/* ---- the owner ---- */

static int start(struct iso_wiegand_in *reader, struct iso_fault *fault)
{
    reader->end_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    reader->news_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    if (reader->end_fd < 0 || reader->news_fd < 0) {
        return iso_fault_set(fault, -errno, "card reader: no descriptor: %m");
    }
    if (open_lines(reader, &reader->fault)) {
        *fault = reader->fault;
    }
    const int error = iso_thread_start_realtime(&reader->thread, run, reader, PRIORITY, NULL);
    return error ? iso_fault_set(fault, error, "card reader: no thread can be started") : 0;
}

static void release(struct iso_wiegand_in *reader)
{
    close_lines(reader);
    if (reader->end_fd >= 0) {
        (void)close(reader->end_fd);
    }
    if (reader->news_fd >= 0) {
        (void)close(reader->news_fd);
    }
    (void)pthread_mutex_destroy(&reader->mutex);
    free(reader);
}

int iso_wiegand_in_new(const struct iso_gpio_spec lines[2], struct iso_wiegand_in **out,
                       struct iso_fault *fault)
{
    struct iso_wiegand_in *reader = calloc(1, sizeof *reader);
    if (!reader) {
        return iso_fault_set(fault, -ENOMEM, "card reader: out of memory");
    }
    reader->specs[0] = lines[0];
    reader->specs[1] = lines[1];
    reader->end_fd = reader->news_fd = -1;
    iso_thread_mutex_init(&reader->mutex);
    const int error = start(reader, fault);
    if (error) {
        release(reader);
        return error;
    }
    *out = reader;
    return 0;
}

void iso_wiegand_in_free(struct iso_wiegand_in *reader)
{
    if (reader) {
        const uint64_t one = 1;
        (void)!write(reader->end_fd, &one, sizeof one);
        (void)pthread_join(reader->thread, NULL);
        release(reader);
    }
}

int iso_wiegand_in_fd(const struct iso_wiegand_in *reader)
{
    return reader->news_fd;
}

bool iso_wiegand_in_take(struct iso_wiegand_in *reader, struct iso_reader_event *out)
{
    uint64_t count;
    (void)pthread_mutex_lock(&reader->mutex);
    const bool has = reader->n > 0;
    if (has) {
        *out = reader->events[reader->first];
        reader->events[reader->first] = (struct iso_reader_event){.kind = ISO_READER_NOTHING};
        reader->first = (reader->first + 1) % ISO_WIEGAND_IN_EVENTS;
        reader->n--;
    } else {
        (void)!read(reader->news_fd, &count, sizeof count);
    }
    (void)pthread_mutex_unlock(&reader->mutex);
    return has;
}

void iso_wiegand_in_fault(struct iso_wiegand_in *reader, struct iso_fault *out)
{
    (void)pthread_mutex_lock(&reader->mutex);
    *out = reader->fault;
    (void)pthread_mutex_unlock(&reader->mutex);
}
