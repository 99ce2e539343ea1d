#include "sim/world/face/ict_kit.h"

#include <errno.h>
#include <jansson.h>
#include <limits.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "drivers/base/path.h"
#include "drivers/file/file.h"
#include "sim/world/face/npy_writer.h"
#include "sim/world/face/obj_points.h"

enum { NAME_SIZE = 32, SHAPES_MAX = 1024, INDICES_BYTES_MAX = 1 << 24 };

static const double mm_per_unit = 10.0; /* the files are in centimetres */

static const char neutral_name[] = "generic_neutral_mesh";

/* Shapes that the index file does not name, which some releases of the kit have. */
static const char *const more_expressions[] = {"PupilDilate_L", "PupilDilate_R", "cheekRaiser_L",
                                               "cheekRaiser_R"};

const struct sim_ict_layout sim_ict_kit_layout = {
    .n_vertices = 26719,
    .n_identity = 100,
    .n_landmarks = 68,
    .kept = {{0, 14062}, {21451, 24591}},
};

struct kit {
    const struct sim_ict_layout *layout;
    char folder[PATH_MAX]; /* FaceXModel */
    const char *to;
    char (*expressions)[NAME_SIZE]; /* sorted */
    uint32_t n_expressions;
    uint32_t *landmarks; /* [layout->n_landmarks], of the file */
    struct sim_obj neutral;
    struct iso_fault *fault;
};

static uint32_t n_kept(const struct sim_ict_layout *layout)
{
    uint32_t n = 0;
    for (int r = 0; r < SIM_ICT_KIT_RANGES; r++) {
        n += layout->kept[r].end - layout->kept[r].first;
    }
    return n;
}

/* The index among the vertices that are kept; false for one that is not. */
static bool renumber(const struct sim_ict_layout *layout, uint32_t vertex, uint32_t *out)
{
    uint32_t before = 0;
    for (int r = 0; r < SIM_ICT_KIT_RANGES; r++) {
        if (vertex >= layout->kept[r].first && vertex < layout->kept[r].end) {
            *out = before + vertex - layout->kept[r].first;
            return true;
        }
        before += layout->kept[r].end - layout->kept[r].first;
    }
    return false;
}

/* ---- names ---- */

static int obj_path(const struct kit *kit, const char *name, char path[PATH_MAX])
{
    char file[NAME_SIZE + 8];
    (void)snprintf(file, sizeof file, "%s.obj", name);
    return iso_path_join(kit->folder, file, path, kit->fault);
}

static bool has_obj(const struct kit *kit, const char *name)
{
    char path[PATH_MAX];
    return obj_path(kit, name, path) == 0 && access(path, F_OK) == 0;
}

static void identity_name(uint32_t i, char name[NAME_SIZE])
{
    (void)snprintf(name, NAME_SIZE, "identity%03u", i);
}

/* `from` itself, or the folder of this name in it. */
static int find_folder(struct kit *kit, const char *from)
{
    struct stat status;
    int error = iso_path_join(from, "FaceXModel", kit->folder, kit->fault);
    if (!error && (stat(kit->folder, &status) != 0 || !S_ISDIR(status.st_mode))) {
        (void)snprintf(kit->folder, sizeof kit->folder, "%s", from);
        error = has_obj(kit, neutral_name)
                    ? 0
                    : iso_fault_set(kit->fault, -ENOENT,
                                    "%s: no folder FaceXModel; name a clone of "
                                    "https://github.com/ICT-VGL/ICT-FaceKit",
                                    from);
    }
    return error;
}

static int compare_names(const void *a, const void *b)
{
    return strcmp(a, b);
}

static int add_expression(struct kit *kit, const char *path, const char *name)
{
    const bool plain = name && *name && strlen(name) < NAME_SIZE &&
                       strspn(name, "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_"
                                    "0123456789") == strlen(name);
    if (!plain || kit->n_expressions == SHAPES_MAX) {
        return iso_fault_set(kit->fault, -EBADMSG, "%s: 'expressions' is no list of shapes", path);
    }
    (void)snprintf(kit->expressions[kit->n_expressions++], NAME_SIZE, "%s", name);
    return 0;
}

static int take_expressions(struct kit *kit, const char *path, const json_t *names)
{
    int error = 0;
    kit->expressions = calloc(SHAPES_MAX, sizeof *kit->expressions);
    if (!kit->expressions) {
        return iso_fault_set(kit->fault, -ENOMEM, "%s: out of memory", path);
    }
    if (json_array_size(names) == 0) {
        return iso_fault_set(kit->fault, -EBADMSG, "%s: names no 'expressions'", path);
    }
    for (size_t i = 0; i < json_array_size(names) && !error; i++) {
        error = add_expression(kit, path, json_string_value(json_array_get(names, i)));
    }
    for (size_t i = 0; i < sizeof more_expressions / sizeof *more_expressions && !error; i++) {
        error = has_obj(kit, more_expressions[i]) ? add_expression(kit, path, more_expressions[i])
                                                  : 0;
    }
    qsort(kit->expressions, kit->n_expressions, sizeof *kit->expressions, compare_names);
    return error;
}

