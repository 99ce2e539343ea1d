/* The metric's file: how it is made, read and checked. */
#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/bytes.h"
#include "core/base/crc32.h"
#include "core/base/fault.h"
#include "isotherm/metric.h"

static const char magic[8] = {'I', 'S', 'O', 'M', 'E', 'T', 'R', '3'};

enum { HEADER_BYTES = 8 + 4 + 4, SHAPE_BYTES = 2 * 4 + 5 * 2 + 6 * 4, STEPS = 32767 };

static int count_bits(uint32_t bits)
{
    int n = 0;
    for (; bits; bits &= bits - 1) {
        n++;
    }
    return n;
}

static bool shape_sane(const struct iso_metric *m)
{
    return m->landmarks != 0 && m->landmarks >> ISO_LANDMARKS == 0 && m->n_radii >= 1 &&
           m->n_radii <= ISO_TEMPLATE_RADII_MAX && m->n_points >= 4 &&
           m->n_points <= ISO_TEMPLATE_POINTS_MAX && m->n_dimensions >= 1 &&
           m->n_dimensions <= ISO_METRIC_DIMENSIONS_MAX && m->n_origins >= 0 &&
           m->n_origins <= ISO_METRIC_ORIGINS_MAX && m->n_nodes >= 0 &&
           m->n_nodes <= ISO_UPPER_NODES;
}

static bool nodes_sane(const struct iso_metric *m)
{
    bool sane = true;
    for (int i = 0; i < m->n_nodes; i++) {
        sane = sane && m->node[i] < ISO_UPPER_NODES && (i == 0 || m->node[i] > m->node[i - 1]);
    }
    return sane;
}

static int curve_values_of(const struct iso_metric *shape)
{
    return 3 * shape->n_radii * count_bits(shape->landmarks) * shape->n_points;
}

static int values_of(const struct iso_metric *shape)
{
    return curve_values_of(shape) + shape->n_nodes;
}

static size_t file_size(const struct iso_metric *m)
{
    const size_t values = (size_t)values_of(m), dimensions = (size_t)m->n_dimensions;
    return HEADER_BYTES + SHAPE_BYTES + (size_t)m->n_origins * ISO_METRIC_ORIGIN_MAX +
           2 * (size_t)m->n_nodes + 4 * (values + 2 * dimensions) + dimensions * (4 + 2 * values);
}

int iso_metric_new(const struct iso_metric *shape, struct iso_metric **out)
{
    if (!shape_sane(shape) || !nodes_sane(shape)) {
        return -EINVAL;
    }
    const size_t values = (size_t)values_of(shape), dimensions = (size_t)shape->n_dimensions;
    const size_t floats = values + 2 * dimensions + values * dimensions;
    struct iso_metric *m = calloc(1, sizeof *m);
    float *data = calloc(floats, sizeof *data);
    if (!m || !data) {
        free(m);
        free(data);
        return -ENOMEM;
    }
    *m = *shape;
    m->n_curve_values = curve_values_of(shape);
    m->n_values = (int)values;
    m->curve_mm = data;
    m->upper_mm = m->curve_mm + m->n_curve_values;
    m->between = m->curve_mm + values;
    m->centre = m->between + dimensions;
    m->axis = m->centre + dimensions;
    *out = m;
    return 0;
}

void iso_metric_free(struct iso_metric *metric)
{
    if (metric) {
        free(metric->curve_mm);
        free(metric);
    }
}

static const uint8_t *get_shape(const uint8_t *p, struct iso_metric *m)
{
    m->algorithm = iso_get_u32(p);
    m->landmarks = iso_get_u32(p + 4);
    m->n_radii = iso_get_u16(p + 8);
    m->n_points = iso_get_u16(p + 10);
    m->n_dimensions = iso_get_u16(p + 12);
    m->n_origins = iso_get_u16(p + 14);
    m->n_nodes = iso_get_u16(p + 16);
    m->weight_min = iso_get_f32(p + 18);
    m->gain = iso_get_f32(p + 22);
    m->bias = iso_get_f32(p + 26);
    m->rerank.metric = iso_get_f32(p + 30);
    m->rerank.upper = iso_get_f32(p + 34);
    m->rerank.bias = iso_get_f32(p + 38);
    return p + SHAPE_BYTES;
}

static const uint8_t *get_floats(const uint8_t *p, int n, float *out)
{
    for (int i = 0; i < n; i++, p += 4) {
        out[i] = iso_get_f32(p);
    }
    return p;
}

static void get_axes(const uint8_t *p, struct iso_metric *m)
{
    for (int d = 0; d < m->n_dimensions; d++) {
        const float step = iso_get_f32(p);
        p += 4;
        for (int v = 0; v < m->n_values; v++, p += 2) {
            m->axis[(size_t)v * (size_t)m->n_dimensions + (size_t)d] = step *
                                                                       (float)(int16_t)iso_get_u16(
                                                                           p);
        }
    }
}

static bool all_finite(const float *x, size_t n)
{
    bool finite = true;
    for (size_t i = 0; i < n; i++) {
        finite = finite && isfinite(x[i]);
    }
    return finite;
}

static bool rerank_sane(const struct iso_rerank_weights *w)
{
    return w->metric >= 0.0f && w->upper >= 0.0f && isfinite(w->metric) && isfinite(w->upper) &&
           isfinite(w->bias);
}

