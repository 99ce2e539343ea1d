/* Solids of the simulated world against closed forms: lengths, radii, volumes, shares. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "sim/world/face/ict.h"
#include "sim/world/face/person.h"
#include "sim/world/prop/face_print.h"
#include "sim/world/prop/group.h"
#include "sim/world/prop/hand.h"
#include "sim/world/prop/screen.h"
#include "sim/world/prop/sheet.h"
#include "tests/support/scratch.h"

static const double pi = 3.14159265358979324;

static long allocations_left = -1; /* until one fails; negative: none does */

void *__real_calloc(size_t n, size_t size);
void *__wrap_calloc(size_t n, size_t size);
void *__real_malloc(size_t size);
void *__wrap_malloc(size_t size);
void *__real_realloc(void *block, size_t size);
void *__wrap_realloc(void *block, size_t size);

static bool denied(void)
{
    return allocations_left >= 0 && allocations_left-- == 0;
}

void *__wrap_calloc(size_t n, size_t size)
{
    return denied() ? NULL : __real_calloc(n, size);
}

void *__wrap_malloc(size_t size)
{
    return denied() ? NULL : __real_malloc(size);
}

void *__wrap_realloc(void *block, size_t size)
{
    return denied() ? NULL : __real_realloc(block, size);
}

/* By the divergence theorem; positive if triangles are counter-clockwise seen from outside. */
static double volume(const struct sim_solid *solid)
{
    double sum = 0.0;
    for (uint32_t t = 0; t < solid->n_triangles; t++) {
        const uint32_t *c = solid->triangles[t];
        sum += iso_dot(solid->vertices_mm[c[0]],
                       iso_cross(solid->vertices_mm[c[1]], solid->vertices_mm[c[2]]));
    }
    return sum / 6.0;
}

static double area(const struct sim_solid *solid)
{
    double sum = 0.0;
    for (uint32_t t = 0; t < solid->n_triangles; t++) {
        struct iso_vec3 a = solid->vertices_mm[solid->triangles[t][0]];
        struct iso_vec3 ab = iso_sub(solid->vertices_mm[solid->triangles[t][1]], a);
        sum += iso_norm(iso_cross(ab, iso_sub(solid->vertices_mm[solid->triangles[t][2]], a)));
    }
    return 0.5 * sum;
}

static void a_tube_is_a_cylinder_between_two_half_spheres(void **state)
{
    (void)state;
    const struct sim_joint joints[] = {
        {{3.0, -7.0, 20.0}, 9.0}, {{9.0, 5.0, 32.0}, 9.0}, {{33.0, 53.0, 80.0}, 9.0}};
    struct sim_solid *tube = NULL;
    assert_int_equal(sim_solid_tube(joints, 3, SIM_SKIN, &tube), 0);
    double length = iso_norm(iso_sub(joints[2].at_mm, joints[0].at_mm));
    double exact = pi * 81.0 * length + 4.0 / 3.0 * pi * 729.0;
    double share = fabs(volume(tube)) / exact; /* a polygon of 16 sides has 0.974 of its circle */
    print_message("tube: volume %.4f of the round one\n", share);
    assert_true(share > 0.955 && share < 0.985);
    for (uint32_t i = 0; i < tube->n_vertices; i++) {
        struct iso_vec3 along = iso_unit(iso_sub(joints[2].at_mm, joints[0].at_mm));
        struct iso_vec3 from = iso_sub(tube->vertices_mm[i], joints[0].at_mm);
        double s = fmin(fmax(iso_dot(from, along), 0.0), length);
        assert_true(fabs(iso_norm(iso_madd(from, -s, along)) - 9.0) < 1e-9);
    }
    sim_solid_free(tube);
}

