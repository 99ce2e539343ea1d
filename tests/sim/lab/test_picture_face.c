/* Pictures of an artificial face: a mesh like a bowl, and a template with round isotherms. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "drivers/file/png.h"
#include "sim/lab/draw/colour.h"
#include "sim/lab/picture/face.h"
#include "tests/support/scratch.h"

enum { SIDE = 41, VERTICES = SIDE * SIDE };

static const double pitch_mm = 5.0;

static double surface_z(double x, double y)
{
    return -(x * x + 0.5 * y * y) / 200.0;
}

static struct iso_template template_with(struct iso_vec3 centre_mm, double radius_mm)
{
    struct iso_template t = {.n_radii = 1, .n_points = 32, .n_frames = 1};
    for (int i = 0; i < t.n_points; i++) {
        double angle = 2.0 * M_PI * i / t.n_points;
        double x = centre_mm.x - radius_mm * sin(angle), y = centre_mm.y + radius_mm * cos(angle);
        float *p = t.points_mm[0][ISO_LM_EYE_OUT_L][i];
        p[0] = (float)x;
        p[1] = (float)y;
        p[2] = (float)surface_z(x, y);
        t.weight[0][ISO_LM_EYE_OUT_L][i] = 1.0f;
    }
    return t;
}

static struct iso_mesh *new_mesh(void)
{
    struct iso_mesh *mesh = NULL;
    assert_int_equal(iso_mesh_new(VERTICES, 2 * VERTICES, &mesh), 0);
    for (int j = 0; j < SIDE; j++) {
        for (int i = 0; i < SIDE; i++) {
            double x = (i - SIDE / 2) * pitch_mm, y = (j - SIDE / 2) * pitch_mm;
            mesh->vertices_mm[mesh->n_vertices++] = iso_vec3(x, y, surface_z(x, y));
            if (i > 0 && j > 0) {
                int32_t v = j * SIDE + i;
                const int32_t two[2][3] = {{v - SIDE - 1, v - SIDE, v}, {v - SIDE - 1, v, v - 1}};
                memcpy(mesh->triangles[mesh->n_triangles], two, sizeof two);
                mesh->n_triangles += 2;
            }
        }
    }
    return mesh;
}

/* Returns the number of pixels of a colour in a picture. *column is the mean of their columns. */
static int count_pixels(const struct iso_image *image, struct sim_colour colour, double *column)
{
    const uint8_t *bytes = image->samples;
    int n = 0;
    *column = 0.0;
    for (int y = 0; y < image->height_px; y++) {
        for (int x = 0; x < image->width_px; x++) {
            const uint8_t *p = bytes + (size_t)y * iso_image_row_bytes(image) + (size_t)(3 * x);
            if (p[0] == sim_colour_byte(colour.r) && p[1] == sim_colour_byte(colour.g) &&
                p[2] == sim_colour_byte(colour.b)) {
                *column += x;
                n++;
            }
        }
    }
    *column /= n > 0 ? n : 1;
    return n;
}

static void test_pictures(void **state)
{
    struct iso_mesh *mesh = new_mesh();
    const struct iso_vec3 landmark_mm = iso_vec3(40, 30, surface_z(40, 30));
    struct iso_template tmpl = template_with(landmark_mm, 18.0);
    static double heat[VERTICES];
    for (int v = 0; v < VERTICES; v++) {
        double r = iso_norm(iso_sub(mesh->vertices_mm[v], landmark_mm));
        heat[v] = exp(-r * r / 400.0);
    }
    struct sim_face face = {.mesh = mesh, .tmpl = &tmpl};
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        face.landmark_mm[l] = landmark_mm;
        face.heat[l] = heat;
    }
    const struct sim_face_angle angle = {0.0, 0.0};
    struct iso_fault fault = {.text = ""};
    const char *path = scratch_path(*state, "isotherms.png");
    assert_int_equal(sim_picture_isotherms(&face, angle, path, &fault), 0);
    struct iso_image image = {0};
    assert_int_equal(iso_png_read(path, NULL, &image, &fault), 0);
    assert_int_equal(image.width_px, 900);
    assert_int_equal(image.height_px, 700);
    /* The curve of 18 mm radius, 3 px wide, is on the subject's left, which is the picture's right.
     */
    double column, px_per_mm = 700.0 / (1.12 * (SIDE - 1) * pitch_mm);
    int n = count_pixels(&image, sim_colour_landmark(ISO_LM_EYE_OUT_L), &column);
    assert_in_range((uintmax_t)n, (uintmax_t)(1.0 * 2.0 * M_PI * 18.0 * px_per_mm),
                    (uintmax_t)(3.5 * 2.0 * M_PI * 18.0 * px_per_mm));
    assert_true(fabs(column - (450.0 + 40.0 * px_per_mm)) < 12.0);

    path = scratch_path(*state, "heat.png");
    assert_int_equal(sim_picture_heat(&face, angle, path, &fault), 0);
    assert_int_equal(iso_png_read(path, NULL, &image, &fault), 0);
    assert_int_equal(image.width_px, 4 * 280);
    assert_int_equal(image.height_px, 3 * 300);
    path = scratch_path(*state, "mesh.png");
    assert_int_equal(sim_picture_mesh(&face, angle, path, &fault), 0);
    assert_int_equal(iso_png_read(path, NULL, &image, &fault), 0);
    path = scratch_path(*state, "missing/mesh.png");
    assert_int_equal(sim_picture_mesh(&face, angle, path, &fault), -EIO);
    iso_image_done(&image);
    iso_mesh_free(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_pictures, scratch_setup, scratch_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
