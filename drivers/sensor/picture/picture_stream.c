#include "drivers/sensor/picture/picture_stream.h"

#include <errno.h>
#include <limits.h>
#include <poll.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <unistd.h>

#include "drivers/sensor/picture/picture_pair.h"

/* Pictures of one camera that wait for their partners, the oldest first. */
enum { WAITING_MAX = 3 };

struct camera {
    struct iso_picture_source source;
    size_t n_waiting;
    struct iso_picture waiting[WAITING_MAX];
    uint8_t *copies[WAITING_MAX + 1]; /* of the waiting pictures; the caller has the last one */
    bool has_newest;                  /* since the start: `newest` is the last picture's number */
    uint32_t newest;
};

struct iso_picture_stream {
    const char *owner;
    struct iso_clock clock;
    int64_t (*monotonic_ns)(void *context);
    void *context;
    struct camera cameras[ISO_PICTURE_CAMERAS_MAX];
    int n_cameras, epoll_fd;
    int64_t tolerance_ns;
    uint64_t last_sequence; /* of the last set; last_number is the device's number of its picture */
    uint32_t last_number;
    bool started[ISO_PICTURE_CAMERAS_MAX];
    bool has_number, has_last; /* since the start; since the opening */
    int64_t last_ns;
    int64_t interval_ns, handed_ns; /* of the sets that are wanted; the time of the last one */
    int64_t came_ns;                /* when the caller called wait last */
    bool absent;  /* the caller let pictures wait before this call, because few are wanted */
    bool excused; /* pictures that are missing now may have been dropped by that */
    uint64_t dropped;
};

/* ---- opening and closing ---------------------------------------------------- */

/* None of the supported formats takes more than two bytes a pixel. */
static int add_camera(struct iso_picture_stream *s,
                      const struct iso_picture_stream_options *options, int index,
                      struct iso_fault *fault)
{
    struct camera *camera = &s->cameras[index];
    const size_t bytes = 2 * (size_t)options->width_px * (size_t)options->height_px;
    camera->source = options->sources[index];
    for (int i = 0; i <= WAITING_MAX; i++) {
        camera->copies[i] = malloc(bytes);
        if (!camera->copies[i]) {
            return iso_fault_set(fault, -ENOMEM, "%s: out of memory", options->owner);
        }
    }
    return 0;
}

int iso_picture_stream_open(const struct iso_picture_stream_options *options,
                            struct iso_picture_stream **out, struct iso_fault *fault)
{
    struct iso_picture_stream *stream = calloc(1, sizeof *stream);
    if (!stream) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", options->owner);
    }
    stream->owner = options->owner;
    stream->clock = *options->clock;
    stream->monotonic_ns = options->monotonic_ns;
    stream->context = options->context;
    stream->n_cameras = options->n_cameras;
    stream->tolerance_ns = options->tolerance_ns;
    stream->last_ns = INT64_MIN;
    stream->epoll_fd = epoll_create1(EPOLL_CLOEXEC);
    int error = 0;
    if (stream->epoll_fd < 0) {
        error = iso_fault_set(fault, -EIO, "%s: epoll: %m", options->owner);
    }
    for (int i = 0; !error && i < options->n_cameras; i++) {
        error = add_camera(stream, options, i, fault);
    }
    if (error) {
        iso_picture_stream_close(stream);
        return error;
    }
    *out = stream;
    return 0;
}

void iso_picture_stream_close(struct iso_picture_stream *stream)
{
    if (!stream) {
        return;
    }
    for (int i = 0; i < ISO_PICTURE_CAMERAS_MAX; i++) {
        struct camera *camera = &stream->cameras[i];
        for (int k = 0; k <= WAITING_MAX; k++) {
            free(camera->copies[k]);
        }
    }
    if (stream->epoll_fd >= 0) {
        (void)close(stream->epoll_fd);
    }
    free(stream);
}

/* A camera is polled only while it streams. Polling a video node before that would start the
 * kernel's emulation of read(), and keep the node busy. */
static int start_camera(struct iso_picture_stream *s, int index, struct iso_fault *fault)
{
    struct camera *camera = &s->cameras[index];
    struct epoll_event event = {.events = EPOLLIN};
    camera->n_waiting = 0;
    camera->has_newest = false;
    const int error = camera->source.start(camera->source.self, fault);
    if (error) {
        return error;
    }
    s->started[index] = true;
    if (epoll_ctl(s->epoll_fd, EPOLL_CTL_ADD, camera->source.fd(camera->source.self), &event) !=
        0) {
        return iso_fault_set_code(fault, ISO_FAULT_SENSOR_FAILED, -EIO,
                                  "%s: a camera cannot be polled: %m", s->owner);
    }
    return 0;
}