static void a_superellipsoid_runs_from_ellipsoid_to_box(void **state)
{
    (void)state;
    const struct iso_vec3 half = {30.0, 50.0, 20.0};
    double eighth = half.x * half.y * half.z;
    struct sim_solid *round = NULL, *square = NULL;
    assert_int_equal(sim_solid_superellipsoid(half, 1.0, SIM_SKIN, &round), 0);
    assert_int_equal(sim_solid_superellipsoid(half, 0.05, SIM_SKIN, &square), 0);
    print_message("superellipsoids: %.3f of the ellipsoid, %.3f of the box\n",
                  fabs(volume(round)) / (4.0 / 3.0 * pi * eighth),
                  fabs(volume(square)) / (8.0 * eighth));
    assert_true(fabs(fabs(volume(round)) / (4.0 / 3.0 * pi * eighth) - 1.0) < 0.02);
    assert_true(fabs(fabs(volume(square)) / (8.0 * eighth) - 1.0) < 0.06);
    sim_solid_free(round);
    sim_solid_free(square);
}

static void a_thickened_sheet_has_a_volume(void **state)
{
    (void)state;
    struct sim_solid *sheet = NULL;
    assert_int_equal(sim_solid_rectangle(120.0, 70.0, 0.0, SIM_PLASTIC, &sheet), 0);
    assert_int_equal(sim_solid_thicken(sheet, 2.0), 0);
    assert_true(fabs(volume(sheet) - 120.0 * 70.0 * 2.0) < 1e-6);
    assert_true(fabs(area(sheet) - 2.0 * (120.0 * 70.0 + 2.0 * 120.0 + 2.0 * 70.0)) < 1e-6);
    sim_solid_free(sheet);
}

static struct sim_sheet sheet_of(enum sim_sheet_shape shape, double radius_mm)
{
    return (struct sim_sheet){.width_mm = 148.0,
                              .height_mm = 210.0,
                              .shape = shape,
                              .radius_mm = radius_mm,
                              .crease_rad = 0.5,
                              .axis_rad = 0.6};
}

/* Bending keeps lengths: so does every small step on the sheet. */
static void paper_does_not_stretch(void **state)
{
    (void)state;
    for (int shape = SIM_SHEET_FLAT; shape <= SIM_SHEET_CREASED; shape++) {
        struct sim_sheet sheet = sheet_of((enum sim_sheet_shape)shape, -90.0);
        for (int i = 0; i < 400; i++) {
            double x = 7.3 * (i % 20) - 70.1, y = 10.1 * (i / 20) - 101.0;
            struct iso_vec3 here = sim_sheet_point(&sheet, x, y);
            struct iso_vec3 right = sim_sheet_point(&sheet, x + 1e-4, y);
            struct iso_vec3 down = sim_sheet_point(&sheet, x, y + 1e-4);
            assert_true(fabs(iso_norm(iso_sub(right, here)) - 1e-4) < 1e-8);
            assert_true(fabs(iso_norm(iso_sub(down, here)) - 1e-4) < 1e-8);
        }
    }
}

static void a_rolled_sheet_has_its_radius(void **state)
{
    (void)state;
    for (int sign = -1; sign <= 1; sign += 2) {
        struct sim_sheet sheet = sheet_of(SIM_SHEET_ROLLED, sign * 80.0);
        struct sim_solid *solid = NULL;
        struct iso_vec3 axis = {-sin(0.6), cos(0.6), 0.0}, on_axis = {0.0, 0.0, sign * 80.0};
        assert_int_equal(sim_sheet_new(&sheet, SIM_PAPER, &solid), 0);
        for (uint32_t i = 0; i < solid->n_vertices; i++) {
            struct iso_vec3 from = iso_sub(solid->vertices_mm[i], on_axis);
            double distance = iso_norm(iso_madd(from, -iso_dot(from, axis), axis));
            assert_true(fabs(distance - 80.0) < 1e-9);
            assert_true(sign * solid->vertices_mm[i].z >= 0.0);
        }
        assert_true(fabs(area(solid) / (148.0 * 210.0) - 1.0) < 1e-3);
        sim_solid_free(solid);
    }
}

