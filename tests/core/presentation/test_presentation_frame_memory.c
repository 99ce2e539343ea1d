/* Fingerprints of frames and the memory of fingerprints: rings of buffers, pixels that flicker,
 * shifted depths, noise, time, bounds. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/presentation/frame_memory.h"
#include "sim/base/random.h"

enum { WIDTH = 640, HEIGHT = 480, RING_MAX = 60 };

static const int64_t period_ns = 33333333, minute_ns = INT64_C(60000000000);
static const struct iso_vec3 nose_mm = {15.0, -8.0, 700.0};

static const struct iso_camera camera = {.projection = ISO_PINHOLE,
                                         .width_px = WIDTH,
                                         .height_px = HEIGHT,
                                         .fx_px = 575.8,
                                         .fy_px = 575.8,
                                         .cx_px = 319.5,
                                         .cy_px = 239.5};

static struct iso_frame *frame_new(void)
{
    struct iso_frame *frame = NULL;
    assert_int_equal(iso_frame_new(&camera, WIDTH, HEIGHT, false, &frame), 0);
    return frame;
}

/* A head as an ellipsoid before a wall, in whole millimetres. The noise has a standard deviation of
 * 1 mm and depends on the seed. */
static void draw(struct iso_frame *frame, uint64_t seed, double aside_mm)
{
    struct sim_random random = sim_random_seeded(seed, 4, 0);
    for (int row = 0; row < HEIGHT; row++) {
        for (int column = 0; column < WIDTH; column++) {
            const double x = (column - camera.cx_px) / camera.fx_px * nose_mm.z - nose_mm.x -
                             aside_mm;
            const double y = (row - camera.cy_px) / camera.fy_px * nose_mm.z - nose_mm.y;
            const double inside = 1.0 - x * x / 6400.0 - y * y / 14400.0;
            const double z = inside > 0.0 ? nose_mm.z + 100.0 * (1.0 - sqrt(inside)) : 2000.0;
            frame->depth_mm[row * WIDTH + column] = (float)round(z + sim_random_normal(&random));
        }
    }
}

static struct iso_fingerprint print_of(const struct iso_frame *frame)
{
    return iso_fingerprint_of(frame, nose_mm);
}

static struct iso_frame_memory *memory_new(int capacity)
{
    struct iso_frame_memory_options options = iso_frame_memory_options_default();
    options.capacity = capacity > 0 ? capacity : options.capacity;
    struct iso_frame_memory *memory = NULL;
    assert_int_equal(iso_frame_memory_new(&options, &memory), 0);
    return memory;
}

/* Returns how many frames are not recognised, from the second to the last round of a ring of stored
 * buffers. `spoil` changes every frame. */
static int opened_by_ring(int ring, double step_mm, void (*spoil)(struct iso_frame *, int))
{
    struct iso_frame_memory *memory = memory_new(0);
    struct iso_frame *frame = frame_new();
    int opened = 0;
    for (int i = 0; i < 3 * ring; i++) {
        draw(frame, 100 + (uint64_t)(i % ring), step_mm * (i % ring));
        if (spoil) {
            spoil(frame, i);
        }
        const struct iso_fingerprint print = print_of(frame);
        const bool repeats = iso_frame_memory_repeats(memory, &print, i * period_ns);
        assert_true(i >= ring || !repeats); /* all frames of the first round are new */
        opened += i >= ring && !repeats;
    }
    iso_frame_free(frame);
    iso_frame_memory_free(memory);
    return opened;
}

static void rings_of_buffers_are_known_in_their_second_round(void **state)
{
    (void)state;
    assert_int_equal(opened_by_ring(1, 0.0, NULL), 0);
    assert_int_equal(opened_by_ring(2, 0.0, NULL), 0);
    assert_int_equal(opened_by_ring(7, 0.0, NULL), 0);
    assert_int_equal(opened_by_ring(RING_MAX, 0.0, NULL), 0);
}

static void rings_of_poses_are_known(void **state)
{
    (void)state;
    assert_int_equal(opened_by_ring(2, 60.0, NULL), 0); /* a jump: another track each time */
    assert_int_equal(opened_by_ring(RING_MAX, 0.5, NULL), 0);
}

