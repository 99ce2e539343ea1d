#include "sim/shapes/make/generate.h"

#include <errno.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/base/path.h"
#include "sim/base/make_directory.h"
#include "sim/lab/match/parallel.h"
#include "sim/shapes/make/creature.h"
#include "sim/shapes/make/distort.h"
#include "sim/shapes/make/manifest.h"
#include "sim/shapes/make/species.h"
#include "sim/shapes/make/texture.h"
#include "sim/shapes/mesh/mesh_writer.h"
#include "sim/world/face/npy_writer.h"

enum {
    COATS_EACH = 3,
    BODIES_EACH = 2,
    TRANSFORMATIONS = 4,
    TEXTURED_EACH = COATS_EACH * BODIES_EACH * TRANSFORMATIONS,
    SHAPES_MAX = 100000,
    VERTICES_MIN = 200,
    VERTICES_MAX = 200000,
    CLASS_NAME_MAX = 40,
};

/* Amount of variation of a body from its species: of a class beyond the species themselves, and of
 * each of the two bodies of a textured class. */
static const double other_class = 0.5, other_body = 0.12;

/* One shape to make. */
struct shape_plan {
    struct sim_shape_row row;
    int species;
    struct sim_growth growth;
    double pose;
    uint64_t pose_key; /* the same key gives the same pose */
    bool coated, distorted;
    enum sim_texture coat;
    struct sim_distortion distortion;
};

struct shape_maker {
    const struct sim_shapes_options *options;
    struct shape_plan *plan;
    int32_t n;
    pthread_mutex_t fault_lock;
    struct iso_fault *fault; /* of the shape that failed first */
};

/* ---- the plan of shapes ------------------------------------------------------------ */

/* "horse", "horse2", ... */
static void class_name(size_t number, char *out, size_t size)
{
    const char *species = sim_species[number % SIM_SPECIES].name;
    const size_t variant = number / SIM_SPECIES;
    if (variant == 0) {
        (void)snprintf(out, size, "%s", species);
    } else {
        (void)snprintf(out, size, "%s%zu", species, variant + 1);
    }
}

static void plan_plain(const struct sim_shapes_options *options, struct shape_maker *maker)
{
    for (int32_t i = 0; i < maker->n; i++) {
        const size_t c = (size_t)i % options->classes, pose = (size_t)i / options->classes;
        struct shape_plan *plan = &maker->plan[i];
        char class_text[CLASS_NAME_MAX];
        class_name(c, class_text, sizeof class_text);
        (void)snprintf(plan->row.class_name, sizeof plan->row.class_name, "%s", class_text);
        (void)snprintf(plan->row.file, sizeof plan->row.file, "%s-%02zu.%s", class_text, pose + 1,
                       options->format);
        plan->species = (int)(c % SIM_SPECIES);
        plan->growth = (struct sim_growth){options->seed * 1000 + c,
                                           c < SIM_SPECIES ? 0.0 : other_class};
        plan->pose = 1.0;
        plan->pose_key = (uint64_t)i;
    }
}

/* The transformations of section 5.4, at a strength of 1..3. */
static void plan_transformation(struct shape_plan *plan, int kind, int level)
{
    static const enum sim_distortion_kind kinds[TRANSFORMATIONS] = {
        [1] = SIM_DISTORTION_STRETCH, [2] = SIM_DISTORTION_BULGE, [3] = SIM_DISTORTION_WHITE};
    if (kind == 0) {
        plan->pose = 0.4 + 0.2 * level;
        plan->pose_key += 1000; /* another pose than the null shape's */
    } else {
        plan->distorted = true;
        plan->distortion = (struct sim_distortion){kinds[kind], level};
    }
}

static void plan_textured(const struct sim_shapes_options *options, struct shape_maker *maker)
{
    static const char *const names[TRANSFORMATIONS] = {"pose", "stretch", "bulge", "noise"};
    for (int32_t i = 0; i < maker->n; i++) {
        const size_t c = (size_t)i / TEXTURED_EACH;
        const int within = i % TEXTURED_EACH, kind = within % TRANSFORMATIONS;
        const int coat = within / TRANSFORMATIONS % COATS_EACH;
        const int body = within / TRANSFORMATIONS / COATS_EACH;
        const int level = 1 + (coat + body + kind + (int)c) % SIM_DISTORTION_LEVELS;
        struct shape_plan *plan = &maker->plan[i];
        char class_text[CLASS_NAME_MAX];
        class_name(c, class_text, sizeof class_text);
        plan->coat = (enum sim_texture)((c + (size_t)coat) % SIM_TEXTURES);
        plan->coated = true;
        (void)snprintf(plan->row.class_name, sizeof plan->row.class_name, "%s/%s", class_text,
                       sim_texture_name(plan->coat));
        (void)snprintf(plan->row.file, sizeof plan->row.file, "%s-%c-%s-%s%d.%s", class_text,
                       'a' + body, sim_texture_name(plan->coat), names[kind], level,
                       options->format);
        plan->species = (int)(c % SIM_SPECIES);
        plan->growth = (struct sim_growth){options->seed * 1000 + 2 * c + (size_t)body,
                                           c < SIM_SPECIES ? other_body : other_class};
        plan->pose = 0.3;
        plan->pose_key = 2 * c + (size_t)body;
        plan_transformation(plan, kind, level);
    }
}

