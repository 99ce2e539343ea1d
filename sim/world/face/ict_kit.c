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
#include "sim/world/face/ict_kit_data.h"

enum { SHAPES_MAX = 1024, INDICES_BYTES_MAX = 1 << 24 };

/* Shapes that some releases of the kit have and the index file does not name. */
static const char *const more_expressions[] = {"PupilDilate_L", "PupilDilate_R", "cheekRaiser_L",
                                               "cheekRaiser_R"};

const struct sim_ict_layout sim_ict_kit_layout = {
    .n_vertices = 26719,
    .n_identity = 100,
    .n_landmarks = 68,
    .kept = {{0, 14062}, {21451, 24591}},
};

bool sim_kit_renumber(const struct sim_ict_layout *layout, uint32_t vertex, uint32_t *out)
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

int sim_kit_obj_path(const struct sim_kit *kit, const char *name, char path[PATH_MAX])
{
    char file[SIM_KIT_NAME_SIZE + 8];
    (void)snprintf(file, sizeof file, "%s.obj", name);
    return iso_path_join(kit->folder, file, path, kit->fault);
}

static bool has_obj(const struct sim_kit *kit, const char *name)
{
    char path[PATH_MAX];
    return sim_kit_obj_path(kit, name, path) == 0 && access(path, F_OK) == 0;
}

void sim_kit_identity_name(uint32_t i, char name[SIM_KIT_NAME_SIZE])
{
    (void)snprintf(name, SIM_KIT_NAME_SIZE, "identity%03u", i);
}

/* Sets kit->folder to the subfolder FaceXModel of `from` or, if there is none, to `from` itself. */
static int find_folder(struct sim_kit *kit, const char *from)
{
    struct stat status;
    int error = iso_path_join(from, "FaceXModel", kit->folder, kit->fault);
    if (!error && (stat(kit->folder, &status) != 0 || !S_ISDIR(status.st_mode))) {
        (void)snprintf(kit->folder, sizeof kit->folder, "%s", from);
        error = has_obj(kit, SIM_KIT_NEUTRAL)
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

static int add_expression(struct sim_kit *kit, const char *path, const char *name)
{
    const bool plain = name && *name && strlen(name) < SIM_KIT_NAME_SIZE &&
                       strspn(name, "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_"
                                    "0123456789") == strlen(name);
    if (!plain || kit->n_expressions == SHAPES_MAX) {
        return iso_fault_set(kit->fault, -EBADMSG, "%s: 'expressions' is no list of shapes", path);
    }
    (void)snprintf(kit->expressions[kit->n_expressions++], SIM_KIT_NAME_SIZE, "%s", name);
    return 0;
}

static int take_expressions(struct sim_kit *kit, const char *path, const json_t *names)
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

static int take_landmarks(struct sim_kit *kit, const char *path, const json_t *vertices)
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
               sim_kit_renumber(kit->layout, (uint32_t)number, &kit->landmarks[i]);
    }
    return good ? 0
                : iso_fault_set(kit->fault, -EBADMSG,
                                "%s: 'idx_to_landmark_verts' is no list of %u vertices of the head",
                                path, n);
}

static int read_indices(struct sim_kit *kit)
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
    if (!error) {
        error = take_landmarks(kit, path, json_object_get(indices, "idx_to_landmark_verts"));
    }
    json_decref(indices);
    return error;
}

/* Checks that no file is missing, before the first of about 150 files is read. */
static int check_files(const struct sim_kit *kit)
{
    char name[SIM_KIT_NAME_SIZE], first[SIM_KIT_NAME_SIZE] = "";
    const uint32_t n_identity = kit->layout->n_identity;
    uint32_t missing = 0;
    for (uint32_t i = 0; i < 1 + n_identity + kit->n_expressions; i++) {
        if (i == 0) {
            (void)snprintf(name, sizeof name, "%s", SIM_KIT_NEUTRAL);
        } else if (i <= n_identity) {
            sim_kit_identity_name(i - 1, name);
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

int sim_ict_import(const char *from, const struct sim_ict_layout *layout, const char *to,
                   struct sim_ict_kit_report *report, struct iso_fault *fault)
{
    struct sim_kit kit = {.layout = layout, .to = to, .fault = fault};
    int error = find_folder(&kit, from);
    if (!error) {
        error = read_indices(&kit);
    }
    if (!error) {
        error = check_files(&kit);
    }
    if (!error) {
        error = sim_kit_convert(&kit, report);
    }
    sim_obj_done(&kit.neutral);
    free(kit.expressions);
    free(kit.landmarks);
    return error;
}