int iso_picture_stream_start(struct iso_picture_stream *stream, struct iso_fault *fault)
{
    stream->has_number = false;
    stream->interval_ns = 0;
    stream->excused = false;
    for (int i = 0; i < stream->n_cameras; i++) {
        const int error = start_camera(stream, i, fault);
        if (error) {
            (void)iso_picture_stream_stop(stream);
            return error;
        }
    }
    return 0;
}

int iso_picture_stream_stop(struct iso_picture_stream *stream)
{
    int worst = 0;
    for (int i = 0; i < stream->n_cameras; i++) {
        const struct iso_picture_source *source = &stream->cameras[i].source;
        if (stream->started[i]) {
            (void)epoll_ctl(stream->epoll_fd, EPOLL_CTL_DEL, source->fd(source->self), NULL);
            const int error = source->stop(source->self);
            worst = error == -ENODEV || !worst ? error : worst;
            stream->started[i] = false;
        }
    }
    return worst;
}

/* ---- pictures --------------------------------------------------------------- */

static void drop_oldest(struct camera *camera)
{
    uint8_t *copy = camera->copies[0];
    camera->n_waiting--;
    memmove(camera->waiting, camera->waiting + 1, camera->n_waiting * sizeof *camera->waiting);
    memmove(camera->copies, camera->copies + 1, (WAITING_MAX - 1) * sizeof *camera->copies);
    camera->copies[WAITING_MAX - 1] = copy;
}

static void count_dropped(struct iso_picture_stream *s)
{
    s->dropped += !s->excused;
}

/* The picture is copied without padding, so that the kernel gets its buffer back at once. */
static void copy_picture(struct camera *camera, struct iso_picture *picture)
{
    uint8_t *copy = camera->copies[camera->n_waiting];
    for (size_t i = 0; i < (size_t)picture->height_px; i++) {
        memcpy(copy + i * picture->row_bytes, picture->bytes + i * picture->stride_bytes,
               picture->row_bytes);
    }
    picture->stride_bytes = picture->row_bytes;
    picture->bytes = copy;
}

/* Whether a picture arrives after one that was taken later. Its sequence number has already been
 * counted as a gap. The numbers of devices have 32 bits and then start again. */
static bool is_late(struct camera *camera, const struct iso_picture *picture)
{
    if (camera->has_newest && (int32_t)(picture->sequence - camera->newest) <= 0) {
        return true;
    }
    camera->has_newest = true;
    camera->newest = picture->sequence;
    return false;
}

static int refuse_late(struct iso_picture_stream *s, const struct camera *camera,
                       const struct iso_picture *picture, struct iso_fault *fault)
{
    const int error = camera->source.give_back(camera->source.self, fault);
    s->dropped++;
    return error ? error
                 : iso_fault_set_code(fault, ISO_FAULT_SENSOR_FAILED, -EBADMSG,
                                      "%s: picture %lu comes after picture %lu", s->owner,
                                      (unsigned long)picture->sequence,
                                      (unsigned long)camera->newest);
}

/* Takes the pictures of a camera that the kernel has ready. */
static int fetch_pictures(struct iso_picture_stream *s, struct camera *camera,
                          struct iso_fault *fault)
{
    int error = 0;
    while (!error) {
        struct iso_picture picture;
        error = camera->source.take(camera->source.self, &picture, fault);
        if (error) {
            break;
        }
        if (is_late(camera, &picture)) {
            return refuse_late(s, camera, &picture, fault);
        }
        if (camera->n_waiting == WAITING_MAX) {
            drop_oldest(camera);
            count_dropped(s);
        }
        copy_picture(camera, &picture);
        camera->waiting[camera->n_waiting++] = picture;
        error = camera->source.give_back(camera->source.self, fault);
        if (s->n_cameras == 1) {
            break; /* more pictures may wait in the kernel */
        }
    }
    return error == -EAGAIN ? 0 : error;
}

static enum iso_pair_verdict judge_pair(const struct iso_picture_stream *s)
{
    int64_t stamps[ISO_PICTURE_CAMERAS_MAX][WAITING_MAX];
    if (s->n_cameras == 1) {
        return s->cameras[0].n_waiting > 0 ? ISO_PAIR_TAKE : ISO_PAIR_WAIT;
    }
    for (int i = 0; i < ISO_PICTURE_CAMERAS_MAX; i++) {
        for (size_t k = 0; k < s->cameras[i].n_waiting; k++) {
            stamps[i][k] = s->cameras[i].waiting[k].stamp_ns;
        }
    }
    return iso_pair_judge(stamps[0], s->cameras[0].n_waiting, stamps[1], s->cameras[1].n_waiting,
                          s->tolerance_ns);
}

