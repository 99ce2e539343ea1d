#include "core/match/template.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "core/match/icp.h"
#include "core/match/template_points.h"
#include "core/math/bytes.h"
#include "core/math/crc32.h"

static const char magic[4] = {'I', 'S', 'O', 'T'};

enum {
    HEADER_BYTES = 4 + 4 * 2 + 4 + ISO_TEMPLATE_SENSOR_MAX + 4,
    POINT_BYTES = 7,
    COUNTS_PER_MM = 64,
    LEARNED = 0x8000, /* bit of the number of frames */
};

static bool counts_in_range(unsigned n_radii, unsigned n_points, unsigned n_frames)
{
    return n_radii >= 1 && n_radii <= ISO_TEMPLATE_RADII_MAX && n_points >= 4 &&
           n_points <= ISO_TEMPLATE_POINTS_MAX && n_frames >= 1 &&
           n_frames <= ISO_TEMPLATE_FRAMES_MAX;
}

/* Up to the length of the upper face. */
static size_t curves_size(unsigned n_radii, unsigned n_points)
{
    return HEADER_BYTES + 4 * n_radii + (size_t)POINT_BYTES * n_radii * ISO_LANDMARKS * n_points;
}

static bool point_fits(const float point_mm[3], float weight)
{
    bool fits = weight >= 0.0f && weight <= 1.0f;
    for (int k = 0; k < 3; k++) {
        fits = fits && fabsf(point_mm[k]) <= 511.0f; /* false for NaN */
    }
    return fits;
}

static bool template_fits(const struct iso_template *t)
{
    if (!counts_in_range(t->n_radii, t->n_points, t->n_frames) || !isfinite(t->quality) ||
        memchr(t->sensor, '\0', sizeof t->sensor) == NULL || !iso_upper_face_fits(&t->upper)) {
        return false;
    }
    for (int r = 0; r < t->n_radii; r++) {
        if (!isfinite(t->radius_mm[r])) {
            return false;
        }
        for (int l = 0; l < ISO_LANDMARKS; l++) {
            for (int i = 0; i < t->n_points; i++) {
                if (!point_fits(t->points_mm[r][l][i], t->weight[r][l][i])) {
                    return false;
                }
            }
        }
    }
    return true;
}

static uint8_t *put_curves(const struct iso_template *t, uint8_t *p)
{
    p = iso_put_bytes(p, magic, sizeof magic);
    p = iso_put_u16(p, ISO_TEMPLATE_VERSION);
    p = iso_put_u16(p, t->n_radii);
    p = iso_put_u16(p, t->n_points);
    p = iso_put_u16(p, (uint16_t)(t->n_frames | (t->learned ? LEARNED : 0)));
    p = iso_put_u32(p, t->algorithm);
    p = iso_put_bytes(p, t->sensor, sizeof t->sensor);
    p = iso_put_f32(p, t->quality);
    for (int r = 0; r < t->n_radii; r++) {
        p = iso_put_f32(p, t->radius_mm[r]);
    }
    for (int r = 0; r < t->n_radii; r++) {
        for (int l = 0; l < ISO_LANDMARKS; l++) {
            for (int i = 0; i < t->n_points; i++) {
                for (int k = 0; k < 3; k++) {
                    long counts = lrintf(t->points_mm[r][l][i][k] * COUNTS_PER_MM);
                    p = iso_put_u16(p, (uint16_t)(int16_t)counts);
                }
                *p++ = (uint8_t)lrintf(t->weight[r][l][i] * 255.0f);
            }
        }
    }
    return p;
}

