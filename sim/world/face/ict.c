#include "sim/world/face/ict.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/file/file.h"
#include "sim/world/face/npy.h"

enum { LIST_BYTES_MAX = 1 << 20 };

struct source {
    const char *directory;
    struct iso_fault *fault;
    char path[PATH_MAX];
};

static const char *path_of(struct source *source, const char *name)
{
    (void)snprintf(source->path, sizeof source->path, "%s/%s", source->directory, name);
    return source->path;
}

static int shape_fault(struct source *source)
{
    return iso_fault_set(source->fault, -EBADMSG, "%s: shape does not fit the head model",
                         source->path);
}

/* Floats of shape [n_modes][n_vertices][3], or [n_vertices][3] with n_modes NULL. */
static int read_points(struct source *source, const char *name, uint32_t *n_modes, float **out)
{
    struct sim_npy_shape shape;
    float *values = NULL;
    const int error = sim_npy_read_floats(path_of(source, name), &shape, &values, source->fault);
    if (error != 0) {
        return error;
    }
    const int n_leading = n_modes ? 1 : 0;
    if (shape.n_dimensions != n_leading + 2 || shape.size[n_leading] != SIM_ICT_VERTICES ||
        shape.size[n_leading + 1] != 3) {
        free(values);
        return shape_fault(source);
    }
    const size_t n = (size_t)SIM_ICT_VERTICES * 3 * (n_modes ? shape.size[0] : 1);
    for (size_t i = 0; i < n; i++) {
        if (!isfinite(values[i])) {
            free(values);
            return iso_fault_set(source->fault, -EBADMSG, "%s: value %zu is not finite",
                                 source->path, i);
        }
    }
    if (n_modes) {
        *n_modes = shape.size[0];
    }
    *out = values;
    return 0;
}

static int read_triangles(struct source *source, struct sim_ict *ict)
{
    struct sim_npy_shape shape;
    uint32_t *corners = NULL;
    const int error = sim_npy_read_u32(path_of(source, "triangles.npy"), &shape, &corners,
                                       source->fault);
    if (error != 0) {
        return error;
    }
    if (shape.n_dimensions != 2 || shape.size[1] != 3) {
        free(corners);
        return shape_fault(source);
    }
    for (size_t i = 0; i < (size_t)shape.size[0] * 3; i++) {
        if (corners[i] >= ict->n_vertices) {
            free(corners);
            return iso_fault_set(source->fault, -EBADMSG, "%s: triangle %zu names no vertex",
                                 source->path, i / 3);
        }
    }
    ict->n_triangles = shape.size[0];
    ict->triangles = (uint32_t(*)[3])corners;
    return 0;
}

static int read_names(struct source *source, struct sim_ict *ict)
{
    FILE *stream = NULL;
    int error = iso_file_stream(path_of(source, "expression_names.txt"), LIST_BYTES_MAX, &stream,
                                source->fault);
    if (error) {
        return error;
    }
    ict->expression_names = calloc(ict->n_expression, sizeof *ict->expression_names);
    error = ict->expression_names ? 0 : -ENOMEM;
    for (uint32_t i = 0; error == 0 && i < ict->n_expression; i++) {
        if (fscanf(stream, "%31s", ict->expression_names[i]) != 1) {
            error = iso_fault_set(source->fault, -EBADMSG, "%s: %u names, expected %u",
                                  source->path, i, ict->n_expression);
        }
    }
    char rest[2];
    if (error == 0 && fscanf(stream, "%1s", rest) == 1) {
        error = iso_fault_set(source->fault, -EBADMSG, "%s: more than %u names", source->path,
                              ict->n_expression);
    }
    (void)fclose(stream);
    return error;
}

static int read_landmarks(struct source *source, struct sim_ict *ict)
{
    FILE *stream = NULL;
    int error = iso_file_stream(path_of(source, "landmarks68.txt"), LIST_BYTES_MAX, &stream,
                                source->fault);
    for (int i = 0; error == 0 && i < 68; i++) {
        if (fscanf(stream, "%u", &ict->landmarks[i]) != 1 || ict->landmarks[i] >= ict->n_vertices) {
            error = iso_fault_set(source->fault, -EBADMSG, "%s: landmark %d names no vertex",
                                  source->path, i);
        }
    }
    if (stream) {
        (void)fclose(stream);
    }
    return error;
}

int sim_ict_load(const char *directory, struct sim_ict **out, struct iso_fault *fault)
{
    struct source source = {directory, fault, ""};
    struct sim_ict *ict = calloc(1, sizeof *ict);
    if (!ict) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", directory);
    }
    ict->n_vertices = SIM_ICT_VERTICES;
    int error = read_points(&source, "mean.npy", NULL, &ict->mean_mm);
    if (error == 0) {
        error = read_points(&source, "identity.npy", &ict->n_identity, &ict->identity_mm);
    }
    if (error == 0) {
        error = read_points(&source, "expression.npy", &ict->n_expression, &ict->expression_mm);
    }
    if (error == 0) {
        error = read_triangles(&source, ict);
    }
    if (error == 0) {
        error = read_names(&source, ict);
    }
    if (error == 0) {
        error = read_landmarks(&source, ict);
    }
    if (error != 0) {
        sim_ict_free(ict);
        return error;
    }
    *out = ict;
    return 0;
}

void sim_ict_free(struct sim_ict *ict)
{
    if (!ict) {
        return;
    }
    free(ict->mean_mm);
    free(ict->triangles);
    free(ict->identity_mm);
    free(ict->expression_mm);
    free(ict->expression_names);
    free(ict);
}

int sim_ict_expression(const struct sim_ict *ict, const char *name)
{
    for (uint32_t i = 0; i < ict->n_expression; i++) {
        if (strcmp(ict->expression_names[i], name) == 0) {
            return (int)i;
        }
    }
    return -1;
}