static void a_crease_makes_two_planes(void **state)
{
    (void)state;
    struct sim_sheet sheet = sheet_of(SIM_SHEET_CREASED, 0.0);
    struct sim_solid *solid = NULL;
    assert_int_equal(sim_sheet_new(&sheet, SIM_PAPER, &solid), 0);
    for (uint32_t i = 0; i < solid->n_vertices; i++) {
        struct iso_vec3 p = solid->vertices_mm[i];
        double across = cos(0.6) * p.x + sin(0.6) * p.y;
        assert_true(fabs(p.z - tan(0.5) * fabs(across)) < 1e-9);
    }
    sim_solid_free(solid);
}

static void an_outline_cuts_the_corners_off(void **state)
{
    (void)state;
    struct sim_sheet sheet = sheet_of(SIM_SHEET_FLAT, 0.0);
    struct sim_solid *solid = NULL;
    sheet.outline = true;
    assert_int_equal(sim_sheet_new(&sheet, SIM_PAPER, &solid), 0);
    double share = area(solid) / (148.0 * 210.0);
    print_message("outline: %.3f of the sheet\n", share);
    assert_true(share > 0.70 && share < 0.85); /* an ellipse has 0.785 */
    sim_solid_free(solid);
}

static double area_of(const struct sim_group *group, enum sim_material material)
{
    double sum = 0.0;
    for (size_t i = 0; i < group->n_solids; i++) {
        sum += group->solids[i]->material == material ? area(group->solids[i]) : 0.0;
    }
    return sum;
}

static void a_screen_loses_the_share_it_should(void **state)
{
    (void)state;
    static const double shares[] = {0.0, 0.37, 0.9, 1.0};
    for (size_t i = 0; i < sizeof shares / sizeof *shares; i++) {
        struct sim_screen screen = {.width_mm = 160.0,
                                    .height_mm = 230.0,
                                    .rim_mm = 9.0,
                                    .thickness_mm = 7.0,
                                    .lost = shares[i],
                                    .patch_mm = 40.0,
                                    .key = 5};
        struct sim_group *group = NULL;
        assert_int_equal(sim_group_new(&group), 0);
        sim_screen_add(group, &screen);
        assert_int_equal(group->error, 0);
        double lost = area_of(group, SIM_MIRROR), kept = area_of(group, SIM_GLASS);
        assert_true(fabs(lost + kept - 160.0 * 230.0) < 1e-6);
        assert_true(fabs(lost / (160.0 * 230.0) - shares[i]) < 1e-3);
        sim_group_free(group);
    }
}

struct extent {
    struct iso_vec3 least, most;
};

static struct extent extent_of(const struct sim_solid *solid)
{
    struct extent e = {solid->vertices_mm[0], solid->vertices_mm[0]};
    for (uint32_t i = 0; i < solid->n_vertices; i++) {
        struct iso_vec3 p = solid->vertices_mm[i];
        e.least = iso_vec3(fmin(e.least.x, p.x), fmin(e.least.y, p.y), fmin(e.least.z, p.z));
        e.most = iso_vec3(fmax(e.most.x, p.x), fmax(e.most.y, p.y), fmax(e.most.z, p.z));
    }
    return e;
}

/* ---- what needs the head model ---------------------------------------------- */

struct head {
    struct sim_ict *ict;
    struct iso_vec3 *vertices_mm;
};

static struct head load_head(void)
{
    struct head head = {0};
    const char *shared = getenv("ISOTHERM_SHARED");
    const char *path = scratch_path(shared ? shared : ISOTHERM_SOURCE_DIR "/../shared",
                                    "data/ict-face");
    struct sim_person person = sim_person_draw(SIM_POPULATION_TEST, 3, 1, 1.0);
    if (!scratch_exists(path)) {
        skip();
    }
    assert_int_equal(sim_ict_load(path, &head.ict, NULL), 0);
    head.vertices_mm = malloc(head.ict->n_vertices * sizeof *head.vertices_mm);
    assert_non_null(head.vertices_mm);
    sim_person_surface(head.ict, &person, NULL, head.vertices_mm);
    return head;
}

