#include "sim/shapes/describe/quantity.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "isotherm/signature.h"

enum { NUMBERS_MAX = 10000 };

static const double mean_time = SIM_QUANTITY_MEAN_TIME;

int sim_quantity_add(struct sim_arrays *arrays, const char *name, const char *meaning, double *data,
                     int32_t rows, int32_t columns)
{
    struct sim_array array = {
        .meaning = meaning, .rows = rows, .columns = columns, .data = data, .owned = data};
    (void)snprintf(array.name, sizeof array.name, "%s", name);
    return sim_arrays_add(arrays, &array);
}

int sim_quantity_mesh(const struct iso_shape *shape, struct sim_arrays *arrays)
{
    const struct iso_mesh *mesh = shape->mesh;
    const struct sim_array vertices = {.name = "vertices",
                                       .meaning = "x, y, z of each vertex of the shape",
                                       .rows = mesh->n_vertices,
                                       .columns = 3,
                                       .data = mesh->vertices_mm};
    const struct sim_array triangles = {.name = "triangles",
                                        .meaning = "three vertices each, counted from 0",
                                        .type = SIM_ARRAY_INT,
                                        .rows = mesh->n_triangles,
                                        .columns = 3,
                                        .data = mesh->triangles};
    const struct sim_array area = {.name = "area",
                                   .meaning = "of each vertex: a third of the triangles around it",
                                   .rows = mesh->n_vertices,
                                   .data = shape->area};
    int error = sim_arrays_add(arrays, &vertices);
    if (!error) {
        error = sim_arrays_add(arrays, &triangles);
    }
    return error ? error : sim_arrays_add(arrays, &area);
}

static int add_eigen(const struct iso_shape *shape, const struct sim_quantity_options *options,
                     struct sim_arrays *arrays)
{
    const struct iso_eigenpairs *pairs = shape->pairs;
    const struct sim_array lambda = {.name = "lambda",
                                     .meaning = "eigenvalues, rising from the trivial one",
                                     .rows = pairs->k,
                                     .data = pairs->lambda};
    const struct sim_array phi = {.name = "phi",
                                  .meaning = "eigenvectors in columns, phi' mass phi = 1",
                                  .rows = pairs->n,
                                  .columns = pairs->k,
                                  .data = pairs->phi,
                                  .row_step = 1,
                                  .column_step = (size_t)pairs->n};
    (void)options;
    const int error = sim_arrays_add(arrays, &lambda);
    return error ? error : sim_arrays_add(arrays, &phi);
}

/* A symmetric matrix as its lower triangle: row, column and value of each entry. */
static int add_matrix(const struct iso_symmetric *matrix, const char *name,
                      struct sim_arrays *arrays)
{
    int32_t *column = malloc((size_t)matrix->nnz * sizeof *column);
    if (!column) {
        return -ENOMEM;
    }
    for (int32_t j = 0; j < matrix->n; j++) {
        for (int32_t at = matrix->column_start[j]; at < matrix->column_start[j + 1]; at++) {
            column[at] = j;
        }
    }
    struct sim_array rows = {.meaning = "row of each entry of the lower triangle, from 0",
                             .type = SIM_ARRAY_INT,
                             .rows = matrix->nnz,
                             .data = matrix->row};
    struct sim_array columns = {.meaning = "column of each entry, from 0",
                                .type = SIM_ARRAY_INT,
                                .rows = matrix->nnz,
                                .data = column,
                                .owned = column};
    struct sim_array values = {.meaning = "value of each entry; the matrix is symmetric",
                               .rows = matrix->nnz,
                               .data = matrix->value};
    (void)snprintf(rows.name, sizeof rows.name, "%s_row", name);
    (void)snprintf(columns.name, sizeof columns.name, "%s_column", name);
    (void)snprintf(values.name, sizeof values.name, "%s_value", name);
    int error = sim_arrays_add(arrays, &columns);
    if (!error) {
        error = sim_arrays_add(arrays, &rows);
    }
    return error ? error : sim_arrays_add(arrays, &values);
}

static int add_mass(const struct iso_shape *shape, const struct sim_quantity_options *options,
                    struct sim_arrays *arrays)
{
    (void)options;
    return add_matrix(shape->mass, "mass", arrays);
}

static int add_stiffness(const struct iso_shape *shape, const struct sim_quantity_options *options,
                         struct sim_arrays *arrays)
{
    (void)options;
    return add_matrix(shape->stiffness, "stiffness", arrays);
}

