#include "sim/lab/picture/face.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sim/lab/draw/png_file.h"
#include "sim/lab/picture/scene.h"

static const double viewer_mm = 700.0;

struct sim_face sim_face_of(const struct iso_extractor *extractor,
                            const struct iso_extraction *extraction)
{
    struct sim_face face = {.mesh = iso_extractor_mesh(extractor), .tmpl = &extraction->tmpl};
    struct iso_rigid face_from_camera = iso_rigid_inverse(&extraction->camera_from_face);
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        face.landmark_mm[l] = iso_rigid_apply(&face_from_camera, extraction->source_mm[l]);
        face.heat[l] = iso_extractor_heat(extractor, (enum iso_landmark)l);
    }
    return face;
}

/* A view of the whole mesh, centred. */
static struct sim_view view_of(const struct iso_mesh *mesh, struct sim_face_angle angle)
{
    struct iso_vec3 low = mesh->vertices_mm[0], high = low;
    for (int32_t v = 1; v < mesh->n_vertices; v++) {
        struct iso_vec3 p = mesh->vertices_mm[v];
        low = iso_vec3(fmin(low.x, p.x), fmin(low.y, p.y), fmin(low.z, p.z));
        high = iso_vec3(fmax(high.x, p.x), fmax(high.y, p.y), fmax(high.z, p.z));
    }
    return (struct sim_view){
        .yaw_rad = angle.yaw_rad,
        .pitch_rad = angle.pitch_rad,
        .centre_mm = iso_scale(0.5, iso_add(low, high)),
        .distance_mm = viewer_mm,
        .height_mm = 1.12 * (high.y - low.y),
    };
}

/* Replaces each value by the mean over the triangles around its vertex, a given number of times. */
static int smooth_over(const struct iso_mesh *mesh, int passes, double *value)
{
    const size_t n = (size_t)mesh->n_vertices;
    double *sum = calloc(n, sizeof *sum), *count = calloc(n, sizeof *count);
    const int error = sum && count ? 0 : -ENOMEM;
    for (int pass = 0; !error && pass < passes; pass++) {
        memset(sum, 0, n * sizeof *sum);
        memset(count, 0, n * sizeof *count);
        for (int32_t t = 0; t < mesh->n_triangles; t++) {
            const int32_t *c = mesh->triangles[t];
            for (int k = 0; k < 3; k++) {
                sum[c[k]] += (value[c[0]] + value[c[1]] + value[c[2]]) / 3.0;
                count[c[k]] += 1.0;
            }
        }
        for (size_t v = 0; v < n; v++) {
            value[v] = count[v] > 0.0 ? sum[v] / count[v] : value[v];
        }
    }
    free(sum);
    free(count);
    return error;
}

/* The border of the mesh is jagged, because the grid was cut there. A smooth edge slightly
 * inside looks better and shows the same information. */
static int trim_border(const struct iso_mesh *mesh, float *opacity)
{
    const double reach_mm = 24.0, clear_mm = 6.0, opaque_mm = 6.4;
    const size_t n = (size_t)mesh->n_vertices;
    uint8_t *on_border = calloc(n, sizeof *on_border);
    int32_t(*adjacent)[3] = calloc((size_t)mesh->n_triangles, sizeof *adjacent);
    double *distance_mm = calloc(n, sizeof *distance_mm);
    int error = on_border && adjacent && distance_mm ? iso_mesh_adjacency(mesh, adjacent) : -ENOMEM;
    if (!error) {
        iso_mesh_boundary(mesh, (const int32_t(*)[3])adjacent, on_border);
    }
    for (size_t v = 0; !error && v < n; v++) {
        distance_mm[v] = reach_mm;
        for (size_t b = 0; b < n; b++) {
            if (on_border[b]) {
                struct iso_vec3 apart = iso_sub(mesh->vertices_mm[v], mesh->vertices_mm[b]);
                distance_mm[v] = fmin(distance_mm[v], hypot(apart.x, apart.y));
            }
        }
    }
    if (!error) {
        error = smooth_over(mesh, 20, distance_mm);
    }
    for (size_t v = 0; !error && v < n; v++) {
        opacity[v] = (float)((distance_mm[v] - clear_mm) / (opaque_mm - clear_mm));
    }
    free(on_border);
    free(adjacent);
    free(distance_mm);
    return error;
}

static int new_scene(const struct sim_face *face, struct sim_face_angle angle, int width_px,
                     int height_px, struct sim_canvas **canvas, struct sim_scene **scene)
{
    struct sim_view view = view_of(face->mesh, angle);
    const int error = sim_canvas_new(width_px, height_px, sim_colour_hex(0x2b303a),
                                     sim_colour_hex(0x14161b), canvas);
    if (error) {
        return error;
    }
    return sim_scene_new(face->mesh, &view, *canvas, scene);
}

static int write_picture(int error, const struct sim_canvas *canvas, const char *path,
                         struct iso_fault *fault)
{
    return error ? iso_fault_set(fault, error, "%s: %s", path, strerror(-error))
                 : sim_png_file_write(sim_canvas_surface(canvas), path, fault);
}

int sim_picture_mesh(const struct sim_face *face, struct sim_face_angle angle, const char *path,
                     struct iso_fault *fault)
{
    struct sim_canvas *canvas = NULL;
    struct sim_scene *scene = NULL;
    const struct sim_surface_style style = {.base = sim_colour_hex(0xb9c6d6), .edges = true};
    int error = new_scene(face, angle, 900, 900, &canvas, &scene);
    if (!error) {
        error = sim_scene_shade(scene, &style);
    }
    error = write_picture(error, canvas, path, fault);
    sim_scene_free(scene);
    sim_canvas_free(canvas);
    return error;
}

