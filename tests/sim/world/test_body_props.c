/* Objects that people wear or hold, and their hands: printed faces, masks and hands, compared with
 * their measures. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "sim/world/face/ict.h"
#include "sim/world/face/person.h"
#include "sim/world/prop/face_print.h"
#include "sim/world/prop/group.h"
#include "sim/world/prop/hair.h"
#include "sim/world/prop/hand.h"
#include "sim/world/view/view.h"
#include "tests/sim/world/solid_measure.h"
#include "tests/support/scratch.h"
#include "tests/support/shared_data.h"

/* ---- prints and masks ---- */

struct head {
    struct sim_ict *ict;
    struct iso_vec3 *vertices_mm;
};

static struct head load_head(void)
{
    struct head head = {0};
    const char *path = shared_data_or_skip("data/ict-face");
    struct sim_person person = sim_person_draw(SIM_POPULATION_TEST, 3, 1, 1.0);
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
        struct solid_extent a = solid_extent(full), b = solid_extent(small);
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

/* Returns the depth at a point of the face frame, as an orthographic camera before the face sees
 * it. */
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
    double thickness = solid_volume(shell) / solid_area(thin);
    print_message("shell: %.2f mm\n", thickness);
    assert_true(thickness > 1.7 && thickness < 2.1);
    sim_solid_free(thin);
    sim_solid_free(shell);
    free_head(&head);
}

static void the_wearer_of_a_mask_is_behind_it(void **state)
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

/* ---- hands ---- */

static struct solid_extent extent_of_group(const struct sim_group *group,
                                           enum sim_material material)
{
    struct solid_extent e = {{1e9, 1e9, 1e9}, {-1e9, -1e9, -1e9}};
    for (size_t i = 0; i < group->n_solids; i++) {
        if (group->solids[i]->material != material) {
            continue;
        }
        struct solid_extent s = solid_extent(group->solids[i]);
        e.least = iso_vec3(fmin(e.least.x, s.least.x), fmin(e.least.y, s.least.y),
                           fmin(e.least.z, s.least.z));
        e.most = iso_vec3(fmax(e.most.x, s.most.x), fmax(e.most.y, s.most.y),
                          fmax(e.most.z, s.most.z));
    }
    return e;
}

/* From the wrist to the tip of the middle finger it is 189 mm (DIN 33402-2), here +-14 %. */
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

/* No part of the hand is in the space of the held object or up to 5 mm behind it. */
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

/* ---- hair ---- */

/* Hair that stays has the same bumps every day, and nearly the same hairline. */
static void kept_hair_stays(void **state)
{
    (void)state;
    struct sim_random random = sim_random_seeded(4, 5, 6);
    int fringes = 0, curtains = 0, bald = 0;
    for (uint64_t person = 0; person < 400; person++) {
        const struct sim_hair hair = sim_hair_kept(person);
        const struct sim_hair today = sim_hair_kept_today(&hair, &random);
        assert_true(today.key == hair.key);
        assert_true(today.scalp == hair.scalp && today.curtain == hair.curtain);
        assert_true(fabs(today.thickness_mm / hair.thickness_mm - 1.0) <= 0.1201);
        assert_true(fabs(today.hairline_mm - hair.hairline_mm) < 7.5);
        fringes += hair.hairline_mm > 20.0;
        curtains += hair.curtain;
        bald += !hair.scalp;
    }
    print_message("of 400 people: %d fringes, %d with long hair, %d bald\n", fringes, curtains,
                  bald);
    assert_in_range(fringes, 120, 220);
    assert_in_range(curtains, 140, 220);
    assert_in_range(bald, 15, 60);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_print_has_its_scale),
        cmocka_unit_test(openings_let_the_eyes_see),
        cmocka_unit_test(a_shell_is_two_millimetres_thick),
        cmocka_unit_test(the_wearer_of_a_mask_is_behind_it),
        cmocka_unit_test(hands_have_the_size_of_hands),
        cmocka_unit_test(a_grip_leaves_room_for_what_it_holds),
        cmocka_unit_test(kept_hair_stays),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
