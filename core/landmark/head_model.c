#include "isotherm/head_model.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/bytes.h"
#include "core/base/crc32.h"
#include "core/base/fault.h"

static const char magic[8] = {'I', 'S', 'O', 'H', 'E', 'A', 'D', '1'};

enum {
    CHECKED_FROM = 8 + 4 + 4, /* the checksum covers the file from here on */
    HEADER_BYTES = CHECKED_FROM + 4 * 4,
    LANDMARK_BYTES = 2 + 2 + 3 * 4,
    INT16_LARGEST = 32767,
};

static bool counts_in_range(uint32_t n_vertices, uint32_t n_triangles, uint32_t n_identity,
                            uint32_t n_expression)
{
    return n_vertices >= 3 && n_vertices <= ISO_HEAD_VERTICES_MAX && n_triangles >= 1 &&
           n_triangles <= ISO_HEAD_TRIANGLES_MAX && n_identity <= ISO_HEAD_IDENTITY_MAX &&
           n_expression <= ISO_HEAD_EXPRESSION_MAX;
}

static size_t file_bytes(const struct iso_head_model *model)
{
    const size_t n = model->n_vertices;
    const size_t n_modes = (size_t)model->n_identity + model->n_expression;
    return HEADER_BYTES + n * (3 * 4 + 1) + (size_t)model->n_triangles * 3 * 2 +
           (size_t)ISO_LANDMARKS_IBUG * LANDMARK_BYTES + n_modes * (4 + n * 3 * 2);
}

int iso_head_model_new(uint32_t n_vertices, uint32_t n_triangles, uint32_t n_identity,
                       uint32_t n_expression, struct iso_head_model **out)
{
    if (!counts_in_range(n_vertices, n_triangles, n_identity, n_expression)) {
        return -EINVAL;
    }
    struct iso_head_model *model = calloc(1, sizeof *model);
    if (!model) {
        return -ENOMEM;
    }
    model->n_vertices = n_vertices;
    model->n_triangles = n_triangles;
    model->n_identity = n_identity;
    model->n_expression = n_expression;
    model->mean_mm = calloc(n_vertices, sizeof *model->mean_mm);
    model->triangles = calloc(n_triangles, sizeof *model->triangles);
    model->region = calloc(n_vertices, sizeof *model->region);
    /* One spare element, so that a model without modes does not look like a failed allocation. */
    const size_t mode = 3 * (size_t)n_vertices;
    model->identity_mm = calloc(n_identity * mode + 1, sizeof *model->identity_mm);
    model->expression_mm = calloc(n_expression * mode + 1, sizeof *model->expression_mm);
    if (!model->mean_mm || !model->triangles || !model->region || !model->identity_mm ||
        !model->expression_mm) {
        iso_head_model_free(model);
        return -ENOMEM;
    }
    *out = model;
    return 0;
}

void iso_head_model_free(struct iso_head_model *model)
{
    if (model) {
        free(model->mean_mm);
        free(model->triangles);
        free(model->region);
        free(model->identity_mm);
        free(model->expression_mm);
        free(model);
    }
}

static bool all_finite(const float *values, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        if (!isfinite(values[i])) {
            return false;
        }
    }
    return true;
}

static bool triangle_fits(const uint32_t *v, uint32_t n_vertices)
{
    return v[0] < n_vertices && v[1] < n_vertices && v[2] < n_vertices && v[0] != v[1] &&
           v[1] != v[2] && v[2] != v[0];
}

static bool point_fits(const struct iso_head_point *point, uint32_t n_triangles)
{
    const float rounding = 1e-4f;
    float sum = 0.0f;
    for (int k = 0; k < 3; k++) {
        if (!(point->weight[k] >= -rounding)) { /* also true for NaN */
            return false;
        }
        sum += point->weight[k];
    }
    return point->triangle < n_triangles && fabsf(sum - 1.0f) <= rounding;
}

/* What is wrong with the contents of a model whose counts are in range; NULL if nothing is. Reader
 * and writer use the same check, so that nothing is written that could not be read. */