/* Three pixels in the middle of the face. */
static void flicker(struct iso_frame *frame, int i)
{
    frame->depth_mm[230 * WIDTH + 310] = (float)(700 + i % 11);
    frame->depth_mm[240 * WIDTH + 330] = (float)(i % 2 * 710);
    frame->depth_mm[250 * WIDTH + 350] = (float)(705 + i % 5);
}

/* Changes one pixel of a hundred, others in every frame. */
static void sprinkle(struct iso_frame *frame, int i)
{
    struct sim_random random = sim_random_seeded((uint64_t)i, 8, 0);
    for (int k = 0; k < WIDTH * HEIGHT / 100; k++) {
        const int at = (int)sim_random_below(&random, WIDTH * HEIGHT);
        frame->depth_mm[at] += (float)sim_random_between(&random, 1.0, 9.0);
    }
}

/* Adds the same distance to all depths, another distance in every frame. */
static void shift(struct iso_frame *frame, int i)
{
    for (int k = 0; k < WIDTH * HEIGHT; k++) {
        frame->depth_mm[k] += (float)(i % 23) * 0.9F;
    }
}

static void pixels_that_flicker_do_not_make_a_frame_new(void **state)
{
    (void)state;
    assert_int_equal(opened_by_ring(1, 0.0, flicker), 0);
    assert_int_equal(opened_by_ring(7, 0.0, flicker), 0);
    assert_int_equal(opened_by_ring(7, 0.0, sprinkle), 0);
}

static void a_constant_offset_does_not_make_a_frame_new(void **state)
{
    (void)state;
    assert_int_equal(opened_by_ring(1, 0.0, shift), 0);
    assert_int_equal(opened_by_ring(7, 0.0, shift), 0);
}

static void noise_makes_every_frame_of_a_still_head_new(void **state)
{
    enum { FRAMES = 300 };
    struct iso_frame_memory *memory = memory_new(0);
    struct iso_frame *frame = frame_new();
    (void)state;
    for (int i = 0; i < FRAMES; i++) {
        draw(frame, 1000 + (uint64_t)i, 0.0);
        const struct iso_fingerprint print = print_of(frame);
        assert_false(iso_frame_memory_repeats(memory, &print, i * period_ns));
    }
    iso_frame_free(frame);
    iso_frame_memory_free(memory);
}

static void a_frame_is_forgotten_after_ten_minutes_and_no_earlier(void **state)
{
    struct iso_frame_memory *memory = memory_new(0);
    struct iso_frame *frame = frame_new();
    const int64_t begin_ns = 5;
    (void)state;
    draw(frame, 1, 0.0);
    const struct iso_fingerprint print = print_of(frame);
    assert_false(iso_frame_memory_repeats(memory, &print, begin_ns));
    assert_true(iso_frame_memory_repeats(memory, &print, begin_ns + 10 * minute_ns - 1));
    /* Each repetition is remembered, too: a frame that is shown again and again is never new. */
    assert_true(iso_frame_memory_repeats(memory, &print, begin_ns + 15 * minute_ns));
    assert_false(iso_frame_memory_repeats(memory, &print, begin_ns + 25 * minute_ns));
    /* A clock that goes back does not hide a repetition. */
    assert_true(iso_frame_memory_repeats(memory, &print, begin_ns));
    iso_frame_free(frame);
    iso_frame_memory_free(memory);
}

static struct iso_fingerprint made_up(uint32_t number)
{
    struct iso_fingerprint print = {{0}, ISO_FINGERPRINT_CLASSES};
    struct sim_random random = sim_random_seeded(number, 6, 0);
    for (int i = 0; i < ISO_FINGERPRINT_CLASSES; i++) {
        print.of[i] = (uint8_t)(1 + sim_random_below(&random, 255));
    }
    return print;
}

/* The memory keeps ten minutes at 30 frames a second. It remembers all frames, without one false
 * alarm. */
