#include "tests/core/surfaces/presented.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "sim/base/noise3.h"
#include "sim/world/prop/solid.h"

#define DEGREES(x) ((x)*0.017453292519943295)

enum { ROWS = 41, COLUMNS = 41, EYE = 36, EYE_CORNERS = 6 };

struct presented *presented_new(const struct sim_sensor *sensor, const struct iso_head_model *model,
                                uint64_t seed)
{
    struct presented *p = calloc(1, sizeof *p);
    assert_non_null(p);
    p->sensor = sensor;
    p->model = model;
    p->noise_scale = 1.0;
    p->random = sim_random_seeded(seed, sim_random_hash(sensor->name), 0);
    p->shape_mm = calloc(model->n_vertices, sizeof *p->shape_mm);
    p->moved_mm = calloc(model->n_vertices, sizeof *p->moved_mm);
    assert_non_null(p->shape_mm);
    assert_non_null(p->moved_mm);
    assert_int_equal(sim_view_new(&sensor->camera, sensor->supersample, &p->view), 0);
    assert_int_equal(sim_sensor_workspace_new(sensor, &p->workspace), 0);
    assert_int_equal(iso_frame_new(&sensor->camera, sensor->camera.width_px,
                                   sensor->camera.height_px, false, &p->frame),
                     0);
    return p;
}

void presented_free(struct presented *p)
{
    if (p) {
        sim_view_free(p->view);
        sim_sensor_workspace_free(p->workspace);
        iso_frame_free(p->frame);
        free(p->shape_mm);
        free(p->moved_mm);
        free(p);
    }
}

/* Adds modes of the head with normal coefficients. */
static void add_modes(struct presented *p, const float *mode, uint32_t n_modes)
{
    for (uint32_t k = 0; k < n_modes; k++) {
        double c = sim_random_normal(&p->random);
        for (uint32_t i = 0; i < p->model->n_vertices; i++, mode += 3) {
            p->shape_mm[i] = iso_madd(p->shape_mm[i], c,
                                      iso_vec3((double)mode[0], (double)mode[1], (double)mode[2]));
        }
    }
}

void presented_draw_person(struct presented *p)
{
    for (uint32_t i = 0; i < p->model->n_vertices; i++) {
        p->shape_mm[i] = p->model->mean_mm[i];
    }
    add_modes(p, p->model->identity_mm, p->model->n_identity);
    add_modes(p, p->model->expression_mm, p->model->n_expression);
}

static double angle_within(struct presented *p, double limit_rad)
{
    return sim_random_between(&p->random, -limit_rad, limit_rad);
}

struct iso_rigid presented_draw_pose(struct presented *p)
{
    struct iso_mat3 facing = {{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}}};
    double pitch = angle_within(p, DEGREES(10.0)), yaw = angle_within(p, DEGREES(10.0));
    struct iso_mat3 turned = iso_mat3_rotation(
        iso_vec3(pitch, yaw, angle_within(p, DEGREES(10.0))));
    double x = sim_random_between(&p->random, -40.0, 40.0);
    double y = sim_random_between(&p->random, -40.0, 40.0);
    double z = sim_random_between(&p->random, p->sensor->distance_min_mm,
                                  p->sensor->distance_max_mm);
    return (struct iso_rigid){iso_mat3_mul(&facing, &turned), iso_vec3(x, y, z)};
}

static void draw_solid(struct presented *p, struct sim_solid *solid, const struct iso_rigid *pose)
{
    sim_solid_move(solid, pose);
    assert_int_equal(sim_view_draw(p->view, solid->vertices_mm,
                                   (const uint32_t(*)[3])solid->triangles, solid->n_triangles,
                                   solid->material),
                     0);
    sim_solid_free(solid);
}

void presented_clear(struct presented *p)
{
    struct sim_solid *wall;
    struct iso_rigid at = {iso_mat3_identity(), {0, 0, 0}};
    at.translation_mm.z = sim_random_between(&p->random, 1300.0, 2600.0);
    sim_view_clear(p->view);
    assert_int_equal(sim_solid_rectangle(9000.0, 7000.0, 0.0, SIM_WALL, &wall), 0);
    draw_solid(p, wall, &at);
}

/* Returns whether a point is within the contour of an eye, seen along z. All points are in the same
 * frame. */