static const char *inconsistency_of(const struct iso_head_model *model)
{
    const uint32_t n = model->n_vertices;
    for (uint32_t i = 0; i < n; i++) {
        const struct iso_vec3 p = model->mean_mm[i];
        if (!isfinite((float)p.x) || !isfinite((float)p.y) || !isfinite((float)p.z)) {
            return "head model: a vertex is not finite";
        }
        if (model->region[i] & ~(ISO_HEAD_FACE | ISO_HEAD_RIGID)) {
            return "head model: unknown region";
        }
    }
    for (uint32_t t = 0; t < model->n_triangles; t++) {
        if (!triangle_fits(model->triangles[t], n)) {
            return "head model: bad triangle";
        }
    }
    for (int i = 0; i < ISO_LANDMARKS_IBUG; i++) {
        if (!point_fits(&model->landmarks[i], model->n_triangles)) {
            return "head model: bad landmark";
        }
    }
    if (!all_finite(model->identity_mm, (size_t)model->n_identity * n * 3) ||
        !all_finite(model->expression_mm, (size_t)model->n_expression * n * 3)) {
        return "head model: a mode is not finite";
    }
    return NULL;
}

/* The readers and writers below return a pointer to the byte after the last one that they used. */

static const uint8_t *read_mesh(const uint8_t *p, struct iso_head_model *model)
{
    for (uint32_t i = 0; i < model->n_vertices; i++, p += 12) {
        model->mean_mm[i] = iso_vec3((double)iso_get_f32(p), (double)iso_get_f32(p + 4),
                                     (double)iso_get_f32(p + 8));
    }
    for (uint32_t t = 0; t < model->n_triangles; t++) {
        for (int k = 0; k < 3; k++, p += 2) {
            model->triangles[t][k] = iso_get_u16(p);
        }
    }
    memcpy(model->region, p, model->n_vertices);
    return p + model->n_vertices;
}

/* Returns NULL if the reserved bytes are not zero. */
static const uint8_t *read_landmarks(const uint8_t *p, struct iso_head_model *model)
{
    for (int i = 0; i < ISO_LANDMARKS_IBUG; i++, p += LANDMARK_BYTES) {
        model->landmarks[i].triangle = iso_get_u16(p);
        if (iso_get_u16(p + 2) != 0) {
            return NULL;
        }
        for (int k = 0; k < 3; k++) {
            model->landmarks[i].weight[k] = iso_get_f32(p + 4 + 4 * k);
        }
    }
    return p;
}

static const uint8_t *read_modes(const uint8_t *p, size_t n_modes, size_t n, float *mode_mm)
{
    for (size_t m = 0; m < n_modes; m++) {
        const float scale_mm = iso_get_f32(p);
        p += 4;
        for (size_t i = 0; i < n; i++, p += 2) {
            *mode_mm++ = scale_mm * (float)(int16_t)iso_get_u16(p);
        }
    }
    return p;
}

static uint8_t *write_mesh(uint8_t *p, const struct iso_head_model *model)
{
    for (uint32_t i = 0; i < model->n_vertices; i++) {
        p = iso_put_f32(p, (float)model->mean_mm[i].x);
        p = iso_put_f32(p, (float)model->mean_mm[i].y);
        p = iso_put_f32(p, (float)model->mean_mm[i].z);
    }
    for (uint32_t t = 0; t < model->n_triangles; t++) {
        for (int k = 0; k < 3; k++) {
            p = iso_put_u16(p, (uint16_t)model->triangles[t][k]);
        }
    }
    return iso_put_bytes(p, model->region, model->n_vertices);
}

static uint8_t *write_landmarks(uint8_t *p, const struct iso_head_model *model)
{
    for (int i = 0; i < ISO_LANDMARKS_IBUG; i++) {
        p = iso_put_u16(p, (uint16_t)model->landmarks[i].triangle);
        p = iso_put_u16(p, 0);
        for (int k = 0; k < 3; k++) {
            p = iso_put_f32(p, model->landmarks[i].weight[k]);
        }
    }
    return p;
}

static uint8_t *write_modes(uint8_t *p, size_t n_modes, size_t n, const float *mode_mm)
{
    for (size_t m = 0; m < n_modes; m++, mode_mm += n) {
        float largest_mm = 0.0f;
        for (size_t i = 0; i < n; i++) {
            largest_mm = fmaxf(largest_mm, fabsf(mode_mm[i]));
        }
        const float scale_mm = largest_mm / INT16_LARGEST;
        p = iso_put_f32(p, scale_mm);
        for (size_t i = 0; i < n; i++) {
            long counts = scale_mm > 0.0f ? lrintf(mode_mm[i] / scale_mm) : 0;
            counts = counts > INT16_LARGEST ? INT16_LARGEST : counts;
            counts = counts < -INT16_LARGEST ? -INT16_LARGEST : counts;
            p = iso_put_u16(p, (uint16_t)(int16_t)counts);
        }
    }
    return p;
}