static void it_holds_ten_minutes_and_forgets_the_oldest_beyond(void **state)
{
    const int capacity = iso_frame_memory_options_default().capacity;
    struct iso_frame_memory *memory = memory_new(0);
    const struct iso_fingerprint first = made_up(0), second = made_up(1);
    (void)state;
    assert_int_equal(capacity, 10 * 60 * 30);
    for (int i = 0; i < capacity; i++) {
        const struct iso_fingerprint print = made_up((uint32_t)i);
        assert_false(iso_frame_memory_repeats(memory, &print, i * period_ns));
    }
    /* The repetition of the first frame takes its place. A new frame takes the second frame's
     * place. */
    assert_true(iso_frame_memory_repeats(memory, &first, capacity * period_ns - 1));
    const struct iso_fingerprint last = made_up((uint32_t)capacity);
    assert_false(iso_frame_memory_repeats(memory, &last, capacity * period_ns - 1));
    assert_false(iso_frame_memory_repeats(memory, &second, capacity * period_ns - 1));
    iso_frame_memory_free(memory);
}

static void a_frame_without_content_is_neither_known_nor_remembered(void **state)
{
    struct iso_frame_memory *memory = memory_new(0);
    struct iso_frame *frame = frame_new();
    (void)state;
    struct iso_fingerprint print = print_of(frame); /* it has no measurement */
    assert_int_equal(print.filled, 0);
    for (int k = 0; k < WIDTH * HEIGHT; k++) {
        frame->depth_mm[k] = 710.0F; /* flat: all such frames look equal */
    }
    print = print_of(frame);
    assert_int_equal(print.filled, 0);
    assert_false(iso_frame_memory_repeats(memory, &print, 0));
    assert_false(iso_frame_memory_repeats(memory, &print, 1));
    print = iso_fingerprint_of(frame, iso_vec3(0.0, 0.0, -1.0)); /* behind the camera */
    assert_int_equal(print.filled, 0);
    iso_frame_free(frame);
    iso_frame_memory_free(memory);
}

/* A window of the frame has the fingerprint of the whole frame. */
static void a_crop_is_the_same_frame(void **state)
{
    enum { LEFT = 131, TOP = 57, SIZE = 360 };
    struct iso_frame *frame = frame_new();
    struct iso_frame *crop = NULL;
    (void)state;
    draw(frame, 2, 0.0);
    assert_int_equal(iso_frame_new(&camera, SIZE, SIZE, false, &crop), 0);
    crop->crop_x_px = LEFT;
    crop->crop_y_px = TOP;
    for (int row = 0; row < SIZE; row++) {
        memcpy(&crop->depth_mm[row * SIZE], &frame->depth_mm[(row + TOP) * WIDTH + LEFT],
               SIZE * sizeof *crop->depth_mm);
    }
    const struct iso_fingerprint a = print_of(frame), b = print_of(crop);
    assert_memory_equal(a.of, b.of, sizeof a.of);
    assert_true(a.filled > ISO_FINGERPRINT_CLASSES / 2);
    assert_true(iso_fingerprint_likeness(&a, &b) > 0.99);
    iso_frame_free(crop);
    iso_frame_free(frame);
}

static void options_outside_their_ranges_are_refused(void **state)
{
    struct iso_frame_memory *memory = NULL;
    struct iso_frame_memory_options options = iso_frame_memory_options_default();
    (void)state;
    options.capacity = 0;
    assert_int_equal(iso_frame_memory_new(&options, &memory), -EINVAL);
    options = iso_frame_memory_options_default();
    options.span_ns = 0;
    assert_int_equal(iso_frame_memory_new(&options, &memory), -EINVAL);
    assert_null(memory);
    iso_frame_memory_free(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rings_of_buffers_are_known_in_their_second_round),
        cmocka_unit_test(rings_of_poses_are_known),
        cmocka_unit_test(pixels_that_flicker_do_not_make_a_frame_new),
        cmocka_unit_test(a_constant_offset_does_not_make_a_frame_new),
        cmocka_unit_test(noise_makes_every_frame_of_a_still_head_new),
        cmocka_unit_test(a_frame_is_forgotten_after_ten_minutes_and_no_earlier),
        cmocka_unit_test(it_holds_ten_minutes_and_forgets_the_oldest_beyond),
        cmocka_unit_test(a_frame_without_content_is_neither_known_nor_remembered),
        cmocka_unit_test(a_crop_is_the_same_frame),
        cmocka_unit_test(options_outside_their_ranges_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
