/* vm_usb_eyes BENCH: two grey USB cameras next to each other, which show the scene of a bench
 * (tests/openni2/virtual_camera.h) as eye_pair.h describes it. The program writes their calibration
 * to BENCH/rig.ini, prints their video nodes, the left one first, and keeps the cameras plugged in
 * until SIGTERM. */
#include <errno.h>
#include <limits.h>
#include <linux/videodev2.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include "drivers/base/path.h"
#include "tests/openni2/virtual_camera.h"
#include "tests/vm/usb/eye_pair.h"
#include "tests/vm/usb/usb_camera.h"

struct eyes {
    struct usb_camera *cameras[ISO_EYES];
    struct sim_virtual_camera *view;
    struct eye_pair *pair;
    uint8_t *pictures[ISO_EYES];
    atomic_int started;
};

static void on_frame(void *context, const struct iso_frame *frame, int index, uint64_t t_us)
{
    struct eyes *eyes = context;
    (void)t_us;
    eye_pair_look(eyes->pair, frame, (uint64_t)index, eyes->pictures[ISO_EYE_LEFT],
                  eyes->pictures[ISO_EYE_RIGHT]);
    for (int eye = 0; eye < ISO_EYES; eye++) {
        usb_camera_shoot(eyes->cameras[eye], 0, eyes->pictures[eye], false);
    }
}

static void on_fault(void *context, const char *text)
{
    (void)context;
    fprintf(stderr, "USB eyes: %s\n", text);
}

/* Plugs the cameras in one after the other, so that the left camera has the first node. */
static void on_plug(void *context, bool in)
{
    struct eyes *eyes = context;
    struct iso_fault fault = {.text = ""};
    for (int eye = 0; eye < ISO_EYES; eye++) {
        if (usb_camera_plug(eyes->cameras[eye], in, &fault)) {
            on_fault(context, fault.text);
        } else if (in) {
            (void)usb_camera_node(eyes->cameras[eye], 0);
        }
    }
}

/* The program makes frames while both cameras are started. */
static void on_start(void *context, int n)
{
    struct eyes *eyes = context;
    const int started = atomic_fetch_add(&eyes->started, n > 0 ? 1 : -1) + (n > 0 ? 1 : -1);
    sim_virtual_camera_stream(eyes->view, started == ISO_EYES);
}

static int make_cameras(struct eyes *eyes, struct iso_fault *fault)
{
    const struct iso_camera *camera = &sim_virtual_camera_meta(eyes->view)->camera;
    const size_t n = (size_t)camera->width_px * (size_t)camera->height_px;
    int error = eye_pair_new(camera, &eyes->pair);
    for (unsigned eye = 0; !error && eye < ISO_EYES; eye++) {
        const struct usb_camera_options options = {
            .serial = eye == ISO_EYE_LEFT ? "LEFT" : "RIGHT",
            .port = eye,
            .n_streams = 1,
            .streams = {{V4L2_PIX_FMT_GREY, camera->width_px, camera->height_px}},
            .started = on_start,
            .context = eyes,
        };
        eyes->pictures[eye] = calloc(1, n);
        error = eyes->pictures[eye] ? usb_camera_new(&options, &eyes->cameras[eye], fault)
                                    : -ENOMEM;
    }
    return error == -ENOMEM ? iso_fault_set(fault, error, "USB eyes: out of memory") : error;
}

static int set_up(const char *bench, struct eyes *eyes, struct iso_fault *fault)
{
    const struct sim_virtual_camera_events events = {on_plug, on_frame, on_fault, eyes};
    char rig[PATH_MAX];
    int error = iso_path_join(bench, "rig.ini", rig, fault);
    if (!error) {
        error = sim_virtual_camera_new(bench, &events, &eyes->view, fault);
    }
    if (!error) {
        error = make_cameras(eyes, fault);
    }
    if (!error) {
        const struct iso_stereo_calibration calibration = eye_pair_calibration(eyes->pair);
        error = iso_stereo_calibration_write(rig, &calibration, fault);
    }
    if (!error && sim_virtual_camera_run(eyes->view)) {
        error = iso_fault_set(fault, -EAGAIN, "USB eyes: no thread");
    }
    return error;
}

/* The threads of the cables read the view, so they end first. */
static void clear_away(struct eyes *eyes)
{
    for (int eye = 0; eye < ISO_EYES; eye++) {
        if (eyes->cameras[eye]) {
            (void)usb_camera_plug(eyes->cameras[eye], false, NULL);
        }
    }
    sim_virtual_camera_free(eyes->view);
    for (int eye = 0; eye < ISO_EYES; eye++) {
        usb_camera_free(eyes->cameras[eye]);
        free(eyes->pictures[eye]);
    }
    eye_pair_free(eyes->pair);
}

int main(int argc, char **argv)
{
    struct eyes eyes = {.started = 0};
    struct iso_fault fault = {.text = ""};
    sigset_t signals;
    int number = 0;
    if (argc != 2) {
        fprintf(stderr, "usage: %s BENCH\n", argv[0]);
        return 2;
    }
    (void)sigemptyset(&signals);
    (void)sigaddset(&signals, SIGTERM);
    (void)sigprocmask(SIG_BLOCK, &signals, NULL);
    const int error = set_up(argv[1], &eyes, &fault);
    if (error) {
        fprintf(stderr, "%s\n", fault.text);
    } else {
        for (int eye = 0; eye < ISO_EYES; eye++) {
            puts(usb_camera_node(eyes.cameras[eye], 0));
        }
        (void)fflush(stdout);
        (void)sigwait(&signals, &number);
    }
    clear_away(&eyes);
    return error ? 4 : 0;
}