static void draw_isotherms(const struct sim_face *face, const struct sim_scene *scene)
{
    const struct iso_template *t = face->tmpl;
    for (int r = 0; r < t->n_radii; r++) {
        for (int l = 0; l < ISO_LANDMARKS; l++) {
            struct iso_vec3 points_mm[ISO_TEMPLATE_POINTS_MAX];
            for (int i = 0; i < t->n_points; i++) {
                const float *p = t->points_mm[r][l][i];
                points_mm[i] = iso_vec3((double)p[0], (double)p[1], (double)p[2]);
            }
            sim_scene_curve(scene, points_mm, t->weight[r][l], t->n_points, sim_colour_landmark(l),
                            3.2);
        }
    }
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        sim_scene_dot(scene, face->landmark_mm[l], sim_colour_landmark(l), 3.8);
    }
}

int sim_picture_isotherms(const struct sim_face *face, struct sim_face_angle angle,
                          const char *path, struct iso_fault *fault)
{
    struct sim_canvas *canvas = NULL;
    struct sim_scene *scene = NULL;
    float *opacity = calloc((size_t)face->mesh->n_vertices, sizeof *opacity);
    const struct sim_surface_style style = {.base = sim_colour_hex(0xc9c4bd), .opacity = opacity};
    int error = opacity ? trim_border(face->mesh, opacity) : -ENOMEM;
    if (!error) {
        error = new_scene(face, angle, 900, 700, &canvas, &scene);
    }
    if (!error) {
        error = sim_scene_shade(scene, &style);
    }
    if (!error) {
        draw_isotherms(face, scene);
    }
    error = write_picture(error, canvas, path, fault);
    free(opacity);
    sim_scene_free(scene);
    sim_canvas_free(canvas);
    return error;
}

/* Colours of heat over grey, on a logarithmic scale of four decades down from the hottest point.
 * Heat falls off like a Gaussian, which would be a single bright spot on a linear scale. */
static void heat_colours(const double *heat, int32_t n, struct sim_colour *out)
{
    const double decades = 4.0;
    const struct sim_colour cold = sim_colour_hex(0x8d939c);
    double hottest = 0.0;
    for (int32_t v = 0; v < n; v++) {
        hottest = fmax(hottest, heat[v]);
    }
    for (int32_t v = 0; v < n; v++) {
        const double share = 1.0 + log10(fmax(heat[v] / hottest, 1e-12)) / decades;
        const float opaque = (float)fmin(fmax(4.0 * share, 0.0), 1.0);
        out[v] = sim_colour_mix(cold, sim_colour_heat(share), opaque);
    }
}

enum { PANEL_COLUMNS = 4, PANEL_WIDTH_PX = 280, PANEL_HEIGHT_PX = 300 };

/* Draws one panel of the heat picture at its place. */
static int draw_heat_panel(cairo_t *cr, const struct sim_face *face, struct sim_face_angle angle,
                           int landmark, struct sim_colour *colours)
{
    struct sim_canvas *canvas = NULL;
    struct sim_scene *scene = NULL;
    heat_colours(face->heat[landmark], face->mesh->n_vertices, colours);
    const struct sim_surface_style style = {.vertex = colours};
    int error = new_scene(face, angle, PANEL_WIDTH_PX, PANEL_HEIGHT_PX, &canvas, &scene);
    if (!error) {
        error = sim_scene_shade(scene, &style);
    }
    if (!error) {
        const int x = landmark % PANEL_COLUMNS * PANEL_WIDTH_PX;
        const int y = landmark / PANEL_COLUMNS * PANEL_HEIGHT_PX;
        cairo_surface_t *surface = sim_canvas_surface(canvas);
        cairo_set_source_surface(cr, surface, x, y);
        cairo_paint(cr);
        cairo_surface_destroy(surface);
        cairo_set_source_rgb(cr, 0.86, 0.88, 0.91);
        sim_picture_text(cr, iso_landmark_name((enum iso_landmark)landmark),
                         x + 0.5 * PANEL_WIDTH_PX, y + PANEL_HEIGHT_PX - 10.0, 0.5);
    }
    sim_scene_free(scene);
    sim_canvas_free(canvas);
    return error;
}

int sim_picture_heat(const struct sim_face *face, struct sim_face_angle angle, const char *path,
                     struct iso_fault *fault)
{
    struct sim_colour *colours = calloc((size_t)face->mesh->n_vertices, sizeof *colours);
    if (!colours) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", path);
    }
    cairo_surface_t *surface = cairo_image_surface_create(
        CAIRO_FORMAT_RGB24, PANEL_COLUMNS * PANEL_WIDTH_PX,
        ISO_LANDMARKS / PANEL_COLUMNS * PANEL_HEIGHT_PX);
    cairo_t *cr = cairo_create(surface);
    cairo_select_font_face(cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(cr, 14.0);
    int error = 0;
    for (int l = 0; !error && l < ISO_LANDMARKS; l++) {
        error = draw_heat_panel(cr, face, angle, l, colours);
    }
    cairo_destroy(cr);
    free(colours);
    if (error) {
        cairo_surface_destroy(surface);
        return iso_fault_set(fault, error, "%s: %s", path, strerror(-error));
    }
    return sim_png_file_write(surface, path, fault);
}