static int take_landmarks(struct kit *kit, const char *path, const json_t *vertices)
{
    const uint32_t n = kit->layout->n_landmarks;
    kit->landmarks = calloc(n, sizeof *kit->landmarks);
    if (!kit->landmarks) {
        return iso_fault_set(kit->fault, -ENOMEM, "%s: out of memory", path);
    }
    bool good = json_array_size(vertices) == n;
    for (uint32_t i = 0; i < n && good; i++) {
        const json_t *vertex = json_array_get(vertices, i);
        const json_int_t number = json_integer_value(vertex);
        good = json_is_integer(vertex) && number >= 0 && number < kit->layout->n_vertices &&
               renumber(kit->layout, (uint32_t)number, &kit->landmarks[i]);
    }
    return good ? 0
                : iso_fault_set(kit->fault, -EBADMSG,
                                "%s: 'idx_to_landmark_verts' is no list of %u vertices of the head",
                                path, n);
}

static int read_indices(struct kit *kit)
{
    char path[PATH_MAX];
    json_error_t flaw;
    int error = iso_path_join(kit->folder, "vertex_indices.json", path, kit->fault);
    if (error) {
        return error;
    }
    char *text = NULL;
    size_t size = 0;
    error = iso_file_read(path, INDICES_BYTES_MAX, &text, &size, kit->fault);
    if (error) {
        return error;
    }
    json_t *indices = json_loadb(text, size, 0, &flaw);
    free(text);
    if (!indices) {
        return iso_fault_set(kit->fault, -EBADMSG, "%s:%d: %s", path, flaw.line, flaw.text);
    }
    error = take_expressions(kit, path, json_object_get(indices, "expressions"));
    error = error ? error
                  : take_landmarks(kit, path, json_object_get(indices, "idx_to_landmark_verts"));
    json_decref(indices);
    return error;
}

/* Says which file is missing before the first of 150 is read. */
static int check_files(const struct kit *kit)
{
    char name[NAME_SIZE], first[NAME_SIZE] = "";
    const uint32_t n_identity = kit->layout->n_identity;
    uint32_t missing = 0;
    for (uint32_t i = 0; i < 1 + n_identity + kit->n_expressions; i++) {
        if (i == 0) {
            (void)snprintf(name, sizeof name, "%s", neutral_name);
        } else if (i <= n_identity) {
            identity_name(i - 1, name);
        } else {
            (void)snprintf(name, sizeof name, "%s", kit->expressions[i - 1 - n_identity]);
        }
        if (!has_obj(kit, name) && missing++ == 0) {
            memcpy(first, name, sizeof first);
        }
    }
    if (missing == 0) {
        return 0;
    }
    char others[48] = "";
    if (missing > 1) {
        (void)snprintf(others, sizeof others, ", and %u more of the kit's files", missing - 1);
    }
    return iso_fault_set(kit->fault, -ENOENT, "%s/%s.obj is missing%s", kit->folder, first, others);
}

/* ---- shapes ---- */

static int read_obj(const struct kit *kit, const char *name, struct sim_obj *out)
{
    char path[PATH_MAX];
    struct sim_obj obj = {.n_points = 0};
    int error = obj_path(kit, name, path);
    error = error ? error : sim_obj_read(path, &obj, kit->fault);
    if (!error && obj.n_points != kit->layout->n_vertices) {
        error = iso_fault_set(kit->fault, -EBADMSG, "%s: %u vertices where the kit has %u", path,
                              obj.n_points, kit->layout->n_vertices);
        sim_obj_done(&obj);
    }
    if (!error) {
        *out = obj;
    }
    return error;
}

/* Adds the vertices that are kept, in millimetres; less those of `origin` if it is not NULL. */
static void add_points(const struct kit *kit, const struct sim_obj *obj,
                       const struct sim_obj *origin, struct sim_npy_writer *writer)
{
    for (int r = 0; r < SIM_ICT_KIT_RANGES; r++) {
        for (uint32_t v = kit->layout->kept[r].first; v < kit->layout->kept[r].end; v++) {
            for (int i = 0; i < 3; i++) {
                const double from = origin ? origin->points[v][i] : 0.0;
                sim_npy_writer_add(writer, mm_per_unit * (obj->points[v][i] - from));
            }
        }
    }
}

static int open_writer(const struct kit *kit, const char *file, enum sim_npy_type type,
                       const struct sim_npy_shape *shape, struct sim_npy_writer **out)
{
    char path[PATH_MAX];
    const int error = iso_path_join(kit->to, file, path, kit->fault);
    return error ? error : sim_npy_writer_open(path, type, shape, out, kit->fault);
}

