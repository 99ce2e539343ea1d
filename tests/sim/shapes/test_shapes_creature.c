/* Flesh, polygons and creatures: closed surfaces of known size, and poses that bend the surface
 * without stretching it. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "sim/shapes/make/creature.h"
#include "sim/shapes/make/flesh.h"
#include "sim/shapes/make/polygonise.h"
#include "sim/shapes/make/species.h"
#include "sim/shapes/make/texture.h"
#include "tests/support/near.h"

/* Asserts that the surface is closed: every edge has two triangles, which run along it in opposite
 * directions. Returns Euler's number. */
static int euler_of_closed(const struct iso_mesh *mesh)
{
    int32_t(*adjacent)[3] = calloc((size_t)mesh->n_triangles, sizeof *adjacent);
    assert_non_null(adjacent);
    assert_int_equal(iso_mesh_check(mesh, NULL), 0);
    assert_int_equal(iso_mesh_adjacency(mesh, adjacent), 0);
    for (int32_t t = 0; t < mesh->n_triangles; t++) {
        for (int k = 0; k < 3; k++) {
            int32_t other = adjacent[t][k], a = mesh->triangles[t][(k + 1) % 3];
            int32_t b = mesh->triangles[t][(k + 2) % 3];
            bool opposite = false;
            assert_true(other >= 0);
            for (int i = 0; i < 3; i++) {
                opposite = opposite || (mesh->triangles[other][i] == b &&
                                        mesh->triangles[other][(i + 1) % 3] == a);
            }
            assert_true(opposite);
        }
    }
    free(adjacent);
    return mesh->n_vertices - mesh->n_triangles / 2;
}

static double volume_of(const struct iso_mesh *mesh)
{
    double sum = 0.0;
    for (int32_t t = 0; t < mesh->n_triangles; t++) {
        const int32_t *c = mesh->triangles[t];
        sum += iso_dot(mesh->vertices_mm[c[0]],
                       iso_cross(mesh->vertices_mm[c[1]], mesh->vertices_mm[c[2]])) /
               6.0;
    }
    return sum;
}

/* A field of 24 x 25 x 26 nodes that falls from the centre. Its levels are spheres. */
static void polygonises_a_sphere(void **state)
{
    struct sim_field_grid grid = {
        .nx = 24, .ny = 25, .nz = 26, .origin_mm = {-12, -12.3, -12.6}, .pitch_mm = 1.0};
    struct iso_mesh *mesh = NULL;
    (void)state;
    grid.value = calloc((size_t)(grid.nx * grid.ny * grid.nz), sizeof *grid.value);
    assert_non_null(grid.value);
    for (int i = 0; i < grid.nx * grid.ny * grid.nz; i++) {
        struct iso_vec3 p = iso_vec3(i % 24 - 12.0, i / 24 % 25 - 12.3, i / 600 - 12.6);
        grid.value[i] = -iso_norm(p);
    }
    assert_int_equal(sim_polygonise(&grid, -9.0, &mesh), 0);
    assert_int_equal(euler_of_closed(mesh), 2);
    assert_near(iso_mesh_area(mesh), 4.0 * M_PI * 81.0, 0.02 * 4.0 * M_PI * 81.0);
    assert_near(volume_of(mesh), 4.0 / 3.0 * M_PI * 729.0,
                0.02 * 3054.0); /* > 0: turned outwards */
    iso_mesh_free(mesh);
    mesh = NULL;
    assert_int_equal(sim_polygonise(&grid, 1.0, &mesh), -EINVAL); /* no such level */
    assert_null(mesh);
    grid.nz = 1;
    assert_int_equal(sim_polygonise(&grid, -9.0, &mesh), -EINVAL);
    free(grid.value);
}