static void free_head(struct head *head)
{
    free(head->vertices_mm);
    sim_ict_free(head->ict);
}

static struct sim_solid *print_of(const struct head *head, const struct sim_face_print *print)
{
    struct sim_solid *solid = NULL;
    assert_int_equal(sim_face_print_new(head->ict, head->vertices_mm, print, SIM_PLASTIC, &solid),
                     0);
    assert_int_equal(solid->material, SIM_PLASTIC);
    return solid;
}

static void a_print_has_its_scale(void **state)
{
    (void)state;
    struct head head = load_head();
    for (int whole = 0; whole < 2; whole++) {
        struct sim_face_print print = {.scale = 1.0, .whole_head = whole};
        struct sim_solid *full = print_of(&head, &print);
        print.scale = 0.6;
        struct sim_solid *small = print_of(&head, &print);
        struct extent a = extent_of(full), b = extent_of(small);
        assert_int_equal(full->n_triangles, small->n_triangles);
        assert_true(fabs((b.most.x - b.least.x) / (a.most.x - a.least.x) - 0.6) < 1e-9);
        assert_true(fabs((b.most.y - b.least.y) / (a.most.y - a.least.y) - 0.6) < 1e-9);
        assert_true(fabs((b.most.z - b.least.z) / (a.most.z - a.least.z) - 0.6) < 1e-9);
        print_message("%s of %.0f x %.0f x %.0f mm\n", whole ? "head" : "face",
                      a.most.x - a.least.x, a.most.y - a.least.y, a.most.z - a.least.z);
        assert_true(a.most.y - a.least.y > (whole ? 220.0 : 140.0));
        sim_solid_free(full);
        sim_solid_free(small);
    }
    free_head(&head);
}

/* The depth seen at a point of the face frame by an orthographic camera before the face. */
static double seen_at(struct sim_view *view, struct iso_vec3 p)
{
    double u, v;
    struct iso_vec3 in_camera = {p.x, -p.y, 500.0 - p.z};
    assert_true(iso_camera_project(&view->camera, in_camera, &u, &v));
    return (double)view->depth_mm[lrint(v) * view->camera.width_px + lrint(u)];
}

static void openings_let_the_eyes_see(void **state)
{
    (void)state;
    struct head head = load_head();
    const struct iso_camera camera = {.projection = ISO_ORTHOGRAPHIC,
                                      .width_px = 601,
                                      .height_px = 701,
                                      .pitch_mm = 0.5,
                                      .cx_px = 300.0,
                                      .cy_px = 350.0};
    struct iso_rigid before = {{{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}}}, {0.0, 0.0, 500.0}};
    struct iso_vec3 pupil = iso_scale(0.5, iso_add(head.vertices_mm[head.ict->landmarks[42]],
                                                   head.vertices_mm[head.ict->landmarks[45]]));
    struct iso_vec3 nose = head.vertices_mm[head.ict->landmarks[30]];
    for (int cut = 0; cut < 2; cut++) {
        struct sim_face_print print = {
            .scale = 1.0, .eyes_cut = cut, .opening = 1.2, .shell_mm = cut ? 2.0 : 0.0};
        struct sim_solid *solid = print_of(&head, &print);
        struct iso_vec3 *scratch = malloc(solid->n_vertices * sizeof *scratch);
        struct sim_view *view = NULL;
        assert_int_equal(sim_view_new(&camera, 1, &view), 0);
        assert_int_equal(sim_solid_draw(solid, &before, scratch, view), 0);
        assert_true(fabs(seen_at(view, nose) - (500.0 - nose.z)) < 0.3);
        assert_true(cut ? seen_at(view, pupil) <= 0.0 : seen_at(view, pupil) > 0.0);
        sim_view_free(view);
        sim_solid_free(solid);
        free(scratch);
    }
    free_head(&head);
}

