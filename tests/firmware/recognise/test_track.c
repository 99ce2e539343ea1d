/* One face over several frames: the same one or another one, still or moving. */
#include <math.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/base/times.h"
#include "firmware/recognise/track.h"

static struct iso_track track;

#define MS ISO_NS_PER_MS

static int setup(void **state)
{
    const struct iso_track_options options = {
        .lost_ns = 1500 * MS,
        .jump_mm_s = 2000,
        .jump_rad_s = 800 * ISO_RAD_PER_DEG,
        .still_mm_s = 300,
        .still_rad_s = 90 * ISO_RAD_PER_DEG,
    };
    (void)state;
    iso_track_init(&track, &options);
    return 0;
}

/* Shows a face at this place in mm, turned by these angles about the vertical and about its line of
 * sight. Returns its motion. */
static struct iso_track_motion pose(int64_t t_ms, double x, double y, double z, double yaw_deg,
                                    double roll_deg)
{
    const double cy = cos(yaw_deg * ISO_RAD_PER_DEG), sy = sin(yaw_deg * ISO_RAD_PER_DEG);
    const double cr = cos(roll_deg * ISO_RAD_PER_DEG), sr = sin(roll_deg * ISO_RAD_PER_DEG);
    const struct iso_mat3 yaw = {{{cy, 0, sy}, {0, 1, 0}, {-sy, 0, cy}}};
    const struct iso_mat3 roll = {{{cr, -sr, 0}, {sr, cr, 0}, {0, 0, 1}}};
    const struct iso_rigid at = {iso_mat3_mul(&yaw, &roll), {x, y, z}};
    return iso_track_pose(&track, t_ms * MS, &at);
}

static void the_first_pose_has_no_speed(void **state)
{
    const struct iso_track_motion motion = pose(100, 10, 20, 700, 5, 0);
    (void)state;
    assert_int_equal(motion.track, 1);
    assert_false(motion.known);
    assert_false(motion.moving);
    assert_true(motion.mm_s == 0 && motion.rad_s == 0);
}

static void measures_speed(void **state)
{
    (void)state;
    (void)pose(100, 10, 20, 700, 5, 0);
    const struct iso_track_motion motion = pose(140, 13, 16, 712, 5, 0);
    assert_int_equal(motion.track, 1);
    assert_true(motion.known);
    assert_true(fabs(motion.mm_s - 13 / 0.04) < 1e-9); /* (3, 4, 12) is 13 mm long */
    assert_true(fabs(motion.rad_s - 0) < 1e-6);
    assert_true(motion.moving);
}

static void measures_turning(void **state)
{
    (void)state;
    (void)pose(100, 0, 0, 700, -2, 0);
    struct iso_track_motion motion = pose(150, 0, 0, 700, 2, 0);
    assert_true(fabs(motion.rad_s / ISO_RAD_PER_DEG - 80) < 1e-6);
    assert_false(motion.moving);
    motion = pose(200, 0, 0, 700, 2, 5);
    assert_true(fabs(motion.rad_s / ISO_RAD_PER_DEG - 100) < 1e-6);
    assert_true(motion.moving);
    assert_int_equal(motion.track, 1);
}

static void an_impossible_motion_is_another_face(void **state)
{
    /* The face was at (0, 0, 700) at 100 ms. Its reach in 30 ms is 20 + 60 = 80 mm and 15 + 24 = 39
     * degrees. */
    static const struct {
        int64_t t_ms;
        double x, z, yaw_deg;
        bool same;
    } cases[] = {
        {130, 79, 700, 0, true},    {130, 81, 700, 0, false},   {130, 0, 779, 0, true},
        {130, 0, 619, 0, false},    {130, 0, 700, 38, true},    {130, 0, 700, -40, false},
        {133, 65, 700, 30, true},   {300, 149, 700, 0, true},   {300, 151, 700, 0, false},
        {1599, 149, 700, 90, true}, {1599, 151, 700, 0, false}, {1600, 0, 700, 0, false},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        assert_int_equal(setup(NULL), 0);
        (void)pose(100, 0, 0, 700, 0, 0);
        const struct iso_track_motion motion = pose(cases[i].t_ms, cases[i].x, 0, cases[i].z,
                                                    cases[i].yaw_deg, 0);
        if ((motion.track == 1) != cases[i].same || motion.known != cases[i].same) {
            fail_msg("case %zu: track %d", i, (int)motion.track);
        }
    }
}

/* A person who leans over and back gets a new track. */
static void a_track_that_was_left_does_not_come_back(void **state)
{
    (void)state;
    assert_int_equal(pose(100, 0, 0, 700, 0, 0).track, 1);
    assert_int_equal(pose(133, 300, 0, 700, 0, 0).track, 2);
    assert_int_equal(pose(166, 0, 0, 700, 0, 0).track, 3);
    assert_int_equal(pose(200, 1, 0, 700, 0, 0).track, 3);
}

static void follows_a_person_who_walks(void **state)
{
    (void)state;
    for (int i = 0; i < 30; i++) { /* 1.4 m/s towards the camera */
        const struct iso_track_motion motion = pose(100 + 33 * i, 0, 0, 2000 - 46.2 * i, 0, 0);
        assert_int_equal(motion.track, 1);
        assert_int_equal(motion.moving, i > 0);
    }
}

static void two_frames_of_one_time_have_no_speed(void **state)
{
    (void)state;
    (void)pose(100, 0, 0, 700, 0, 0);
    const struct iso_track_motion motion = pose(100, 5, 0, 700, 0, 0);
    assert_int_equal(motion.track, 1);
    assert_false(motion.known);
    assert_false(motion.moving);
    assert_int_equal(pose(100, 30, 0, 700, 0, 0).track, 2);
}

static void begins_anew_on_reset(void **state)
{
    (void)state;
    (void)pose(100, 0, 0, 700, 0, 0);
    iso_track_reset(&track);
    const struct iso_track_motion motion = pose(133, 0, 0, 700, 0, 0);
    assert_int_equal(motion.track, 2);
    assert_false(motion.known);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(the_first_pose_has_no_speed, setup),
        cmocka_unit_test_setup(measures_speed, setup),
        cmocka_unit_test_setup(measures_turning, setup),
        cmocka_unit_test_setup(an_impossible_motion_is_another_face, setup),
        cmocka_unit_test_setup(a_track_that_was_left_does_not_come_back, setup),
        cmocka_unit_test_setup(follows_a_person_who_walks, setup),
        cmocka_unit_test_setup(two_frames_of_one_time_have_no_speed, setup),
        cmocka_unit_test_setup(begins_anew_on_reset, setup),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