/* The surface is closed for any field. */
static void polygonises_noise(void **state)
{
    struct sim_field_grid grid = {.nx = 9, .ny = 8, .nz = 7, .pitch_mm = 2.0};
    struct sim_random random = sim_random_seeded(1, 2, 3);
    double value[9 * 8 * 7];
    struct iso_mesh *mesh = NULL;
    (void)state;
    grid.value = value;
    for (int i = 0; i < 9 * 8 * 7; i++) {
        int x = i % 9, y = i / 9 % 8, z = i / 72;
        bool border = x == 0 || x == 8 || y == 0 || y == 7 || z == 0 || z == 6;
        value[i] = border ? -1.0 : sim_random_between(&random, -1.0, 1.0);
    }
    assert_int_equal(sim_polygonise(&grid, 0.0, &mesh), 0);
    (void)euler_of_closed(mesh);
    iso_mesh_free(mesh);
}

static void flesh_has_its_radius(void **state)
{
    const struct sim_skeleton rod = {
        .n_bones = 2,
        .bone = {{-1, {0, 0, -60}, {0, 0, -10}, 7, 7, 0, 0},
                 {0, {0, 0, -10}, {0, 0, 60}, 7, 7, 0, 0}},
    };
    const struct sim_bone whole = {-1, {0, 0, -60}, {0, 0, 60}, 7, 7, 0, 0};
    (void)state;
    for (int i = 0; i < 16; i++) {
        struct iso_vec3 p = iso_vec3(7.0 * cos(0.4 * i), 7.0 * sin(0.4 * i), 3.0 * i - 24.0);
        assert_near(sim_flesh_field(&rod, p), sim_flesh_level, 1e-4);
        assert_near(sim_flesh_field(&rod, p), sim_flesh_bone(&whole, p),
                    1e-12); /* joints are smooth */
        struct iso_vec3 slope = sim_flesh_gradient(&rod, p);
        assert_near(iso_dot(iso_unit(slope), iso_unit(iso_vec3(p.x, p.y, 0))), -1.0, 1e-6);
    }
    assert_near(sim_flesh_field(&rod, iso_vec3(0, 7 * sim_flesh_reach, 0)), 0.0, 1e-12);
}

static struct sim_creature *make(const char *name, double pose, uint64_t grid_key,
                                 uint64_t pose_key)
{
    struct sim_random grid = sim_random_seeded(5, 1, grid_key);
    struct sim_random bends = sim_random_seeded(5, 2, pose_key);
    const struct sim_creature_options options = {.n_vertices = 700, .pose = pose};
    struct sim_skeleton skeleton;
    struct sim_creature *creature = NULL;
    int s = 0;
    while (strcmp(sim_species[s].name, name) != 0) {
        s++;
    }
    sim_skeleton_grow(sim_species[s].limbs, sim_species[s].n_limbs, &(struct sim_growth){1, 0.0},
                      &skeleton);
    assert_int_equal(sim_creature_new(&skeleton, &options, &grid, &bends, &creature), 0);
    return creature;
}

static void creatures_bend_without_stretching(void **state)
{
    static const char *const names[] = {"dog", "snake"};
    (void)state;
    for (int i = 0; i < 2; i++) {
        struct sim_creature *at_rest = make(names[i], 0.0, 1, 1), *bent = make(names[i], 1.0, 2, 2);
        assert_int_equal(euler_of_closed(at_rest->mesh), 2);
        assert_int_equal(euler_of_closed(bent->mesh), 2);
        assert_int_equal(bent->mesh->n_vertices, 700);
        double area = iso_mesh_area(at_rest->mesh);
        assert_near(iso_mesh_area(bent->mesh), area, 0.06 * area);
        double moved = 0.0;
        for (int32_t v = 0; v < 700; v++) {
            moved += iso_norm(iso_sub(bent->mesh->vertices_mm[v], bent->rest_mm[v])) / 700.0;
            assert_near(iso_norm(iso_sub(at_rest->mesh->vertices_mm[v], at_rest->rest_mm[v])), 0.0,
                        1e-9);
        }
        assert_true(moved > 3.0);
        sim_creature_free(at_rest);
        sim_creature_free(bent);
    }
}