static bool in_eye(const struct iso_vec3 contour[EYE_CORNERS], struct iso_vec3 q)
{
    bool inside = false;
    for (int i = 0, j = EYE_CORNERS - 1; i < EYE_CORNERS; j = i++) {
        struct iso_vec3 a = contour[i], b = contour[j];
        if ((a.y > q.y) != (b.y > q.y) && q.x < (b.x - a.x) * (q.y - a.y) / (b.y - a.y) + a.x) {
            inside = !inside;
        }
    }
    return inside;
}

/* Draws the triangles of a head in small pieces, without the pieces between the eyelids, so that
 * the holes have the outline of the lids. */
static void draw_cut(struct presented *p)
{
    enum { PIECES = 8 };
    struct iso_vec3 eye[2][EYE_CORNERS];
    for (int k = 0; k < 2 * EYE_CORNERS; k++) {
        eye[k / EYE_CORNERS][k % EYE_CORNERS] = iso_head_point_on(p->model, p->moved_mm,
                                                                  p->model->landmarks[EYE + k]);
    }
    static const uint32_t one[1][3] = {{0, 1, 2}};
    for (uint32_t t = 0; t < p->model->n_triangles; t++) {
        const uint32_t *c = p->model->triangles[t];
        struct iso_vec3 a = p->moved_mm[c[0]];
        struct iso_vec3 u = iso_scale(1.0 / PIECES, iso_sub(p->moved_mm[c[1]], a));
        struct iso_vec3 v = iso_scale(1.0 / PIECES, iso_sub(p->moved_mm[c[2]], a));
        for (int i = 0; i < PIECES; i++) {
            for (int j = 0; j < 2 * (PIECES - i) - 1; j++) {
                int k = j / 2, up = j % 2;
                struct iso_vec3 q = iso_madd(iso_madd(a, i, u), k, v);
                struct iso_vec3 small[3] = {iso_madd(q, up, v), iso_add(iso_madd(q, up, v), u),
                                            iso_add(q, v)};
                if (up) {
                    small[0] = iso_add(q, v);
                    small[1] = iso_add(q, u);
                    small[2] = iso_add(iso_add(q, u), v);
                }
                struct iso_vec3 middle = iso_scale(1.0 / 3.0,
                                                   iso_add(small[0], iso_add(small[1], small[2])));
                /* The head and the contours are in the camera frame, and the head is seen nearly
                 * from the front. */
                if (!in_eye(eye[0], middle) && !in_eye(eye[1], middle)) {
                    assert_int_equal(sim_view_draw(p->view, small, one, 1, SIM_PAPER), 0);
                }
            }
        }
    }
}

void presented_head(struct presented *p, const struct iso_rigid *pose, double size, unsigned flags)
{
    for (uint32_t i = 0; i < p->model->n_vertices; i++) {
        p->moved_mm[i] = iso_rigid_apply(pose, iso_scale(size, p->shape_mm[i]));
    }
    if (flags & PRESENTED_EYES_CUT) {
        draw_cut(p);
        return;
    }
    assert_int_equal(sim_view_draw(p->view, p->moved_mm, (const uint32_t(*)[3])p->model->triangles,
                                   p->model->n_triangles, SIM_SKIN),
                     0);
}

void presented_behind(struct presented *p, const struct iso_rigid *pose, double behind_mm)
{
    struct sim_solid *plate;
    assert_int_equal(sim_solid_rectangle(110.0, 50.0, 0.0, SIM_SKIN, &plate), 0);
    struct iso_vec3 eyes = {0, 0, 0};
    for (int k = 0; k < 2 * EYE_CORNERS; k++) {
        eyes = iso_madd(eyes, 0.5 / EYE_CORNERS,
                        iso_head_point_on(p->model, p->shape_mm, p->model->landmarks[EYE + k]));
    }
    eyes.z -= behind_mm;
    struct iso_rigid face_from_plate = {iso_mat3_identity(), eyes};
    struct iso_rigid placed = iso_rigid_mul(pose, &face_from_plate);
    draw_solid(p, plate, &placed);
}

struct presented_sheet presented_draw_sheet(struct presented *p, enum presented_bend bend)
{
    struct sim_random *r = &p->random;
    double size = sim_random_between(r, 0.75, 1.5); /* from about A5 to A3 */
    struct presented_sheet sheet = {
        .width_mm = 190.0 * size, .height_mm = 265.0 * size, .bend = bend};
    sheet.radius_mm = sim_random_between(r, 60.0, 300.0);
    sheet.crease_rad = sim_random_between(r, DEGREES(15.0), DEGREES(50.0));
    sheet.axis_rad = sim_random_unit(r) < 0.5 ? 0.0 : sim_random_between(r, 0.0, DEGREES(180.0));
    sheet.oval = sim_random_unit(r) < 0.25;
    sheet.hand = sim_random_unit(r) < 0.5;
    return sheet;
}

