#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "drivers/base/path.h"
#include "sim/base/make_directory.h"
#include "sim/world/face/ict_kit_data.h"
#include "sim/world/face/npy_writer.h"

static const double mm_per_unit = 10.0; /* the files are in centimetres */

static uint32_t n_kept(const struct sim_ict_layout *layout)
{
    uint32_t n = 0;
    for (int r = 0; r < SIM_ICT_KIT_RANGES; r++) {
        n += layout->kept[r].end - layout->kept[r].first;
    }
    return n;
}

static int read_obj(const struct sim_kit *kit, const char *name, struct sim_obj *out)
{
    char path[PATH_MAX];
    struct sim_obj obj = {.n_points = 0};
    int error = sim_kit_obj_path(kit, name, path);
    if (!error) {
        error = sim_obj_read(path, &obj, kit->fault);
    }
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

/* Writes the kept vertices in millimetres, minus those of `origin` if it is not NULL. */
static void add_points(const struct sim_kit *kit, const struct sim_obj *obj,
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

static int open_writer(const struct sim_kit *kit, const char *file, enum sim_npy_type type,
                       const struct sim_npy_shape *shape, struct sim_npy_writer **out)
{
    char path[PATH_MAX];
    const int error = iso_path_join(kit->to, file, path, kit->fault);
    if (error) {
        return error;
    }
    return sim_npy_writer_open(path, type, shape, out, kit->fault);
}

static int write_mean(const struct sim_kit *kit)
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

/* Writes the triangles whose three corners are kept, and returns their number. `writer` NULL: only
 * counts them. */
static uint32_t kept_triangles(const struct sim_kit *kit, struct sim_npy_writer *writer)
{
    uint32_t n = 0;
    for (uint32_t t = 0; t < kit->neutral.n_triangles; t++) {
        uint32_t corner[3];
        bool kept = true;
        for (int i = 0; i < 3; i++) {
            kept = kept && sim_kit_renumber(kit->layout, kit->neutral.triangles[t][i], &corner[i]);
        }
        n += kept;
        for (int i = 0; i < 3 && kept && writer; i++) {
            sim_npy_writer_add(writer, (double)corner[i]);
        }
    }
    return n;
}

static int write_triangles(const struct sim_kit *kit, uint32_t *n)
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

/* Writes the differences between n shapes and the neutral one. `names` NULL: the identities. */
static int write_modes(const struct sim_kit *kit, const char *file,
                       char (*names)[SIM_KIT_NAME_SIZE], uint32_t n)
{
    const struct sim_npy_shape shape = {3, {n, n_kept(kit->layout), 3}};
    struct sim_npy_writer *writer = NULL;
    int error = open_writer(kit, file, SIM_NPY_HALF, &shape, &writer);
    for (uint32_t i = 0; i < n && !error; i++) {
        char identity[SIM_KIT_NAME_SIZE];
        struct sim_obj obj = {.n_points = 0};
        sim_kit_identity_name(i, identity);
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

static int write_list(const struct sim_kit *kit, const char *file, bool names)
{
    char path[PATH_MAX];
    int error = iso_path_join(kit->to, file, path, kit->fault);
    if (error) {
        return error;
    }
    FILE *stream = fopen(path, "we");
    if (!stream) {
        return iso_fault_set(kit->fault, -errno, "%s: %m", path);
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

int sim_kit_convert(struct sim_kit *kit, struct sim_ict_kit_report *report)
{
    uint32_t n_triangles = 0;
    int error = read_obj(kit, SIM_KIT_NEUTRAL, &kit->neutral);
    if (!error) {
        error = sim_make_directory(kit->to, kit->fault);
    }
    if (!error) {
        error = write_mean(kit);
    }
    if (!error) {
        error = write_triangles(kit, &n_triangles);
    }
    if (!error) {
        error = write_modes(kit, "identity.npy", NULL, kit->layout->n_identity);
    }
    if (!error) {
        error = write_modes(kit, "expression.npy", kit->expressions, kit->n_expressions);
    }
    if (!error) {
        error = write_list(kit, "expression_names.txt", true);
    }
    if (!error) {
        error = write_list(kit, "landmarks68.txt", false);
    }
    if (!error) {
        *report = (struct sim_ict_kit_report){n_kept(kit->layout), n_triangles,
                                              kit->layout->n_identity, kit->n_expressions};
    }
    return error;
}