/* The shell's volume is about its outer surface times its thickness. */
static void a_shell_is_two_millimetres_thick(void **state)
{
    (void)state;
    struct head head = load_head();
    struct sim_face_print print = {.scale = 1.0, .eyes_cut = true, .opening = 1.2};
    struct sim_solid *thin = print_of(&head, &print);
    print.shell_mm = 2.0;
    struct sim_solid *shell = print_of(&head, &print);
    double thickness = volume(shell) / area(thin);
    print_message("shell: %.2f mm\n", thickness);
    assert_true(thickness > 1.7 && thickness < 2.1);
    sim_solid_free(thin);
    sim_solid_free(shell);
    free_head(&head);
}

static void who_wears_a_mask_is_behind_it(void **state)
{
    (void)state;
    struct head head = load_head();
    struct sim_person other = sim_person_draw(SIM_POPULATION_TEST, 3, 2, 1.0);
    struct iso_vec3 *inner = malloc(head.ict->n_vertices * sizeof *inner);
    assert_non_null(inner);
    sim_person_surface(head.ict, &other, NULL, inner);
    double push = sim_face_print_push(head.vertices_mm, inner, 2.5), least = 1e9;
    for (uint32_t v = 0; v < SIM_ICT_NARROW_FACE_END; v++) {
        least = fmin(least, head.vertices_mm[v].z - (inner[v].z - push));
    }
    assert_true(fabs(least - 2.5) < 1e-9);
    free(inner);
    free_head(&head);
}

/* ---- hands and groups ------------------------------------------------------- */

static struct extent extent_of_group(const struct sim_group *group, enum sim_material material)
{
    struct extent e = {{1e9, 1e9, 1e9}, {-1e9, -1e9, -1e9}};
    for (size_t i = 0; i < group->n_solids; i++) {
        if (group->solids[i]->material != material) {
            continue;
        }
        struct extent s = extent_of(group->solids[i]);
        e.least = iso_vec3(fmin(e.least.x, s.least.x), fmin(e.least.y, s.least.y),
                           fmin(e.least.z, s.least.z));
        e.most = iso_vec3(fmax(e.most.x, s.most.x), fmax(e.most.y, s.most.y),
                          fmax(e.most.z, s.most.z));
    }
    return e;
}

/* From the wrist to the tip of the middle finger 189 mm (DIN 33402-2), here +-14 %. */
static void hands_have_the_size_of_hands(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 20; seed++) {
        struct sim_random random = sim_random_seeded(seed, 1, 0);
        struct sim_group *open = NULL, *fist = NULL;
        assert_int_equal(sim_group_new(&open), 0);
        assert_int_equal(sim_group_new(&fist), 0);
        sim_hand_add(open, SIM_HAND_OPEN, seed % 2 == 0, 0.0, &random);
        sim_hand_add(fist, SIM_HAND_FIST, seed % 2 == 0, 0.0, &random);
        assert_int_equal(open->error, 0);
        double length = -extent_of_group(open, SIM_SKIN).least.y;
        double folded = -extent_of_group(fist, SIM_SKIN).least.y;
        assert_true(length > 150.0 && length < 215.0);
        assert_true(folded > 80.0 && folded < 140.0);
        sim_group_free(open);
        sim_group_free(fist);
    }
}

/* Nothing of the fingers comes before what is held but the thumb, which is 12 mm thick. */
static void a_grip_leaves_room_for_what_it_holds(void **state)
{
    (void)state;
    static const double held[] = {0.0, 35.0};
    for (size_t k = 0; k < 2; k++) {
        struct sim_random random = sim_random_seeded(9, 2, 0);
        struct sim_group *group = NULL;
        int inside = 0;
        assert_int_equal(sim_group_new(&group), 0);
        sim_hand_add(group, SIM_HAND_GRIP, true, held[k], &random);
        for (size_t i = 0; i < group->n_solids; i++) {
            const struct sim_solid *solid = group->solids[i];
            for (uint32_t v = 0; v < solid->n_vertices; v++) {
                struct iso_vec3 p = solid->vertices_mm[v];
                inside += p.y < -75.0 && p.z > 1.0 && p.z < held[k] + 5.0;
            }
        }
        assert_int_equal(inside, 0);
        sim_group_free(group);
    }
}