static void equal_options_make_equal_creatures(void **state)
{
    struct sim_creature *one = make("spider", 1.0, 3, 4), *two = make("spider", 1.0, 3, 4);
    (void)state;
    assert_int_equal(one->mesh->n_vertices, two->mesh->n_vertices);
    assert_memory_equal(one->mesh->vertices_mm, two->mesh->vertices_mm,
                        (size_t)one->mesh->n_vertices * sizeof *one->mesh->vertices_mm);
    sim_creature_free(one);
    sim_creature_free(two);
}

static void triangles_are_well_shaped(void **state)
{
    struct sim_creature *hand = make("hand", 0.0, 6, 6);
    const struct iso_mesh *mesh = hand->mesh;
    double mean = 0.0, worst = 1.0;
    (void)state;
    for (int32_t t = 0; t < mesh->n_triangles; t++) {
        double edges = 0.0;
        for (int k = 0; k < 3; k++) {
            struct iso_vec3 e = iso_sub(mesh->vertices_mm[mesh->triangles[t][k]],
                                        mesh->vertices_mm[mesh->triangles[t][(k + 1) % 3]]);
            edges += iso_dot(e, e);
        }
        double quality = 4.0 * sqrt(3.0) * iso_mesh_triangle_area(mesh, t) / edges;
        mean += quality / mesh->n_triangles;
        worst = fmin(worst, quality);
    }
    print_message("quality of triangles %.3f in the mean, %.3f at worst\n", mean, worst);
    assert_true(mean > 0.8); /* 1 is equilateral */
    assert_true(worst > 0.0);
    sim_creature_free(hand);
}

static void species_and_variants_differ(void **state)
{
    (void)state;
    for (int s = 0; s < SIM_SPECIES; s++) {
        struct sim_skeleton plain, other;
        sim_skeleton_grow(sim_species[s].limbs, sim_species[s].n_limbs,
                          &(struct sim_growth){7, 0.0}, &plain);
        sim_skeleton_grow(sim_species[s].limbs, sim_species[s].n_limbs,
                          &(struct sim_growth){7, 0.4}, &other);
        assert_true(plain.n_bones >= 10 && plain.n_bones < SIM_BONES_MAX);
        assert_int_equal(plain.n_bones, other.n_bones);
        double longest = 0.0;
        for (int b = 0; b < plain.n_bones; b++) {
            const struct sim_bone *p = &plain.bone[b], *q = &other.bone[b];
            double ratio = iso_norm(iso_sub(q->to_mm, q->from_mm)) /
                           iso_norm(iso_sub(p->to_mm, p->from_mm));
            assert_true(p->parent < b);
            assert_true(fabs(log(ratio)) <= 0.4 + 1e-9);
            longest = fmax(longest, fabs(log(ratio)));
        }
        assert_true(longest > 0.02);
    }
}

static void coats_stay_in_range(void **state)
{
    struct sim_random random = sim_random_seeded(1, 1, 1);
    (void)state;
    for (int t = 0; t < SIM_TEXTURES; t++) {
        float low = 1.0f, high = 0.0f;
        for (int i = 0; i < 500; i++) {
            struct iso_vec3 p = iso_vec3(sim_random_between(&random, -60, 60),
                                         sim_random_between(&random, 0, 150),
                                         sim_random_between(&random, -90, 90));
            struct iso_colour c = sim_texture_colour((enum sim_texture)t, 1, p);
            for (int k = 0; k < 3; k++) {
                assert_true(c.channel[k] >= 0.0f && c.channel[k] <= 1.0f);
            }
            low = fminf(low, c.channel[0]);
            high = fmaxf(high, c.channel[0]);
        }
        assert_true(high - low > 0.3f); /* there is a pattern */
        assert_non_null(sim_texture_name((enum sim_texture)t));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(polygonises_a_sphere),
        cmocka_unit_test(polygonises_noise),
        cmocka_unit_test(flesh_has_its_radius),
        cmocka_unit_test(creatures_bend_without_stretching),
        cmocka_unit_test(equal_options_make_equal_creatures),
        cmocka_unit_test(triangles_are_well_shaped),
        cmocka_unit_test(species_and_variants_differ),
        cmocka_unit_test(coats_stay_in_range),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