/* ---- making it --------------------------------------------------------------------- */

static int paint_creature(const struct shape_plan *plan, const struct sim_creature *creature,
                          uint64_t key, struct iso_colour **out)
{
    struct iso_colour *colour = calloc((size_t)creature->mesh->n_vertices, sizeof *colour);
    if (!colour) {
        return -ENOMEM;
    }
    for (int32_t v = 0; v < creature->mesh->n_vertices; v++) {
        colour[v] = sim_texture_colour(plan->coat, key, creature->rest_mm[v]);
    }
    *out = colour;
    return 0;
}

/* *rest receives the places at rest of all vertices; free it with free(). */
static int make_shape(const struct shape_maker *maker, size_t number, struct iso_coloured_mesh *out,
                      struct iso_vec3 **rest)
{
    const struct shape_plan *plan = &maker->plan[number];
    const struct sim_species *species = &sim_species[plan->species];
    const uint64_t seed = maker->options->seed;
    struct sim_random grid = sim_random_seeded(seed, 0x67726964, number);
    struct sim_random pose = sim_random_seeded(seed, 0x706f7365, plan->pose_key);
    const struct sim_creature_options options = {(int32_t)maker->options->vertices, plan->pose};
    struct sim_skeleton skeleton;
    struct sim_creature *creature = NULL;
    sim_skeleton_grow(species->limbs, species->n_limbs, &plan->growth, &skeleton);
    int error = sim_creature_new(&skeleton, &options, &grid, &pose, &creature);
    if (error) {
        return error;
    }
    struct iso_coloured_mesh made = {NULL, NULL};
    if (plan->coated) {
        error = paint_creature(plan, creature, seed, &made.colour);
    }
    struct iso_vec3 *rest_mm = creature->rest_mm;
    made.mesh = creature->mesh;
    creature->mesh = NULL;
    creature->rest_mm = NULL;
    sim_creature_free(creature);
    if (!error && plan->distorted) {
        error = sim_distort(plan->distortion, &grid, &made);
    }
    if (error) {
        iso_coloured_mesh_done(&made);
        free(rest_mm);
        return error;
    }
    *out = made;
    *rest = rest_mm;
    return 0;
}

/* rest/NAME.npy for NAME.off. */
static int write_rest(const char *directory, const char *file, const struct iso_vec3 *rest,
                      int32_t n, struct iso_fault *fault)
{
    const struct sim_npy_shape shape = {.n_dimensions = 2, .size = {(uint32_t)n, 3}};
    char name[SIM_SHAPE_NAME_MAX + 16], path[PATH_MAX];
    struct sim_npy_writer *writer = NULL;
    (void)snprintf(name, sizeof name, "rest/%.*s.npy", (int)strcspn(file, "."), file);
    int error = iso_path_join(directory, name, path, fault);
    if (!error) {
        error = sim_npy_writer_open(path, SIM_NPY_FLOAT, &shape, &writer, fault);
    }
    for (int32_t v = 0; v < n && !error; v++) {
        sim_npy_writer_add(writer, rest[v].x);
        sim_npy_writer_add(writer, rest[v].y);
        sim_npy_writer_add(writer, rest[v].z);
    }
    return error ? error : sim_npy_writer_close(writer, true, fault);
}