static void bad_arguments_are_refused(void **state)
{
    (void)state;
    struct sim_solid *solid = NULL;
    struct sim_sheet sheet = sheet_of(SIM_SHEET_ROLLED, 0.0);
    const struct sim_joint thin[] = {{{0, 0, 0}, 1.0}, {{0, 0, 9}, 0.0}};
    const struct iso_vec3 half = {1, 2, 3}, empty = {1, 0, 3};
    assert_int_equal(sim_sheet_new(&sheet, SIM_PAPER, &solid), -EINVAL);
    sheet = sheet_of(SIM_SHEET_FLAT, 0.0);
    sheet.height_mm = 0.0;
    assert_int_equal(sim_sheet_new(&sheet, SIM_PAPER, &solid), -EINVAL);
    assert_int_equal(sim_solid_tube(thin, 2, SIM_SKIN, &solid), -EINVAL);
    assert_int_equal(sim_solid_tube(thin, 1, SIM_SKIN, &solid), -EINVAL);
    assert_int_equal(sim_solid_superellipsoid(empty, 1.0, SIM_SKIN, &solid), -EINVAL);
    assert_int_equal(sim_solid_superellipsoid(half, 0.0, SIM_SKIN, &solid), -EINVAL);
    assert_int_equal(sim_solid_superellipsoid(half, 1.1, SIM_SKIN, &solid), -EINVAL);
    assert_null(solid);
}

/* A group remembers the first failure and holds on to nothing of what came after. */
static void every_allocation_may_fail(void **state)
{
    (void)state;
    const struct sim_screen screen = {.width_mm = 60.0,
                                      .height_mm = 90.0,
                                      .rim_mm = 4.0,
                                      .thickness_mm = 7.0,
                                      .lost = 0.5,
                                      .patch_mm = 20.0,
                                      .keyboard = true};
    int failures = 0;
    for (long n = 0;; n++) {
        struct sim_group *group = NULL;
        allocations_left = n;
        int error = sim_group_new(&group);
        if (error == 0) {
            sim_screen_add(group, &screen);
            error = group->error;
        }
        bool failed = allocations_left < 0;
        allocations_left = -1;
        sim_group_free(group);
        if (!failed) {
            assert_int_equal(error, 0);
            break;
        }
        assert_int_equal(error, -ENOMEM);
        failures++;
    }
    print_message("%d allocations failed in turn\n", failures);
    assert_true(failures > 20);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_tube_is_a_cylinder_between_two_half_spheres),
        cmocka_unit_test(a_superellipsoid_runs_from_ellipsoid_to_box),
        cmocka_unit_test(a_thickened_sheet_has_a_volume),
        cmocka_unit_test(paper_does_not_stretch),
        cmocka_unit_test(a_rolled_sheet_has_its_radius),
        cmocka_unit_test(a_crease_makes_two_planes),
        cmocka_unit_test(an_outline_cuts_the_corners_off),
        cmocka_unit_test(a_screen_loses_the_share_it_should),
        cmocka_unit_test(a_print_has_its_scale),
        cmocka_unit_test(openings_let_the_eyes_see),
        cmocka_unit_test(a_shell_is_two_millimetres_thick),
        cmocka_unit_test(who_wears_a_mask_is_behind_it),
        cmocka_unit_test(hands_have_the_size_of_hands),
        cmocka_unit_test(a_grip_leaves_room_for_what_it_holds),
        cmocka_unit_test(bad_arguments_are_refused),
        cmocka_unit_test(every_allocation_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