static int add_hks(const struct iso_shape *shape, const struct sim_quantity_options *options,
                   struct sim_arrays *arrays)
{
    const struct iso_eigenpairs *pairs = shape->pairs;
    const int n = options->times ? options->times : SIM_QUANTITY_TIMES;
    const double first = options->time_first > 0.0 ? options->time_first
                                                   : 4.0 * log(10.0) / pairs->lambda[pairs->k - 1];
    const double last = options->time_last > 0.0 ? options->time_last
                                                 : 4.0 * log(10.0) / pairs->lambda[1];
    if (n < 1 || n > NUMBERS_MAX || !(first > 0.0 && last >= first && isfinite(last))) {
        return -EINVAL;
    }
    double *t = malloc((size_t)n * sizeof *t);
    double *hks = malloc((size_t)pairs->n * (size_t)n * sizeof *hks);
    int error = t && hks ? 0 : -ENOMEM;
    if (!error) {
        iso_heat_times(first, last, n, t);
        error = iso_heat_signature(pairs, 0, t, n, hks);
    }
    if (error) {
        free(t);
        free(hks);
        return error;
    }
    error = sim_quantity_add(arrays, "hks", "heat kernel signature: a row of times for each vertex",
                             hks, pairs->n, n);
    const int other = sim_quantity_add(arrays, "hks_time",
                                       "the times, in the square of the mesh's unit", t, n, 0);
    return error ? error : other;
}

static int add_wks(const struct iso_shape *shape, const struct sim_quantity_options *options,
                   struct sim_arrays *arrays)
{
    const struct iso_eigenpairs *pairs = shape->pairs;
    const int n = options->energies ? options->energies : SIM_QUANTITY_ENERGIES;
    if (n < 2 || n > NUMBERS_MAX) {
        return -EINVAL;
    }
    double spread = 0.0;
    double *energy = malloc((size_t)n * sizeof *energy);
    double *wks = malloc((size_t)pairs->n * (size_t)n * sizeof *wks);
    int error = energy && wks ? iso_wave_energies(pairs, n, energy, &spread) : -ENOMEM;
    if (!error) {
        error = iso_wave_signature(pairs, energy, n, spread, wks);
    }
    if (error) {
        free(energy);
        free(wks);
        return error;
    }
    error = sim_quantity_add(arrays, "wks",
                             "wave kernel signature: a row of energies for each vertex", wks,
                             pairs->n, n);
    const int other = sim_quantity_add(arrays, "wks_energy",
                                       "logarithms of eigenvalues; their spread is seven steps",
                                       energy, n, 0);
    return error ? error : other;
}

static int add_si_hks(const struct iso_shape *shape, const struct sim_quantity_options *options,
                      struct sim_arrays *arrays)
{
    struct iso_shape_description *d = NULL;
    int error = iso_shape_describe(iso_shape_method_find("shape-google"), shape, &d);
    (void)options;
    if (!error) {
        const struct sim_array array = {
            .name = "si_hks",
            .meaning = "scale-invariant HKS: amplitudes of six frequencies for each vertex",
            .type = SIM_ARRAY_FLOAT,
            .rows = d->n_points,
            .columns = d->n_values,
            .data = d->local,
            .owned = d->local,
        };
        d->local = NULL;
        error = sim_arrays_add(arrays, &array);
    }
    iso_shape_description_free(d);
    return error;
}

static int add_hms(const struct iso_shape *shape, const struct sim_quantity_options *options,
                   struct sim_arrays *arrays)
{
    double *hms = malloc((size_t)shape->mesh->n_vertices * sizeof *hms);
    const int error = hms ? iso_heat_mean_signature(shape->pairs, mean_time * shape->total_area,
                                                    hms)
                          : -ENOMEM;
    (void)options;
    if (error) {
        free(hms);
        return error;
    }
    return sim_quantity_add(arrays, "hms", "heat mean signature at a 64th of the area", hms,
                            shape->mesh->n_vertices, 0);
}

static int add_critical(const struct iso_shape *shape, const struct sim_quantity_options *options,
                        struct sim_arrays *arrays)
{
    struct iso_critical_points points = {0};
    const int error = iso_shape_critical_points(shape, &points);
    (void)options;
    if (error) {
        return error;
    }
    const struct sim_array array = {
        .name = "critical",
        .meaning = "critical points: vertices from 0, by falling |phi_1|",
        .type = SIM_ARRAY_INT,
        .rows = points.n,
        .data = points.vertex,
        .owned = points.vertex,
    };
    return sim_arrays_add(arrays, &array);
}