static int make_and_write(void *context, int worker, size_t number)
{
    struct shape_maker *maker = context;
    const char *file = maker->plan[number].row.file;
    struct iso_coloured_mesh mesh = {NULL, NULL};
    struct iso_vec3 *rest = NULL;
    struct iso_fault fault = {.text = ""};
    char path[PATH_MAX];
    (void)worker;
    int error = iso_path_join(maker->options->out, file, path, &fault);
    if (!error) {
        error = make_shape(maker, number, &mesh, &rest);
        if (error) {
            (void)iso_fault_set(&fault, error, "%s: %s", file, strerror(-error));
        }
    }
    if (!error) {
        error = sim_mesh_write(path, &mesh, &fault);
    }
    if (!error && maker->options->rest) {
        error = write_rest(maker->options->out, file, rest, mesh.mesh->n_vertices, &fault);
    }
    free(rest);
    iso_coloured_mesh_done(&mesh);
    if (error) {
        (void)pthread_mutex_lock(&maker->fault_lock);
        if (maker->fault && maker->fault->text[0] == '\0') {
            *maker->fault = fault;
        }
        (void)pthread_mutex_unlock(&maker->fault_lock);
    }
    return error;
}

static int write_manifest(const struct shape_maker *maker, struct iso_fault *fault)
{
    struct sim_shape_row *rows = calloc((size_t)maker->n, sizeof *rows);
    if (!rows) {
        return iso_fault_set(fault, -ENOMEM, "out of memory");
    }
    for (int32_t i = 0; i < maker->n; i++) {
        rows[i] = maker->plan[i].row;
    }
    const int error = sim_shape_manifest_write(maker->options->out, rows, maker->n, fault);
    free(rows);
    return error;
}

/* Replaces options that are 0 by their defaults. -EINVAL. */
static int complete_options(struct sim_shapes_options *options, bool *textured,
                            struct iso_fault *fault)
{
    *textured = strcmp(options->preset, "textured") == 0;
    if (!*textured && strcmp(options->preset, "plain") != 0) {
        return iso_fault_set(fault, -EINVAL, "--preset: '%s' is unknown", options->preset);
    }
    if (!options->format) {
        options->format = *textured ? "ply" : "off";
    }
    if (strcmp(options->format, "off") != 0 && strcmp(options->format, "ply") != 0 &&
        (*textured || strcmp(options->format, "vert") != 0)) {
        return iso_fault_set(fault, -EINVAL, "--format: '%s' is none of off, ply%s",
                             options->format, *textured ? "" : ", vert");
    }
    if (!options->classes) {
        options->classes = *textured ? 10 : SIM_SPECIES;
    }
    options->shapes = options->shapes ? options->shapes : 148;
    options->vertices = options->vertices ? options->vertices : 3000;
    if (options->classes > SIM_SHAPES_CLASSES_MAX) {
        return iso_fault_set(fault, -EINVAL, "--classes: more than %d",
                             (int)SIM_SHAPES_CLASSES_MAX);
    }
    if (options->shapes > SHAPES_MAX) {
        return iso_fault_set(fault, -EINVAL, "--shapes: more than %d", (int)SHAPES_MAX);
    }
    if (options->vertices < VERTICES_MIN || options->vertices > VERTICES_MAX) {
        return iso_fault_set(fault, -EINVAL, "--vertices: outside %d..%d", (int)VERTICES_MIN,
                             (int)VERTICES_MAX);
    }
    return 0;
}

int sim_shapes_generate(const struct sim_shapes_options *given, int32_t *n_written,
                        struct iso_fault *fault)
{
    struct sim_shapes_options options = *given;
    bool textured = false;
    int error = complete_options(&options, &textured, fault);
    if (error) {
        return error;
    }
    char rest[PATH_MAX];
    error = sim_make_directory(options.out, fault);
    if (!error && options.rest) {
        error = iso_path_join(options.out, "rest", rest, fault);
        if (!error) {
            error = sim_make_directory(rest, fault);
        }
    }
    if (error) {
        return error;
    }
    struct shape_maker maker = {
        .options = &options,
        .n = (int32_t)(textured ? TEXTURED_EACH * options.classes : options.shapes),
        .fault_lock = PTHREAD_MUTEX_INITIALIZER,
        .fault = fault,
    };
    maker.plan = calloc((size_t)maker.n, sizeof *maker.plan);
    if (!maker.plan) {
        return iso_fault_set(fault, -ENOMEM, "out of memory");
    }
    if (textured) {
        plan_textured(&options, &maker);
    } else {
        plan_plain(&options, &maker);
    }
    error = sim_parallel(options.threads, "making shapes", (size_t)maker.n, make_and_write, &maker);
    if (error && fault && fault->text[0] == '\0') {
        (void)iso_fault_set(fault, error, "--threads: %s", strerror(-error));
    }
    if (!error) {
        error = write_manifest(&maker, fault);
    }
    if (!error) {
        *n_written = maker.n;
    }
    free(maker.plan);
    return error;
}