/* Fills in a model of the right counts from a file of the right size and checksum. Returns NULL, or
 * what is wrong with the contents. */
static const char *parse_contents(const uint8_t *p, struct iso_head_model *model)
{
    const size_t n = 3 * (size_t)model->n_vertices;
    p = read_landmarks(read_mesh(p + HEADER_BYTES, model), model);
    if (!p) {
        return "head model: reserved bytes are not zero";
    }
    p = read_modes(p, model->n_identity, n, model->identity_mm);
    (void)read_modes(p, model->n_expression, n, model->expression_mm);
    return inconsistency_of(model);
}

static int check_header(const uint8_t *p, size_t size, struct iso_fault *fault)
{
    if (size < HEADER_BYTES || memcmp(p, magic, sizeof magic - 1) != 0) {
        return iso_fault_set(fault, -EBADMSG, "not a head model");
    }
    if (p[sizeof magic - 1] != (uint8_t)magic[sizeof magic - 1]) {
        return iso_fault_set(fault, -EBADMSG, "head model: of another version");
    }
    if (iso_get_u32(p + 8) != size || size > ISO_HEAD_BYTES_MAX) {
        return iso_fault_set(fault, -EBADMSG, "head model: truncated or too long");
    }
    if (iso_get_u32(p + 12) != iso_crc32(0, p + CHECKED_FROM, size - CHECKED_FROM)) {
        return iso_fault_set(fault, -EBADMSG, "head model: checksum is wrong");
    }
    return 0;
}

int iso_head_model_parse(const void *bytes, size_t size, struct iso_head_model **out,
                         struct iso_fault *fault)
{
    const uint8_t *p = bytes;
    int error = check_header(p, size, fault);
    if (error) {
        return error;
    }
    struct iso_head_model *model = NULL;
    error = iso_head_model_new(iso_get_u32(p + 16), iso_get_u32(p + 20), iso_get_u32(p + 24),
                               iso_get_u32(p + 28), &model);
    if (error) {
        return error == -EINVAL
                   ? iso_fault_set(fault, -EBADMSG, "head model: a count is out of range")
                   : iso_fault_set(fault, error, "head model: out of memory");
    }
    const char *wrong = file_bytes(model) == size ? parse_contents(p, model)
                                                  : "head model: size does not fit the counts";
    if (wrong) {
        iso_head_model_free(model);
        return iso_fault_set(fault, -EBADMSG, "%s", wrong);
    }
    model->crc32 = iso_get_u32(p + 12);
    *out = model;
    return 0;
}

int iso_head_model_serialise(const struct iso_head_model *model, void **bytes, size_t *size)
{
    if (!counts_in_range(model->n_vertices, model->n_triangles, model->n_identity,
                         model->n_expression) ||
        inconsistency_of(model)) {
        return -EINVAL;
    }
    const size_t total = file_bytes(model);
    if (total > ISO_HEAD_BYTES_MAX) {
        return -EFBIG;
    }
    uint8_t *buffer = malloc(total);
    if (!buffer) {
        return -ENOMEM;
    }
    uint8_t *p = iso_put_u32(buffer + CHECKED_FROM, model->n_vertices);
    p = iso_put_u32(p, model->n_triangles);
    p = iso_put_u32(p, model->n_identity);
    p = iso_put_u32(p, model->n_expression);
    p = write_landmarks(write_mesh(p, model), model);
    const size_t n = 3 * (size_t)model->n_vertices;
    p = write_modes(p, model->n_identity, n, model->identity_mm);
    (void)write_modes(p, model->n_expression, n, model->expression_mm);

    p = iso_put_bytes(buffer, magic, sizeof magic);
    p = iso_put_u32(p, (uint32_t)total);
    (void)iso_put_u32(p, iso_crc32(0, buffer + CHECKED_FROM, total - CHECKED_FROM));
    *bytes = buffer;
    *size = total;
    return 0;
}

struct iso_vec3 iso_head_point_on(const struct iso_head_model *model,
                                  const struct iso_vec3 *vertices_mm, struct iso_head_point point)
{
    const uint32_t *v = model->triangles[point.triangle];
    struct iso_vec3 p = iso_scale((double)point.weight[0], vertices_mm[v[0]]);
    p = iso_madd(p, (double)point.weight[1], vertices_mm[v[1]]);
    return iso_madd(p, (double)point.weight[2], vertices_mm[v[2]]);
}