static bool numbers_sane(const struct iso_metric *m)
{
    const size_t values = (size_t)m->n_values, dimensions = (size_t)m->n_dimensions;
    bool sane = m->weight_min > 0.0f && m->weight_min <= 1.0f && m->gain > 0.0f &&
                isfinite(m->gain) && isfinite(m->bias) && rerank_sane(&m->rerank) &&
                all_finite(m->curve_mm, values + 2 * dimensions + values * dimensions);
    for (int d = 0; d < m->n_dimensions; d++) {
        sane = sane && m->between[d] >= 0.0f;
    }
    for (int i = 0; i < m->n_origins; i++) {
        sane = sane && memchr(m->origin[i], '\0', ISO_METRIC_ORIGIN_MAX) != NULL;
    }
    return sane;
}

int iso_metric_parse(const void *bytes, size_t size, struct iso_metric **out,
                     struct iso_fault *fault)
{
    const uint8_t *p = bytes;
    if (size < HEADER_BYTES + SHAPE_BYTES || memcmp(p, magic, sizeof magic) != 0) {
        return iso_fault_set(fault, -EBADMSG, "not a metric file of version 3");
    }
    if (iso_get_u32(p + 8) != size) {
        return iso_fault_set(fault, -EBADMSG, "metric file: truncated or too long");
    }
    if (iso_get_u32(p + 12) != iso_crc32(0, p + HEADER_BYTES, size - HEADER_BYTES)) {
        return iso_fault_set(fault, -EBADMSG, "metric file: checksum is wrong");
    }
    struct iso_metric shape = {0};
    p = get_shape(p + HEADER_BYTES, &shape);
    if (!shape_sane(&shape) || file_size(&shape) != size) {
        return iso_fault_set(fault, -EBADMSG, "metric file: sizes out of range");
    }
    memcpy(shape.origin, p, (size_t)shape.n_origins * ISO_METRIC_ORIGIN_MAX);
    p += (size_t)shape.n_origins * ISO_METRIC_ORIGIN_MAX;
    for (int i = 0; i < shape.n_nodes; i++, p += 2) {
        shape.node[i] = iso_get_u16(p);
    }
    if (!nodes_sane(&shape)) {
        return iso_fault_set(fault, -EBADMSG, "metric file: nodes out of range");
    }
    struct iso_metric *m = NULL;
    const int error = iso_metric_new(&shape, &m);
    if (error) {
        return iso_fault_set(fault, error, "metric file: out of memory");
    }
    p = get_floats(p, m->n_values, m->curve_mm);
    p = get_floats(p, m->n_dimensions, m->between);
    get_axes(get_floats(p, m->n_dimensions, m->centre), m);
    if (!numbers_sane(m)) {
        iso_metric_free(m);
        return iso_fault_set(fault, -EBADMSG, "metric file: numbers out of range");
    }
    *out = m;
    return 0;
}

static uint8_t *put_floats(uint8_t *p, const float *x, int n)
{
    for (int i = 0; i < n; i++) {
        p = iso_put_f32(p, x[i]);
    }
    return p;
}

static uint8_t *put_axes(uint8_t *p, const struct iso_metric *m)
{
    const size_t n = (size_t)m->n_dimensions;
    for (size_t d = 0; d < n; d++) {
        float largest = 1e-30f;
        for (int v = 0; v < m->n_values; v++) {
            largest = fmaxf(largest, fabsf(m->axis[(size_t)v * n + d]));
        }
        const float step = largest / STEPS;
        p = iso_put_f32(p, step);
        for (int v = 0; v < m->n_values; v++) {
            long steps = lrintf(m->axis[(size_t)v * n + d] / step);
            p = iso_put_u16(p, (uint16_t)(int16_t)(steps > STEPS ? STEPS : steps));
        }
    }
    return p;
}

int iso_metric_serialise(const struct iso_metric *m, void **bytes, size_t *size)
{
    const size_t total = shape_sane(m) && nodes_sane(m) ? file_size(m) : 0;
    if (total == 0 || total > ISO_METRIC_BYTES_MAX || !numbers_sane(m)) {
        return -EINVAL;
    }
    uint8_t *buffer = malloc(total);
    if (!buffer) {
        return -ENOMEM;
    }
    uint8_t *p = iso_put_u32(buffer + HEADER_BYTES, m->algorithm);
    p = iso_put_u32(p, m->landmarks);
    p = iso_put_u16(p, (uint16_t)m->n_radii);
    p = iso_put_u16(p, (uint16_t)m->n_points);
    p = iso_put_u16(p, (uint16_t)m->n_dimensions);
    p = iso_put_u16(p, (uint16_t)m->n_origins);
    p = iso_put_u16(p, (uint16_t)m->n_nodes);
    p = iso_put_f32(p, m->weight_min);
    p = iso_put_f32(p, m->gain);
    p = iso_put_f32(p, m->bias);
    p = iso_put_f32(p, m->rerank.metric);
    p = iso_put_f32(p, m->rerank.upper);
    p = iso_put_f32(p, m->rerank.bias);
    p = iso_put_bytes(p, m->origin, (size_t)m->n_origins * ISO_METRIC_ORIGIN_MAX);
    for (int i = 0; i < m->n_nodes; i++) {
        p = iso_put_u16(p, m->node[i]);
    }
    p = put_floats(p, m->curve_mm, m->n_values);
    p = put_floats(p, m->between, m->n_dimensions);
    (void)put_axes(put_floats(p, m->centre, m->n_dimensions), m);
    p = iso_put_bytes(buffer, magic, sizeof magic);
    p = iso_put_u32(p, (uint32_t)total);
    (void)iso_put_u32(p, iso_crc32(0, buffer + HEADER_BYTES, total - HEADER_BYTES));
    *bytes = buffer;
    *size = total;
    return 0;
}
