/* Measures the cost of detecting that a frame repeats an earlier one: the fingerprint of a frame,
 * and the search in a full memory (10 minutes of 30 frames a second). Wall time. */
#include <stdio.h>
#include <stdlib.h>

#include "core/presentation/frame_memory.h"
#include "sim/base/random.h"
#include "sim/lab/match/latency.h"
#include "tests/bench/machine.h"

enum { WIDTH = 640, HEIGHT = 480, ROUNDS = 2000 };

static const struct iso_camera camera = {.projection = ISO_PINHOLE,
                                         .width_px = WIDTH,
                                         .height_px = HEIGHT,
                                         .fx_px = 575.8,
                                         .fy_px = 575.8,
                                         .cx_px = 319.5,
                                         .cy_px = 239.5};
static const struct iso_vec3 nose_mm = {0.0, 0.0, 700.0};

/* A slanted plane with noise: every tile has content. */
static void draw(struct iso_frame *frame)
{
    struct sim_random random = sim_random_seeded(1, 2, 3);
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        frame->depth_mm[i] = (float)(680 + i % WIDTH / 10) + (float)sim_random_below(&random, 5);
    }
}

static struct iso_fingerprint made_up(uint64_t number)
{
    struct iso_fingerprint print = {{0}, ISO_FINGERPRINT_CLASSES};
    struct sim_random random = sim_random_seeded(number, 6, 0);
    for (int i = 0; i < ISO_FINGERPRINT_CLASSES; i++) {
        print.of[i] = (uint8_t)(1 + sim_random_below(&random, 255));
    }
    return print;
}

static int by_value(const void *a, const void *b)
{
    const int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;
    return (x > y) - (x < y);
}

int main(void)
{
    static int64_t print_ns[ROUNDS], look_ns[ROUNDS];
    const struct iso_frame_memory_options options = iso_frame_memory_options_default();
    struct iso_frame_memory *memory = NULL;
    struct iso_frame *frame = NULL;
    int known = 0;
    if (iso_frame_memory_new(&options, &memory) ||
        iso_frame_new(&camera, WIDTH, HEIGHT, false, &frame)) {
        fputs("bench_repeats: out of memory\n", stderr);
        return EXIT_FAILURE;
    }
    draw(frame);
    for (int i = 0; i < options.capacity; i++) {
        const struct iso_fingerprint print = made_up((uint64_t)i);
        known += iso_frame_memory_repeats(memory, &print, i);
    }
    for (int i = 0; i < ROUNDS; i++) {
        const int64_t begin_ns = sim_wall_ns(NULL);
        struct iso_fingerprint print = iso_fingerprint_of(frame, nose_mm);
        const int64_t between_ns = sim_wall_ns(NULL);
        print = made_up((uint64_t)(options.capacity + i)); /* new: no hit ends the search early */
        const int64_t look_begin_ns = sim_wall_ns(NULL);
        known += iso_frame_memory_repeats(memory, &print, options.capacity + i);
        look_ns[i] = sim_wall_ns(NULL) - look_begin_ns;
        print_ns[i] = between_ns - begin_ns;
    }
    qsort(print_ns, ROUNDS, sizeof *print_ns, by_value);
    qsort(look_ns, ROUNDS, sizeof *look_ns, by_value);
    bench_print_machine();
    printf("repeated frames, %d x %d, %d remembered: fingerprint %.3f ms, look-up %.3f ms "
           "(medians), %.3f and %.3f ms (p99), %d false alarms\n",
           WIDTH, HEIGHT, options.capacity, (double)print_ns[ROUNDS / 2] * 1e-6,
           (double)look_ns[ROUNDS / 2] * 1e-6, (double)print_ns[ROUNDS * 99 / 100] * 1e-6,
           (double)look_ns[ROUNDS * 99 / 100] * 1e-6, known);
    iso_frame_free(frame);
    iso_frame_memory_free(memory);
    return EXIT_SUCCESS;
}
