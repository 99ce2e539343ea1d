#include "sim/shapes/match/match.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/base/path.h"
#include "isotherm/correspondence.h"
#include "sim/base/make_directory.h"
#include "sim/lab/report/json.h"
#include "sim/shapes/describe/array.h"
#include "sim/shapes/describe/source.h"
#include "sim/shapes/match/match_picture.h"
#include "sim/shapes/match/truth.h"

struct side {
    const char *path;
    struct sim_source_look look;
    struct iso_shape *shape;
    float *rest; /* [n_vertices][3], or NULL */
};

struct work {
    const struct sim_match_options *options;
    struct side from, to;
    int32_t k_first, k_last;
    int32_t *point; /* [vertices of `to`] */
    double *map;    /* [k_last][k_last] */
    bool known;     /* whether there are errors */
    struct sim_match_error error, mirrored;
};

static int open_side(const struct sim_match_options *options, struct side *side,
                     struct iso_fault *fault)
{
    const struct sim_source_options how = {
        .vertices = options->vertices, .mend = options->mend, .neighbours = options->neighbours};
    struct iso_coloured_mesh mesh = {NULL, NULL};
    int error = sim_source_read(side->path, side->path, &how, &side->look, &mesh, fault);
    if (!error) {
        const struct sim_shape_options shape_options = {
            .neighbours = options->neighbours, .mend = options->mend, .n_pairs = options->pairs};
        error = sim_source_shape(side->path, &mesh, &shape_options, &side->shape, fault);
    }
    iso_coloured_mesh_done(&mesh);
    if (!error) {
        sim_source_look_at_shape(&side->look, side->shape);
        error = sim_rest_read(side->path, side->shape->mesh->n_vertices, &side->rest, fault);
    }
    return error;
}

static int find_points(struct work *work)
{
    const struct iso_shape *from = work->from.shape, *to = work->to.shape;
    const struct sim_match_options *options = work->options;
    const size_t k = (size_t)work->k_last;
    const struct iso_match_options how = {options->first_pairs, options->step, options->weight};
    work->point = calloc((size_t)to->mesh->n_vertices, sizeof *work->point);
    work->map = calloc(k * k, sizeof *work->map);
    return work->point && work->map ? iso_shape_match(from, to, &how, work->point, work->map)
                                    : -ENOMEM;
}

static int measure(struct work *work)
{
    const struct side *from = &work->from, *to = &work->to;
    work->known = from->rest && to->rest;
    if (!work->known) {
        return 0;
    }
    const int error = sim_rest_measure(from->shape, from->rest, to->shape, to->rest, work->point,
                                       false, &work->error);
    return error ? error
                 : sim_rest_measure(from->shape, from->rest, to->shape, to->rest, work->point, true,
                                    &work->mirrored);
}

static int add_mesh(struct sim_arrays *arrays, const char *prefix, const struct iso_mesh *mesh)
{
    struct sim_array vertices = {
        .meaning = "x, y, z", .rows = mesh->n_vertices, .columns = 3, .data = mesh->vertices_mm};
    struct sim_array triangles = {.meaning = "three vertices each",
                                  .type = SIM_ARRAY_INT,
                                  .rows = mesh->n_triangles,
                                  .columns = 3,
                                  .data = mesh->triangles};
    (void)snprintf(vertices.name, sizeof vertices.name, "%s_vertices", prefix);
    (void)snprintf(triangles.name, sizeof triangles.name, "%s_triangles", prefix);
    const int error = sim_arrays_add(arrays, &vertices);
    return error ? error : sim_arrays_add(arrays, &triangles);
}

static int write_arrays(const struct work *work, struct iso_fault *fault)
{
    const struct sim_array point = {.name = "point",
                                    .meaning = "vertex of the first shape",
                                    .type = SIM_ARRAY_INT,
                                    .rows = work->to.shape->mesh->n_vertices,
                                    .data = work->point};
    const struct sim_array map = {.name = "map",
                                  .meaning = "coefficients on the second shape of each "
                                             "eigenfunction of the first one, in columns",
                                  .rows = work->k_last,
                                  .columns = work->k_last,
                                  .data = work->map};
    struct sim_arrays *arrays = calloc(1, sizeof *arrays);
    int error = arrays ? sim_arrays_add(arrays, &point) : -ENOMEM;
    if (!error) {
        error = sim_arrays_add(arrays, &map);
    }
    if (!error) {
        error = add_mesh(arrays, "from", work->from.shape->mesh);
    }
    if (!error) {
        error = add_mesh(arrays, "to", work->to.shape->mesh);
    }
    error = error ? iso_fault_set(fault, error, "%s: %s", work->options->out, strerror(-error))
                  : sim_arrays_write(arrays, SIM_ARRAY_NPY, work->options->out, fault);
    free(arrays);
    return error;
}

static json_t *error_json(bool known, const struct sim_match_error *e)
{
    return !known ? json_null()
                  : json_pack("{s:i, s:f, s:f, s:f, s:f}", "points", e->n, "mean", e->mean,
                              "within_0.05", e->within[0], "within_0.1", e->within[1],
                              "within_0.25", e->within[2]);
}

