#include "tests/openni2/virtual_camera.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <math.h>
#include <poll.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <time.h>
#include <unistd.h>

#include "drivers/base/path.h"
#include "drivers/file/text.h"
#include "drivers/process/thread.h"
#include "drivers/sensor/contract/sensor.h"
#include "drivers/sensor/replay/sensor_replay.h"
#include "sim/base/random.h"

enum {
    LOOK_MS = 10, /* time between two checks of the cable */
    NS_PER_MS = 1000000,
    PERIOD_NS = 1000000000 / SIM_VIRTUAL_CAMERA_HZ,
    INI_MAX_BYTES = 65536,
};

struct sim_virtual_camera {
    struct sim_virtual_camera_events events;
    struct iso_recording_meta meta;
    char unplugged[PATH_MAX], slot[PATH_MAX], noise[PATH_MAX];
    struct iso_sensor *scene; /* plays the slot, as fast as frames are requested */
    struct iso_frame *seen;   /* the frame for the events */
    int shutter_fd;           /* -1: 30 frames a second */
    int quit_fd;              /* readable: the thread must end */
    pthread_t thread;
    bool running;
    atomic_bool streaming;
    atomic_uint takes; /* counts the starts, including one right after a stop */

    /* Only the thread uses the following. */
    bool plugged, was_streaming;
    unsigned take;
    int index;
    int64_t due_ns;
};

static int64_t monotonic_ns(void *context)
{
    struct timespec now;
    (void)context;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * INT64_C(1000000000) + now.tv_nsec;
}

/* ---- set-up ---- */

static int read_meta(const char *bench, struct sim_virtual_camera *camera, struct iso_fault *fault)
{
    char path[PATH_MAX], *text = NULL;
    int error = iso_path_join(bench, "camera.ini", path, fault);
    if (!error) {
        error = iso_text_read(path, INI_MAX_BYTES, &text, fault);
    }
    if (!error) {
        error = iso_recording_meta_parse(path, text, &camera->meta, fault);
    }
    free(text);
    if (error) {
        return error;
    }
    const struct iso_camera *c = &camera->meta.camera;
    const bool bent = c->k1 != 0 || c->k2 != 0 || c->k3 != 0 || c->p1 != 0 || c->p2 != 0;
    const double unit_mm = camera->meta.unit_mm;
    if (c->projection != ISO_PINHOLE || bent || (unit_mm != 1.0 && unit_mm != 0.1)) {
        return iso_fault_set(fault, -EINVAL,
                             "%s: not a pinhole camera without distortion, of unit 1 or 0.1", path);
    }
    return 0;
}

static int open_scene(struct sim_virtual_camera *camera, struct iso_fault *fault)
{
    const struct iso_option options[] = {{"path", camera->slot}, {"pace", "asap"}, {"loop", "yes"}};
    const struct iso_clock clock = {monotonic_ns, NULL};
    return iso_sensor_open_ops(&iso_sensor_replay_ops, options, 3, &clock, &camera->scene, fault);
}

static int prepare(struct sim_virtual_camera *camera, const char *bench, struct iso_fault *fault)
{
    char shutter[PATH_MAX];
    int error = read_meta(bench, camera, fault);
    if (!error) {
        error = iso_path_join(bench, "unplugged", camera->unplugged, fault);
    }
    if (!error) {
        error = iso_path_join(bench, "slot", camera->slot, fault);
    }
    if (!error) {
        error = iso_path_join(bench, "noise", camera->noise, fault);
    }
    if (!error) {
        error = iso_path_join(bench, "shutter", shutter, fault);
    }
    if (!error) {
        error = open_scene(camera, fault);
    }
    if (error) {
        return error;
    }
    /* Opened for writing, too, so that reading does not end when the other program closes the FIFO.
     */
    camera->shutter_fd = open(shutter, O_RDWR | O_NONBLOCK | O_CLOEXEC);
    if (camera->shutter_fd < 0 && errno != ENOENT) {
        return iso_fault_set(fault, -errno, "%s: %m", shutter);
    }
    camera->quit_fd = eventfd(0, EFD_CLOEXEC);
    if (camera->quit_fd < 0) {
        return iso_fault_set(fault, -errno, "%s: %m", bench);
    }
    error = iso_frame_new(&camera->meta.camera, camera->meta.camera.width_px,
                          camera->meta.camera.height_px, true, &camera->seen);
    return error ? iso_fault_set(fault, error, "%s: out of memory", bench) : 0;
}

int sim_virtual_camera_new(const char *bench, const struct sim_virtual_camera_events *events,
                           struct sim_virtual_camera **out, struct iso_fault *fault)
{
    struct sim_virtual_camera *camera = calloc(1, sizeof *camera);
    if (!camera) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", bench);
    }
    camera->events = *events;
    camera->shutter_fd = camera->quit_fd = -1;
    int error = prepare(camera, bench, fault);
    if (error) {
        sim_virtual_camera_free(camera);
        return error;
    }
    *out = camera;
    return 0;
}

void sim_virtual_camera_free(struct sim_virtual_camera *camera)
{
    if (!camera) {
        return;
    }
    if (camera->running) {
        (void)eventfd_write(camera->quit_fd, 1);
        (void)pthread_join(camera->thread, NULL);
    }
    iso_sensor_close(camera->scene);
    iso_frame_free(camera->seen);
    if (camera->shutter_fd >= 0) {
        close(camera->shutter_fd);
    }
    if (camera->quit_fd >= 0) {
        close(camera->quit_fd);
    }
    free(camera);
}

const struct iso_recording_meta *sim_virtual_camera_meta(const struct sim_virtual_camera *camera)
{
    return &camera->meta;
}

