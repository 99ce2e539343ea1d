#include "tests/vm/usb/usb_bench.h"

#include <errno.h>
#include <linux/videodev2.h>
#include <math.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include "tests/openni2/virtual_camera.h"
#include "tests/vm/usb/usb_camera.h"

struct usb_bench {
    struct usb_camera *camera;
    struct sim_virtual_camera *view;
    uint16_t *counts; /* the samples of one picture */
    size_t pixels;
    double unit_mm;
    int n_streams, index; /* index: of the last frame */
    atomic_int started;   /* streams */
    atomic_uint starts;
};

static void send(struct usb_bench *bench, int stream, const float *plane, double unit, bool spoilt)
{
    for (size_t i = 0; i < bench->pixels; i++) {
        bench->counts[i] = (uint16_t)lround((double)plane[i] / unit);
    }
    usb_camera_shoot(bench->camera, stream, bench->counts, spoilt);
}

/* Sends the pictures of a frame. If frames before this one were lost, it first sends pictures that
 * are cut short. */
static void on_frame(void *context, const struct iso_frame *frame, int index, uint64_t t_us)
{
    struct usb_bench *bench = context;
    const bool lost = index != bench->index + 1;
    (void)t_us;
    for (int spoilt = lost; spoilt >= 0; spoilt--) {
        send(bench, 0, frame->depth_mm, bench->unit_mm, spoilt);
        if (bench->n_streams > 1) {
            send(bench, 1, frame->intensity, 1.0 / 65535.0, spoilt);
        }
    }
    bench->index = index;
}

static void on_fault(void *context, const char *text)
{
    (void)context;
    fprintf(stderr, "USB bench: %s\n", text);
}

static void on_plug(void *context, bool in)
{
    struct usb_bench *bench = context;
    struct iso_fault fault = {.text = ""};
    if (usb_camera_plug(bench->camera, in, &fault)) {
        on_fault(bench, fault.text);
    }
}

static void on_start(void *context, int n)
{
    struct usb_bench *bench = context;
    if (atomic_exchange(&bench->started, n) == 0 && n > 0) {
        (void)atomic_fetch_add(&bench->starts, 1);
    }
    sim_virtual_camera_stream(bench->view, n > 0);
}

static int make_camera(struct usb_bench *bench, struct iso_fault *fault)
{
    const struct iso_recording_meta *meta = sim_virtual_camera_meta(bench->view);
    const int width = meta->camera.width_px, height = meta->camera.height_px;
    const struct usb_camera_options options = {
        .serial = "BENCH1",
        .port = 0,
        .n_streams = bench->n_streams,
        .streams = {{V4L2_PIX_FMT_Z16, width, height}, {V4L2_PIX_FMT_Y16, width, height}},
        .started = on_start,
        .context = bench,
    };
    bench->unit_mm = meta->unit_mm;
    bench->pixels = (size_t)width * (size_t)height;
    bench->counts = calloc(bench->pixels, sizeof *bench->counts);
    if (!bench->counts) {
        return iso_fault_set(fault, -ENOMEM, "USB bench: out of memory");
    }
    return usb_camera_new(&options, &bench->camera, fault);
}

int usb_bench_new(const char *directory, bool with_intensity, struct usb_bench **out,
                  struct iso_fault *fault)
{
    struct usb_bench *bench = calloc(1, sizeof *bench);
    const struct sim_virtual_camera_events events = {on_plug, on_frame, on_fault, bench};
    if (!bench) {
        return iso_fault_set(fault, -ENOMEM, "USB bench: out of memory");
    }
    bench->n_streams = with_intensity ? 2 : 1;
    int error = sim_virtual_camera_new(directory, &events, &bench->view, fault);
    if (!error) {
        error = make_camera(bench, fault);
    }
    if (!error && sim_virtual_camera_run(bench->view)) {
        error = iso_fault_set(fault, -EAGAIN, "USB bench: no thread");
    }
    if (error) {
        usb_bench_free(bench);
        return error;
    }
    *out = bench;
    return 0;
}

void usb_bench_free(struct usb_bench *bench)
{
    if (bench) {
        /* The cable's thread uses the view, so it must end first. */
        if (bench->camera) {
            (void)usb_camera_plug(bench->camera, false, NULL);
        }
        sim_virtual_camera_free(bench->view);
        usb_camera_free(bench->camera);
        free(bench->counts);
        free(bench);
    }
}

const char *usb_bench_node(struct usb_bench *bench, int stream)
{
    return usb_camera_node(bench->camera, stream);
}

unsigned usb_bench_starts(const struct usb_bench *bench)
{
    return atomic_load(&bench->starts);
}

void usb_bench_halt(struct usb_bench *bench)
{
    usb_camera_halt(bench->camera);
}