/* Finds the place of the point at the distance `s` along the sheet: *t to the side of the middle of
 * the sheet, and *back behind it. */
static void profile(const struct presented_sheet *sheet, double s, double *t, double *back)
{
    double r = sheet->radius_mm, fold = 60.0;
    *t = s;
    *back = 0.0;
    switch (sheet->bend) {
    case PRESENTED_FLAT:
        break;
    case PRESENTED_ROLLED:
        s = fmin(fmax(s, -1.4 * r), 1.4 * r);
        *t = r * sin(s / r);
        *back = r * (1.0 - cos(s / r));
        break;
    case PRESENTED_WAVY:
        *back = 12.0 * sin(s / sqrt(12.0 * r)); /* curvature 1 / r at the crests */
        break;
    case PRESENTED_CREASED:
        *back = tan(sheet->crease_rad) * fabs(fmod(s + 10.5 * fold, fold) - 0.5 * fold);
        break;
    }
}

void presented_sheet(struct presented *p, const struct presented_sheet *sheet,
                     const struct iso_rigid *pose)
{
    struct sim_solid *solid;
    double c = cos(sheet->axis_rad), s = sin(sheet->axis_rad);
    assert_int_equal(sim_solid_sheet(ROWS, COLUMNS, SIM_PAPER, &solid), 0);
    for (int i = 0; i < ROWS; i++) {
        for (int j = 0; j < COLUMNS; j++) {
            double x = 2.0 * j / (COLUMNS - 1) - 1.0, y = 2.0 * i / (ROWS - 1) - 1.0, t, back;
            if (sheet->oval) { /* moves the points of the square towards its centre */
                double longest = fmax(fabs(x), fabs(y)), r = hypot(x, y);
                x = r > 0.0 ? x * longest / r : 0.0;
                y = r > 0.0 ? y * longest / r : 0.0;
            }
            x *= 0.5 * sheet->width_mm;
            y *= 0.5 * sheet->height_mm;
            profile(sheet, c * x + s * y, &t, &back);
            double along = c * y - s * x;
            solid->vertices_mm[i * COLUMNS + j] = iso_vec3(c * t - s * along, s * t + c * along,
                                                           -back);
        }
    }
    draw_solid(p, solid, pose);
    if (sheet->hand) {
        struct sim_solid *thumb, *arm;
        struct iso_rigid at = {iso_mat3_identity(), {0.0, -0.5 * sheet->height_mm + 15.0, 6.0}};
        assert_int_equal(sim_solid_box(iso_vec3(20.0, 60.0, 14.0), SIM_SKIN, &thumb), 0);
        assert_int_equal(sim_solid_box(iso_vec3(75.0, 320.0, 70.0), SIM_CLOTH, &arm), 0);
        struct iso_rigid placed = iso_rigid_mul(pose, &at);
        draw_solid(p, thumb, &placed);
        at.translation_mm = iso_vec3(0.0, -0.5 * sheet->height_mm - 170.0, -60.0);
        placed = iso_rigid_mul(pose, &at);
        draw_solid(p, arm, &placed);
    }
}

void presented_measure(struct presented *p)
{
    sim_view_finish(p->view);
    sim_sensor_measure(p->sensor, p->view, p->noise_scale, &p->random, p->workspace, p->frame);
}

void presented_blind(struct presented *p, const struct presented_sheet *sheet,
                     const struct iso_rigid *pose, double bezel_mm, double lost_share)
{
    struct iso_rigid sheet_from_camera = iso_rigid_inverse(pose);
    uint64_t key = sim_random_u64(&p->random);
    for (int row = 0; row < p->frame->height_px; row++) {
        for (int column = 0; column < p->frame->width_px; column++) {
            float *z = &p->frame->depth_mm[row * p->frame->width_px + column];
            if (!(*z > 0.0f)) {
                continue;
            }
            struct iso_vec3 q = iso_rigid_apply(&sheet_from_camera,
                                                iso_frame_point_at(p->frame, column, row));
            bool glass = fabs(q.x) < 0.5 * sheet->width_mm - bezel_mm &&
                         fabs(q.y) < 0.5 * sheet->height_mm - bezel_mm && fabs(q.z) < 20.0;
            double level = sim_noise3(key, iso_scale(1.0 / 18.0, q)); /* -1..1, about even */
            if (glass && 0.5 + 0.9 * level < lost_share) {
                *z = 0.0f;
            }
        }
    }
}