static int add_heat(const struct iso_shape *shape, const struct sim_quantity_options *options,
                    struct sim_arrays *arrays)
{
    enum { TIMES = 4 };
    const struct iso_eigenpairs *pairs = shape->pairs;
    if (options->heat_source < 0 || options->heat_source >= pairs->n) {
        return -ERANGE;
    }
    double *t = malloc(TIMES * sizeof *t);
    double *heat = malloc((size_t)pairs->n * TIMES * sizeof *heat);
    int error = t && heat ? 0 : -ENOMEM;
    if (!error) { /* each time is four times the one before; the third one is that of hms */
        iso_heat_times(mean_time / 16.0 * shape->total_area, 4.0 * mean_time * shape->total_area,
                       TIMES, t);
        error = iso_heat_from_vertex(pairs, options->heat_source, 0, t, TIMES, heat);
    }
    if (error) {
        free(t);
        free(heat);
        return error;
    }
    error = sim_quantity_add(arrays, "heat", "heat from one vertex: a row of times for each vertex",
                             heat, pairs->n, TIMES);
    const int other = sim_quantity_add(arrays, "heat_time",
                                       "the times, in the square of the mesh's unit", t, TIMES, 0);
    return error ? error : other;
}

const struct sim_quantity sim_quantities[] = {
    {"eigen", "lambda (pairs), phi (vertices x pairs)", add_eigen},
    {"mass", "mass_row, mass_column, mass_value: the lower triangle", add_mass},
    {"stiffness", "stiffness_row, stiffness_column, stiffness_value", add_stiffness},
    {"hks", "hks (vertices x times), hks_time: heat kernel signature", add_hks},
    {"si-hks", "si_hks (vertices x 6): the same without scale", add_si_hks},
    {"wks", "wks (vertices x energies), wks_energy: wave kernel signature", add_wks},
    {"hms", "hms (vertices): heat mean signature", add_hms},
    {"segments", "segment (vertices), peak, peak_persistence: parts by peaks of heat",
     sim_quantity_segments},
    {"heat", "heat (vertices x 4), heat_time: heat from the vertex --source", add_heat},
    {"views", "view (views x 3), view_entropy, view_divergence: the best views",
     sim_quantity_views},
    {"critical", "critical: extrema of the first eigenfunction", add_critical},
    {NULL, NULL, NULL},
};

const struct sim_quantity *sim_quantity_find(const char *name)
{
    for (const struct sim_quantity *q = sim_quantities; q->name; q++) {
        if (strcmp(q->name, name) == 0) {
            return q;
        }
    }
    return NULL;
}

/* The method's name with underscores. */
static void array_name(const struct iso_shape_method *method, const char *suffix,
                       char name[SIM_ARRAY_NAME_MAX])
{
    (void)snprintf(name, SIM_ARRAY_NAME_MAX, "%s%s", method->name, suffix);
    for (char *c = name; *c; c++) {
        *c = *c == '-' ? '_' : *c;
    }
}

int sim_quantity_method(const struct iso_shape *shape, const struct iso_shape_method *method,
                        struct sim_arrays *arrays)
{
    struct iso_shape_description *d = NULL;
    int error = iso_shape_describe(method, shape, &d);
    if (error) {
        return error;
    }
    struct sim_array whole = {.meaning = method->source, .type = SIM_ARRAY_FLOAT, .data = d->whole};
    for (int32_t p = 0; p < d->n_parts; p++) {
        whole.rows += d->part_size[p];
    }
    if (whole.rows > 0) {
        array_name(method, "", whole.name);
        whole.owned = d->whole;
        d->whole = NULL;
        error = sim_arrays_add(arrays, &whole);
    }
    float *bags = d->local;
    for (int32_t b = 0; b < d->n_bags && !error; b++) {
        char suffix[24] = "_local";
        if (d->n_bags > 1) {
            (void)snprintf(suffix, sizeof suffix, "_local_%d", b);
        }
        struct sim_array local = {.meaning = "values of each vertex, of one channel if numbered",
                                  .type = SIM_ARRAY_FLOAT,
                                  .rows = d->n_points,
                                  .columns = d->n_values};
        const size_t items = (size_t)d->n_points * (size_t)d->n_values;
        array_name(method, suffix, local.name);
        local.data = &bags[(size_t)b * items];
        if (b == 0) { /* the array of the first bag owns all of them */
            local.owned = bags;
            d->local = NULL;
        }
        error = sim_arrays_add(arrays, &local);
    }
    iso_shape_description_free(d);
    return error;
}
