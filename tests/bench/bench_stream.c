/* Measures what a frame of 640x480 costs with four clients that watch: the outline of the head, the
 * silhouette, the record and four sends; and the same for the relief. Processor time, median. */
#include <stdio.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <unistd.h>

#include "drivers/model/model_file.h"
#include "firmware/stream/head_outline.h"
#include "firmware/stream/silhouette.h"
#include "firmware/stream/stream_list.h"
#include "sim/lab/match/latency.h"
#include "tests/bench/machine.h"

enum { WIDTH = 640, HEIGHT = 480, ROUNDS = 2000, WATCHERS = 4 };

static const struct iso_camera camera = {.projection = ISO_PINHOLE,
                                         .width_px = WIDTH,
                                         .height_px = HEIGHT,
                                         .fx_px = 575.8,
                                         .fy_px = 575.8,
                                         .cx_px = 319.5,
                                         .cy_px = 239.5};

struct bench {
    struct iso_head_model *model;
    struct iso_frame *frame;
    struct iso_head_outline head;
    struct iso_stream_list list;
    int fds[WATCHERS];
    struct iso_relief_record relief;
    uint8_t bytes[ISO_STREAM_BYTES_MAX];
};

static void outline_frame(struct bench *bench)
{
    const struct iso_rigid pose = {.rotation = {{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}}},
                                   .translation_mm = {0, 0, 600}};
    struct iso_outline_record record = {.mode = "watch"};
    record.n_points = iso_head_outline_project(&bench->head, &pose, bench->frame, record.outline);
    iso_silhouette_draw(bench->frame, record.outline, record.n_points, record.silhouette);
    iso_stream_list_send(&bench->list, ISO_STREAM_OUTLINE, bench->bytes,
                         iso_outline_record_write(&record, bench->bytes));
}

/* Without a face the silhouette is taken from the frame. */
static void empty_frame(struct bench *bench)
{
    struct iso_outline_record record = {.mode = "watch"};
    iso_silhouette_draw(bench->frame, record.outline, 0, record.silhouette);
    iso_stream_list_send(&bench->list, ISO_STREAM_OUTLINE, bench->bytes,
                         iso_outline_record_write(&record, bench->bytes));
}

static void relief_frame(struct bench *bench)
{
    iso_relief_sample(bench->frame, &bench->relief);
    iso_stream_list_send(&bench->list, ISO_STREAM_RELIEF, bench->bytes,
                         iso_relief_record_write(&bench->relief, bench->bytes));
}

static bool watch(struct bench *bench, enum iso_stream_kind kind)
{
    for (int i = 0; i < WATCHERS; i++) {
        bench->fds[i] = iso_stream_list_add(&bench->list, kind, 0, NULL);
        if (bench->fds[i] < 0) {
            return false;
        }
    }
    return true;
}

static void measure(struct bench *bench, const char *what, enum iso_stream_kind kind,
                    void (*frame)(struct bench *))
{
    static int64_t times_ns[ROUNDS];
    static uint8_t sink[ISO_STREAM_BYTES_MAX];
    const bool watched = watch(bench, kind);
    for (int i = 0; watched && i < ROUNDS; i++) {
        const int64_t start_ns = sim_thread_cpu_ns(NULL);
        frame(bench);
        times_ns[i] = sim_thread_cpu_ns(NULL) - start_ns;
        for (int k = 0; k < WATCHERS; k++) {
            (void)recv(bench->fds[k], sink, sizeof sink, 0);
        }
    }
    const struct sim_latency summary = sim_latency_of(times_ns, ROUNDS);
    printf("%-34s %.3f ms (95 %%: %.3f)\n", what, summary.median_ms, summary.p95_ms);
    iso_stream_list_end(&bench->list, kind);
    for (int k = 0; watched && k < WATCHERS; k++) {
        (void)close(bench->fds[k]);
    }
}

/* usage: bench_stream HEAD_MODEL */
int main(int argc, char **argv)
{
    struct bench *bench = calloc(1, sizeof *bench);
    if (argc != 2 || !bench || iso_head_model_load(argv[1], &bench->model, NULL) ||
        iso_frame_new(&camera, WIDTH, HEIGHT, false, &bench->frame)) {
        fputs("bench_stream: no head model, or out of memory\n", stderr);
        free(bench);
        return 1;
    }
    bench_print_machine();
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        bench->frame->depth_mm[i] = i % WIDTH < WIDTH / 2 ? 700.0F : 2500.0F;
    }
    iso_head_outline_init(&bench->head, bench->model);
    printf("A frame with %d clients that watch, processor time, median of %d:\n", WATCHERS, ROUNDS);
    measure(bench, "outline of a face", ISO_STREAM_OUTLINE, outline_frame);
    measure(bench, "outline without a face", ISO_STREAM_OUTLINE, empty_frame);
    measure(bench, "relief", ISO_STREAM_RELIEF, relief_frame);
    iso_frame_free(bench->frame);
    iso_head_model_free(bench->model);
    free(bench);
    return 0;
}
