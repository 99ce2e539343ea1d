/* Motion within reach: stored rooms and people with the noise of their sensor. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "core/find/scene_motion.h"
#include "drivers/recording/recording.h"

static const double reach_mm = 1500.0;
static const int64_t quiet_ns = 5000000000, frame_ns = 33333333;
enum { STORED = 3 };

struct fixture {
    struct iso_frame *stored[STORED]; /* frames of a recording */
    struct iso_frame *frame;          /* the frame that is passed on */
    struct iso_scene_motion scene;
    int64_t t_ns;
};

static void load(struct fixture *f, const char *name)
{
    char path[256];
    struct iso_recording *recording = NULL;
    (void)snprintf(path, sizeof path, "%s/sim/stored/%s", ISOTHERM_SOURCE_DIR, name);
    assert_int_equal(iso_recording_open(path, &recording, NULL), 0);
    for (size_t i = 0; i < STORED; i++) {
        iso_frame_free(f->stored[i]);
        assert_int_equal(iso_recording_frame_new(recording, &f->stored[i]), 0);
        assert_int_equal(iso_recording_read(recording, i, f->stored[i], NULL), 0);
    }
    if (!f->frame) {
        assert_int_equal(iso_recording_frame_new(recording, &f->frame), 0);
        f->frame->camera = f->stored[0]->camera;
    }
    iso_recording_close(recording);
}

/* Feeds stored frame i % STORED, its content moved to the left by shift_px pixels. */
static bool feed(struct fixture *f, int i, int shift_px)
{
    const struct iso_frame *from = f->stored[i % STORED];
    for (int row = 0; row < from->height_px; row++) {
        for (int column = 0; column < from->width_px; column++) {
            const int at = column + shift_px < from->width_px ? column + shift_px : column;
            f->frame->depth_mm[(size_t)row * (size_t)from->width_px + (size_t)column] =
                iso_frame_depth_at(from, at, row);
        }
    }
    f->frame->t_ns = f->t_ns += frame_ns;
    return iso_scene_motion_feed(&f->scene, f->frame, reach_mm, quiet_ns);
}

static int set_up(void **state)
{
    *state = calloc(1, sizeof(struct fixture));
    return *state ? 0 : -1;
}

static int tear_down(void **state)
{
    struct fixture *f = *state;
    for (int i = 0; i < STORED; i++) {
        iso_frame_free(f->stored[i]);
    }
    iso_frame_free(f->frame);
    free(f);
    return 0;
}

static void a_room_with_its_noise_does_not_move(void **state)
{
    struct fixture *f = *state;
    static const char *const rooms[] = {"none-nobody1", "none-nobody2"};
    for (size_t room = 0; room < sizeof rooms / sizeof *rooms; room++) {
        load(f, rooms[room]);
        f->scene = (struct iso_scene_motion){0};
        for (int i = 0; i < 300; i++) { /* the noise changes every half second */
            assert_false(feed(f, i / 15, 0));
        }
    }
}

/* A person seen from behind, at half a metre. The sway is 6 mm a second, which is 7 pixels. */
static void somebody_who_sways_moves(void **state)
{
    struct fixture *f = *state;
    load(f, "none-back1");
    int first = -1;
    for (int i = 0; i < 90 && first < 0; i++) {
        first = feed(f, i, i * 7 / 30) ? i : -1;
    }
    assert_in_range(first, 1, 60);
}

static void a_scene_is_quiet_some_seconds_after_the_last_motion(void **state)
{
    struct fixture *f = *state;
    load(f, "none-back1");
    for (int i = 0; i < 60; i++) {
        (void)feed(f, i, i);
    }
    assert_true(feed(f, 0, 59));
    const int64_t still_ns = f->t_ns;
    while (f->t_ns - still_ns < quiet_ns - 500000000) {
        assert_true(feed(f, 0, 59));
    }
    while (f->t_ns - still_ns < quiet_ns + 1500000000) {
        (void)feed(f, 0, 59);
    }
    assert_false(feed(f, 0, 59));
}

static void objects_out_of_reach_do_not_count(void **state)
{
    struct fixture *f = *state;
    load(f, "none-back1");
    for (int s = 0; s < STORED; s++) {
        for (int i = 0; i < f->frame->width_px * f->frame->height_px; i++) {
            f->stored[s]->depth_mm[i] += f->stored[s]->depth_mm[i] > 0.0F ? 1200.0F : 0.0F;
        }
    }
    for (int i = 0; i < 90; i++) {
        assert_false(feed(f, i, i));
    }
}

/* A frame with a person after a second of the empty room. With no more of the room than its own
 * noise nothing stirs, once the first half second is over. */
static void the_first_frame_with_a_person_stirs(void **state)
{
    struct fixture *f = *state;
    static const char *const rooms[] = {"none-nobody1", "none-nobody2"};
    static const char *const visitors[] = {"p01-v1", "none-back1"};
    for (size_t i = 0; i < 4; i++) {
        load(f, rooms[i / 2]);
        f->scene = (struct iso_scene_motion){0};
        for (int k = 0; k < 40; k++) {
            (void)feed(f, k, 0);
            assert_true(iso_scene_motion_stirs(&f->scene) == (k <= 16));
        }
        load(f, visitors[i % 2]);
        (void)feed(f, 0, 0);
        assert_true(iso_scene_motion_stirs(&f->scene));
    }
}

static void frames_that_are_too_small_stir(void **state)
{
    struct iso_scene_motion scene = {.frames = 0};
    float depth_mm[8] = {900, 900, 900, 900, 900, 900, 900, 900};
    struct iso_frame frame = {.width_px = 8, .height_px = 1, .depth_mm = depth_mm};
    (void)state;
    for (int i = 0; i < 90; i++) {
        frame.t_ns += frame_ns;
        (void)iso_scene_motion_feed(&scene, &frame, reach_mm, quiet_ns);
        assert_true(iso_scene_motion_stirs(&scene));
    }
}

static void another_size_begins_anew(void **state)
{
    struct fixture *f = *state;
    load(f, "none-back1");
    for (int i = 0; i < 60; i++) {
        (void)feed(f, i, i);
    }
    assert_true(feed(f, 0, 59));
    f->frame->height_px /= 2;
    assert_false(iso_scene_motion_feed(&f->scene, f->frame, reach_mm, quiet_ns));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(a_room_with_its_noise_does_not_move, set_up, tear_down),
        cmocka_unit_test_setup_teardown(somebody_who_sways_moves, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_scene_is_quiet_some_seconds_after_the_last_motion, set_up,
                                        tear_down),
        cmocka_unit_test_setup_teardown(objects_out_of_reach_do_not_count, set_up, tear_down),
        cmocka_unit_test_setup_teardown(the_first_frame_with_a_person_stirs, set_up, tear_down),
        cmocka_unit_test(frames_that_are_too_small_stir),
        cmocka_unit_test_setup_teardown(another_size_begins_anew, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