int iso_template_serialise(const struct iso_template *t, void *bytes, size_t size)
{
    if (!template_fits(t)) {
        return -EINVAL;
    }
    uint8_t upper[ISO_UPPER_BYTES_MAX];
    const size_t upper_size = iso_upper_face_known(&t->upper) ? iso_upper_face_put(&t->upper, upper)
                                                              : 0;
    const size_t needed = curves_size(t->n_radii, t->n_points) + 2 + upper_size + 4;
    if (size < needed) {
        explicit_bzero(upper, sizeof upper);
        return -ENOSPC;
    }
    uint8_t *p = put_curves(t, bytes);
    p = iso_put_u16(p, (uint16_t)upper_size);
    p = iso_put_bytes(p, upper, upper_size);
    (void)iso_put_u32(p, iso_crc32(0, bytes, needed - 4));
    explicit_bzero(upper, sizeof upper);
    return (int)needed;
}

static const uint8_t *get_curves(const uint8_t *p, struct iso_template *t)
{
    for (int r = 0; r < t->n_radii; r++, p += 4) {
        t->radius_mm[r] = iso_get_f32(p);
    }
    for (int r = 0; r < t->n_radii; r++) {
        for (int l = 0; l < ISO_LANDMARKS; l++) {
            for (int i = 0; i < t->n_points; i++, p += POINT_BYTES) {
                for (int k = 0; k < 3; k++) {
                    int16_t counts = (int16_t)iso_get_u16(p + 2 * k);
                    t->points_mm[r][l][i][k] = (float)counts / COUNTS_PER_MM;
                }
                t->weight[r][l][i] = (float)p[6] / 255.0f;
            }
        }
    }
    return p;
}

/* Whether the bytes are as many as they say, and as they were written. */
static bool bytes_whole(const uint8_t *bytes, size_t size, const struct iso_template *t)
{
    const size_t curves = curves_size(t->n_radii, t->n_points);
    return size >= curves + 2 + 4 && size == curves + 2 + (size_t)iso_get_u16(bytes + curves) + 4 &&
           iso_get_u32(bytes + size - 4) == iso_crc32(0, bytes, size - 4);
}

int iso_template_parse(const void *bytes, size_t size, struct iso_template *out)
{
    const uint8_t *p = bytes;
    if (size < HEADER_BYTES + 4 || memcmp(p, magic, sizeof magic) != 0) {
        return -EBADMSG;
    }
    if (iso_get_u16(p + 4) != ISO_TEMPLATE_VERSION) {
        return -EPROTONOSUPPORT;
    }
    struct iso_template t;
    memset(&t, 0, sizeof t);
    t.n_radii = iso_get_u16(p + 6);
    t.n_points = iso_get_u16(p + 8);
    t.n_frames = iso_get_u16(p + 10) & ISO_TEMPLATE_FRAMES_MAX;
    t.learned = (iso_get_u16(p + 10) & LEARNED) != 0;
    if (!counts_in_range(t.n_radii, t.n_points, t.n_frames) || !bytes_whole(p, size, &t)) {
        return -EBADMSG;
    }
    t.algorithm = iso_get_u32(p + 12);
    memcpy(t.sensor, p + 16, sizeof t.sensor);
    p += 16 + sizeof t.sensor;
    t.quality = iso_get_f32(p);
    p = get_curves(p + 4, &t);
    const size_t upper_size = iso_get_u16(p);
    int error = upper_size > 0 ? iso_upper_face_get(p + 2, upper_size, &t.upper) : 0;
    /* The checksum was right, so the writer wrote nonsense: still not a template. */
    error = error || template_fits(&t) ? error : -EBADMSG;
    if (!error) {
        *out = t;
    }
    iso_template_wipe(&t);
    return error;
}

void iso_template_wipe(struct iso_template *tmpl)
{
    explicit_bzero(tmpl, sizeof *tmpl);
}

/* Sums of weight * point and weight over the templates registered to the first. */
struct fusion {
    double sum_mm[ISO_TEMPLATE_RADII_MAX][ISO_LANDMARKS][ISO_TEMPLATE_POINTS_MAX][3];
    double weight[ISO_TEMPLATE_RADII_MAX][ISO_LANDMARKS][ISO_TEMPLATE_POINTS_MAX];
};