/* Moves the oldest pictures out of the queues, because the next fetch would overwrite them there.
 * Returns false if the set is passed over: the next set then follows the one before this one. */
static bool hand_out(struct iso_picture_stream *s, struct iso_picture_set *out)
{
    for (int i = 0; i < s->n_cameras; i++) {
        struct camera *camera = &s->cameras[i];
        uint8_t *copy = camera->copies[0];
        out->pictures[i] = camera->waiting[0];
        drop_oldest(camera);
        camera->copies[WAITING_MAX - 1] = camera->copies[WAITING_MAX];
        camera->copies[WAITING_MAX] = copy;
    }
    const struct iso_picture *first = &out->pictures[0];
    const int64_t age_ns = s->monotonic_ns(s->context) - first->stamp_ns;
    const int64_t t_ns = iso_clock_now_ns(&s->clock) - (age_ns > 0 ? age_ns : 0);
    out->t_ns = t_ns > s->last_ns ? t_ns : s->last_ns + 1;
    s->last_ns = out->t_ns;
    /* The first picture since the start continues the sequence, whatever number it has. */
    out->sequence = s->has_last ? s->last_sequence + 1 : 0;
    if (s->has_number && !s->excused) {
        out->sequence = s->last_sequence + (uint32_t)(first->sequence - s->last_number);
    }
    const bool wanted = s->interval_ns == 0 || out->t_ns - s->handed_ns >= s->interval_ns;
    s->last_number = first->sequence;
    s->last_sequence = wanted ? out->sequence : out->sequence - 1;
    s->handed_ns = wanted ? out->t_ns : s->handed_ns;
    s->has_number = s->has_last = true;
    s->excused = s->excused && s->absent;
    return wanted;
}

/* Assembles a set from the waiting pictures. Returns -EAGAIN if more pictures are needed. */
static int assemble_set(struct iso_picture_stream *s, struct iso_picture_set *out,
                        struct iso_fault *fault)
{
    for (int i = 0; i < s->n_cameras; i++) {
        const int error = fetch_pictures(s, &s->cameras[i], fault);
        if (error) {
            return error;
        }
    }
    for (;;) {
        switch (judge_pair(s)) {
        case ISO_PAIR_WAIT:
            return -EAGAIN;
        case ISO_PAIR_TAKE:
            if (hand_out(s, out)) {
                return 0;
            }
            continue;
        case ISO_PAIR_DROP_FIRST:
            drop_oldest(&s->cameras[0]);
            break;
        case ISO_PAIR_DROP_SECOND:
            drop_oldest(&s->cameras[1]);
            break;
        }
        count_dropped(s);
    }
}

/* Notes whether the caller stayed away, so that the kernel may have had no buffer for a picture.
 * What is missing then shows with the first picture that is taken in time again. */
static void note_caller(struct iso_picture_stream *s)
{
    const int64_t now_ns = iso_clock_now_ns(&s->clock);
    s->absent = s->interval_ns > 0 && now_ns - s->came_ns > s->interval_ns / 2;
    s->excused = s->excused || s->absent;
    s->came_ns = now_ns;
}

int iso_picture_stream_wait(struct iso_picture_stream *stream, int64_t deadline_ns,
                            struct iso_picture_set *out, struct iso_fault *fault)
{
    note_caller(stream);
    for (;;) {
        const int error = assemble_set(stream, out, fault);
        if (error != -EAGAIN) {
            return error;
        }
        const int64_t left_ns = deadline_ns - iso_clock_now_ns(&stream->clock);
        const int64_t left_ms = left_ns > 0 ? (left_ns + 999999) / 1000000 : 0;
        struct pollfd ready = {.fd = stream->epoll_fd, .events = POLLIN};
        const int n = poll(&ready, 1, left_ms < INT_MAX ? (int)left_ms : INT_MAX);
        if (n == 0 || (n < 0 && errno == EINTR)) {
            return -ETIMEDOUT;
        }
        if (n < 0) {
            return iso_fault_set_code(fault, ISO_FAULT_SENSOR_FAILED, -EIO,
                                      "video devices cannot be polled: %m");
        }
    }
}

void iso_picture_stream_set_interval(struct iso_picture_stream *stream, int64_t interval_ns)
{
    stream->interval_ns = interval_ns;
}

int iso_picture_stream_fd(const struct iso_picture_stream *stream)
{
    return stream->epoll_fd;
}

uint64_t iso_picture_stream_dropped(const struct iso_picture_stream *stream)
{
    return stream->dropped;
}