void sim_virtual_camera_stream(struct sim_virtual_camera *camera, bool on)
{
    if (on && !atomic_load(&camera->streaming)) {
        (void)atomic_fetch_add(&camera->takes, 1);
    }
    atomic_store(&camera->streaming, on);
}

/* ---- the thread ---- */

static void look_at_cable(struct sim_virtual_camera *camera)
{
    const bool plugged = access(camera->unplugged, F_OK) != 0;
    if (plugged != camera->plugged) {
        camera->plugged = plugged;
        camera->events.plugged(camera->events.context, plugged);
    }
}

/* Starts the recording in the slot from its beginning when a client starts a stream. */
static void look_at_stream(struct sim_virtual_camera *camera)
{
    const bool streaming = atomic_load(&camera->streaming) && camera->plugged;
    const unsigned take = atomic_load(&camera->takes);
    struct iso_fault fault = {.text = ""};
    if (streaming == camera->was_streaming && take == camera->take) {
        return;
    }
    if (camera->was_streaming) {
        (void)iso_sensor_stop(camera->scene, NULL);
    }
    if (streaming && iso_sensor_start(camera->scene, &fault)) {
        camera->events.fault(camera->events.context, fault.text);
    }
    camera->was_streaming = streaming;
    camera->take = take;
    camera->due_ns = monotonic_ns(NULL);
}

static void add_noise(const struct sim_virtual_camera *camera, size_t pixels)
{
    struct sim_random random = sim_random_seeded((uint64_t)camera->index, 0, 0);
    for (size_t i = 0; i < pixels; i++) {
        float *depth_mm = &camera->seen->depth_mm[i];
        *depth_mm += *depth_mm > 1.0F ? (float)sim_random_below(&random, 3) - 1.0F : 0.0F;
    }
}

/* Copies a frame of the slot, or makes a frame without depths. False if the slot's recording does
 * not fit the camera or cannot be read. */
static bool see(struct sim_virtual_camera *camera)
{
    const struct iso_frame *scene = NULL;
    struct iso_frame *seen = camera->seen;
    const size_t pixels = (size_t)seen->width_px * (size_t)seen->height_px;
    struct iso_fault fault = {.text = ""};
    const int error = iso_sensor_wait(camera->scene, 0, &scene, &fault);
    if (error && error != -ETIMEDOUT) {
        camera->events.fault(camera->events.context, fault.text);
        return false;
    }
    if (!error && (scene->width_px != seen->width_px || scene->height_px != seen->height_px)) {
        camera->events.fault(camera->events.context, "slot: not of the size of camera.ini");
        return false;
    }
    memset(seen->depth_mm, 0, pixels * sizeof *seen->depth_mm);
    memset(seen->intensity, 0, pixels * sizeof *seen->intensity);
    if (!error) {
        memcpy(seen->depth_mm, scene->depth_mm, pixels * sizeof *seen->depth_mm);
    }
    if (access(camera->noise, F_OK) == 0) {
        add_noise(camera, pixels);
    }
    if (!error && scene->intensity) {
        memcpy(seen->intensity, scene->intensity, pixels * sizeof *seen->intensity);
    }
    return true;
}

static void expose(struct sim_virtual_camera *camera, bool lost)
{
    camera->index++;
    if (see(camera) && !lost) {
        /* With the shutter the camera's clock counts frames, so that nothing depends on real time.
         */
        const int64_t t_ns = camera->shutter_fd >= 0 ? camera->index * (int64_t)PERIOD_NS
                                                     : monotonic_ns(NULL);
        camera->events.frame(camera->events.context, camera->seen, camera->index,
                             (uint64_t)t_ns / 1000);
    }
}

static void expose_if_due(struct sim_virtual_camera *camera, bool shutter_is_readable)
{
    char key;
    if (!camera->was_streaming) {
        return;
    }
    if (camera->shutter_fd >= 0) {
        if (shutter_is_readable && read(camera->shutter_fd, &key, 1) == 1) {
            expose(camera, key == 's');
        }
        return;
    }
    const int64_t now_ns = monotonic_ns(NULL);
    if (now_ns >= camera->due_ns) {
        expose(camera, false);
        camera->due_ns += PERIOD_NS;
        camera->due_ns = camera->due_ns > now_ns ? camera->due_ns : now_ns + PERIOD_NS;
    }
}

/* The time for which the thread may sleep. */
static int patience_ms(const struct sim_virtual_camera *camera)
{
    if (camera->shutter_fd >= 0 || !camera->was_streaming) {
        return LOOK_MS;
    }
    const int64_t left_ns = camera->due_ns - monotonic_ns(NULL);
    const int64_t left_ms = left_ns <= 0 ? 0 : (left_ns + NS_PER_MS - 1) / NS_PER_MS;
    return left_ms < LOOK_MS ? (int)left_ms : LOOK_MS;
}

static void *live(void *context)
{
    struct sim_virtual_camera *camera = context;
    iso_thread_set_name("virtual");
    for (;;) {
        struct pollfd fds[] = {
            {.fd = camera->quit_fd, .events = POLLIN},
            {.fd = camera->was_streaming ? camera->shutter_fd : -1, .events = POLLIN}};
        (void)poll(fds, 2, patience_ms(camera));
        if (fds[0].revents) {
            return NULL;
        }
        look_at_cable(camera);
        look_at_stream(camera);
        expose_if_due(camera, fds[1].revents & POLLIN);
    }
}

int sim_virtual_camera_run(struct sim_virtual_camera *camera)
{
    look_at_cable(camera); /* so that a client finds the camera at once */
    const int error = iso_thread_start(&camera->thread, live, camera);
    camera->running = error == 0;
    return error;
}