static int write_mean(const struct kit *kit)
{
    const struct sim_npy_shape shape = {2, {n_kept(kit->layout), 3}};
    struct sim_npy_writer *writer = NULL;
    const int error = open_writer(kit, "mean.npy", SIM_NPY_FLOAT, &shape, &writer);
    if (error) {
        return error;
    }
    add_points(kit, &kit->neutral, NULL, writer);
    return sim_npy_writer_close(writer, true, kit->fault);
}

/* Triangles all of whose corners are kept. */
static uint32_t kept_triangles(const struct kit *kit, struct sim_npy_writer *writer)
{
    uint32_t n = 0;
    for (uint32_t t = 0; t < kit->neutral.n_triangles; t++) {
        uint32_t corner[3];
        bool kept = true;
        for (int i = 0; i < 3; i++) {
            kept = kept && renumber(kit->layout, kit->neutral.triangles[t][i], &corner[i]);
        }
        n += kept;
        for (int i = 0; i < 3 && kept && writer; i++) {
            sim_npy_writer_add(writer, (double)corner[i]);
        }
    }
    return n;
}

static int write_triangles(const struct kit *kit, uint32_t *n)
{
    *n = kept_triangles(kit, NULL);
    const struct sim_npy_shape shape = {2, {*n, 3}};
    struct sim_npy_writer *writer = NULL;
    const int error = open_writer(kit, "triangles.npy", SIM_NPY_U32, &shape, &writer);
    if (error) {
        return error;
    }
    (void)kept_triangles(kit, writer);
    return sim_npy_writer_close(writer, true, kit->fault);
}

/* The differences of n shapes to the neutral one; `names` NULL: the identities. */
static int write_modes(const struct kit *kit, const char *file, char (*names)[NAME_SIZE],
                       uint32_t n)
{
    const struct sim_npy_shape shape = {3, {n, n_kept(kit->layout), 3}};
    struct sim_npy_writer *writer = NULL;
    int error = open_writer(kit, file, SIM_NPY_HALF, &shape, &writer);
    for (uint32_t i = 0; i < n && !error; i++) {
        char identity[NAME_SIZE];
        struct sim_obj obj = {.n_points = 0};
        identity_name(i, identity);
        error = read_obj(kit, names ? names[i] : identity, &obj);
        if (!error) {
            add_points(kit, &obj, &kit->neutral, writer);
        }
        sim_obj_done(&obj);
    }
    struct iso_fault own = {.text = ""};
    const int closing = sim_npy_writer_close(writer, !error, &own);
    if (error || !closing) {
        return error;
    }
    return iso_fault_set(kit->fault, closing, "%s", own.text);
}

/* ---- lists ---- */

static int write_list(const struct kit *kit, const char *file, bool names)
{
    char path[PATH_MAX];
    int error = iso_path_join(kit->to, file, path, kit->fault);
    FILE *stream = error ? NULL : fopen(path, "we");
    if (!error && !stream) {
        error = iso_fault_set(kit->fault, -errno, "%s: %m", path);
    }
    if (error) {
        return error;
    }
    for (uint32_t i = 0; i < (names ? kit->n_expressions : kit->layout->n_landmarks); i++) {
        if (names) {
            fprintf(stream, "%s\n", kit->expressions[i]);
        } else {
            fprintf(stream, "%u\n", kit->landmarks[i]);
        }
    }
    error = ferror(stream) ? -EIO : 0;
    if (fclose(stream) != 0 && !error) {
        error = -errno;
    }
    return error ? iso_fault_set(kit->fault, error, "%s: %s", path, strerror(-error)) : 0;
}

/* ---- all of it ---- */

static int convert(struct kit *kit, struct sim_ict_kit_report *report)
{
    uint32_t n_triangles = 0;
    int error = read_obj(kit, neutral_name, &kit->neutral);
    if (!error && mkdir(kit->to, 0777) != 0 && errno != EEXIST) {
        error = iso_fault_set(kit->fault, -errno, "%s: %m", kit->to);
    }
    error = error ? error : write_mean(kit);
    error = error ? error : write_triangles(kit, &n_triangles);
    error = error ? error : write_modes(kit, "identity.npy", NULL, kit->layout->n_identity);
    error = error ? error
                  : write_modes(kit, "expression.npy", kit->expressions, kit->n_expressions);
    error = error ? error : write_list(kit, "expression_names.txt", true);
    error = error ? error : write_list(kit, "landmarks68.txt", false);
    if (!error) {
        *report = (struct sim_ict_kit_report){n_kept(kit->layout), n_triangles,
                                              kit->layout->n_identity, kit->n_expressions};
    }
    return error;
}

int sim_ict_import(const char *from, const struct sim_ict_layout *layout, const char *to,
                   struct sim_ict_kit_report *report, struct iso_fault *fault)
{
    struct kit kit = {.layout = layout, .to = to, .fault = fault};
    int error = find_folder(&kit, from);
    error = error ? error : read_indices(&kit);
    error = error ? error : check_files(&kit);
    error = error ? error : convert(&kit, report);
    sim_obj_done(&kit.neutral);
    free(kit.expressions);
    free(kit.landmarks);
    return error;
}