/* What a cloud is made of; null for a mesh. */
static json_t *cloud_json(const struct sim_match_options *options, const struct side *side)
{
    const int neighbours = options->neighbours ? options->neighbours : ISO_CLOUD_NEIGHBOURS;
    return !side->shape->is_cloud
               ? json_null()
               : json_pack("{s:i, s:i, s:i}", "points", side->look.points, "points_left_out",
                           side->look.points_left_out, "neighbours", neighbours);
}

static int write_files(const struct work *work, struct iso_fault *fault)
{
    const struct sim_match_options *o = work->options;
    char json[PATH_MAX], png[PATH_MAX];
    int error = sim_make_directory(o->out, fault);
    if (!error) {
        error = write_arrays(work, fault);
    }
    if (!error) {
        error = iso_path_join(o->out, "match.json", json, fault);
    }
    if (!error) {
        error = iso_path_join(o->out, "match.png", png, fault);
    }
    if (!error) {
        error = sim_json_file(
            json_pack("{s:s, s:s, s:s, s:o, s:o, s:i, s:i, s:i, s:f, s:i, s:o, s:o}", "version",
                      ISOTHERM_VERSION, "from", work->from.path, "to", work->to.path, "from_cloud",
                      cloud_json(o, &work->from), "to_cloud", cloud_json(o, &work->to),
                      "first_pairs", work->k_first, "pairs", work->k_last, "step", o->step,
                      "weight", o->weight, "functions", (int)ISO_MATCH_FUNCTIONS, "error",
                      error_json(work->known, &work->error), "error_mirrored",
                      error_json(work->known, &work->mirrored)),
            json, fault);
    }
    return error ? error
                 : sim_match_picture(work->from.shape, work->to.shape, work->point, png, fault);
}

static void report_side(const struct side *side, FILE *out)
{
    char left_out[256];
    sim_source_left_out(&side->look, left_out, sizeof left_out);
    if (left_out[0]) {
        fprintf(out, "%s: %s\n", side->path, left_out);
    }
}

static void report(const struct work *work, FILE *out)
{
    report_side(&work->from, out);
    report_side(&work->to, out);
    fprintf(out, "%s to %s: %d %s, %d pairs\n", work->from.path, work->to.path,
            work->to.shape->mesh->n_vertices, work->to.shape->is_cloud ? "points" : "vertices",
            work->k_last);
    if (work->known) {
        const bool turned = work->mirrored.mean < work->error.mean;
        const struct sim_match_error *best = turned ? &work->mirrored : &work->error;
        fprintf(out,
                "mean geodesic error %.4f of the root of the area%s; within 0.05: %.1f %%, 0.1: "
                "%.1f %%, 0.25: %.1f %% of %d points; with %s: %.4f\n",
                best->mean, turned ? ", left and right exchanged" : "", 100.0 * best->within[0],
                100.0 * best->within[1], 100.0 * best->within[2], best->n,
                turned ? "left and right as they are" : "left and right exchanged",
                turned ? work->error.mean : work->mirrored.mean);
    }
}

static int run(struct work *work, FILE *out, struct iso_fault *fault)
{
    const struct sim_match_options *options = work->options;
    int error = open_side(options, &work->from, fault);
    if (!error) {
        error = open_side(options, &work->to, fault);
    }
    if (error) {
        return error;
    }
    const int32_t a = work->from.shape->pairs->k, b = work->to.shape->pairs->k;
    work->k_last = a < b ? a : b;
    work->k_first = options->first_pairs < work->k_last ? options->first_pairs : work->k_last;
    error = find_points(work);
    if (!error) {
        error = measure(work);
    }
    if (error) {
        return iso_fault_set(fault, error, "%s to %s: %s", work->from.path, work->to.path,
                             strerror(-error));
    }
    report(work, out);
    return write_files(work, fault);
}

static void close_side(struct side *side)
{
    iso_shape_free(side->shape);
    free(side->rest);
}

int sim_shapes_match(const struct sim_match_options *options, FILE *out, struct iso_fault *fault)
{
    if (options->meshes.n != 2) {
        return iso_fault_set(fault, -EINVAL, "two meshes are needed, %zu are given",
                             options->meshes.n);
    }
    if (options->first_pairs < 2 || options->step < 1 || !(options->weight > 0.0)) {
        return iso_fault_set(fault, -EINVAL,
                             "--first-pairs below 2, --step below 1 or --weight not above 0");
    }
    const int wrong = sim_neighbours_check(options->neighbours, fault);
    if (wrong) {
        return wrong;
    }
    struct work work = {.options = options,
                        .from = {.path = options->meshes.text[0]},
                        .to = {.path = options->meshes.text[1]}};
    const int error = run(&work, out, fault);
    close_side(&work.from);
    close_side(&work.to);
    free(work.point);
    free(work.map);
    return error;
}