static void fusion_add(struct fusion *fusion, const struct iso_template *t,
                       const struct iso_affine *first_from_this)
{
    for (int r = 0; r < t->n_radii; r++) {
        for (int l = 0; l < ISO_LANDMARKS; l++) {
            for (int i = 0; i < t->n_points; i++) {
                const float *q = t->points_mm[r][l][i];
                struct iso_vec3 p = iso_affine_apply(
                    first_from_this, iso_vec3((double)q[0], (double)q[1], (double)q[2]));
                double w = (double)t->weight[r][l][i];
                fusion->sum_mm[r][l][i][0] += w * p.x;
                fusion->sum_mm[r][l][i][1] += w * p.y;
                fusion->sum_mm[r][l][i][2] += w * p.z;
                fusion->weight[r][l][i] += w;
            }
        }
    }
}

static void fusion_finish(const struct fusion *fusion, int n, struct iso_template *out)
{
    for (int r = 0; r < out->n_radii; r++) {
        for (int l = 0; l < ISO_LANDMARKS; l++) {
            for (int i = 0; i < out->n_points; i++) {
                double w = fusion->weight[r][l][i];
                for (int k = 0; k < 3; k++) {
                    out->points_mm[r][l][i][k] = w > 0.0 ? (float)(fusion->sum_mm[r][l][i][k] / w)
                                                         : 0.0f;
                }
                out->weight[r][l][i] = (float)fmin(w / n, 1.0);
            }
        }
    }
}

/* What a registration by ISO_ICP_RIGID found. */
static struct iso_rigid rigid_of(const struct iso_affine *a)
{
    struct iso_rigid rigid;
    for (int row = 0; row < 3; row++) {
        for (int column = 0; column < 3; column++) {
            rigid.rotation.m[row][column] = a->m[row][column];
        }
    }
    rigid.translation_mm = iso_vec3(a->m[0][3], a->m[1][3], a->m[2][3]);
    return rigid;
}

int iso_template_fuse(const struct iso_template *const *templates, int n, struct iso_template *out)
{
    enum { FUSED_MAX = 64 };
    if (n < 1 || n > FUSED_MAX) {
        return -EINVAL;
    }
    struct iso_icp_options options = iso_template_icp_options(0.8, 10);
    struct iso_icp_points first = iso_template_points(templates[0]);
    struct fusion fusion;
    memset(&fusion, 0, sizeof fusion);
    const struct iso_upper_face *upper[FUSED_MAX];
    struct iso_rigid first_from_face[FUSED_MAX];
    double quality = 0.0;
    unsigned frames = 0;
    int error = 0;
    for (int i = 0; i < n && !error; i++) {
        if (!iso_template_comparable(templates[i], templates[0])) {
            error = -EINVAL;
            break;
        }
        struct iso_icp_points points = iso_template_points(templates[i]);
        struct iso_icp_result registered = {.target_from_source = iso_affine_identity()};
        if (i > 0) {
            error = iso_icp(&points, &first, &options, &registered);
        }
        if (!error) {
            fusion_add(&fusion, templates[i], &registered.target_from_source);
            upper[i] = &templates[i]->upper;
            first_from_face[i] = rigid_of(&registered.target_from_source);
            quality += (double)templates[i]->quality;
            frames += templates[i]->n_frames;
        }
    }
    if (!error) {
        struct iso_template fused = *templates[0];
        fused.n_frames = (uint16_t)(frames < ISO_TEMPLATE_FRAMES_MAX ? frames
                                                                     : ISO_TEMPLATE_FRAMES_MAX);
        fused.learned = false;
        fused.quality = (float)(quality / n);
        fusion_finish(&fusion, n, &fused);
        iso_upper_face_fuse(upper, first_from_face, n, &fused.upper);
        *out = fused;
        iso_template_wipe(&fused);
    }
    explicit_bzero(&fusion, sizeof fusion);
    return error;
}
