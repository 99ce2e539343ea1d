#include "isotherm/template.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/bytes.h"
#include "core/base/crc32.h"
#include "core/match/template_fuse.h"
#include "core/match/template_points.h"
#include "core/match/upper_face.h"
#include "core/registration/icp.h"

static const char magic[4] = {'I', 'S', 'O', 'T'};

enum {
    HEADER_BYTES = 4 + 4 * 2 + 4 + ISO_TEMPLATE_SENSOR_MAX + 4,
    SENSOR_BYTES = ISO_TEMPLATE_SENSOR_MAX,
    SENSOR_AT = 4 + 4 * 2 + 4,
    QUALITY_AT = SENSOR_AT + SENSOR_BYTES,
    POINT_BYTES = 7,
    POINT_MAX_MM = 511,
    COUNTS_PER_MM = 64,
    LEARNED = 0x8000, /* bit of the number of frames */
};

static bool counts_in_range(unsigned n_radii, unsigned n_points, unsigned n_frames)
{
    return n_radii >= 1 && n_radii <= ISO_TEMPLATE_RADII_MAX && n_points >= 4 &&
           n_points <= ISO_TEMPLATE_POINTS_MAX && n_frames >= 1 &&
           n_frames <= ISO_TEMPLATE_FRAMES_MAX;
}

/* The size of everything before the length of the upper face. */
static size_t curves_size(unsigned n_radii, unsigned n_points)
{
    return HEADER_BYTES + 4 * n_radii + (size_t)POINT_BYTES * n_radii * ISO_LANDMARKS * n_points;
}

static bool point_fits(const float point_mm[3], float weight)
{
    bool fits = weight >= 0.0f && weight <= 1.0f;
    for (int k = 0; k < 3; k++) {
        fits = fits && fabsf(point_mm[k]) <= (float)POINT_MAX_MM; /* false for NaN */
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

/* Whether the curves in these bytes are in range. */
static bool curves_fit(const uint8_t *p, int n_radii, int n_points)
{
    bool fit = true;
    for (int r = 0; r < n_radii; r++, p += 4) {
        fit = fit && isfinite(iso_get_f32(p));
    }
    for (int i = 0; i < n_points; i++, p += POINT_BYTES) {
        for (int k = 0; k < 3; k++) {
            fit = fit && abs((int16_t)iso_get_u16(p + 2 * k)) <= POINT_MAX_MM * COUNTS_PER_MM;
        }
    }
    return fit;
}

static void get_curves(const uint8_t *p, struct iso_template *t)
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
}

/* The facts that the header holds. */
static struct iso_template_facts facts_of(const uint8_t *p)
{
    return (struct iso_template_facts){
        .algorithm = iso_get_u32(p + 12),
        .n_radii = iso_get_u16(p + 6),
        .n_points = iso_get_u16(p + 8),
        .n_frames = iso_get_u16(p + 10) & ISO_TEMPLATE_FRAMES_MAX,
        .learned = (iso_get_u16(p + 10) & LEARNED) != 0,
    };
}

/* Whether the bytes have the size that they state, and are not damaged. */
static bool bytes_whole(const uint8_t *bytes, size_t size, const struct iso_template_facts *facts)
{
    const size_t curves = curves_size(facts->n_radii, facts->n_points);
    return size >= curves + 2 + 4 && size == curves + 2 + (size_t)iso_get_u16(bytes + curves) + 4 &&
           iso_get_u32(bytes + size - 4) == iso_crc32(0, bytes, size - 4);
}

/* Checks everything, and reads the upper face into *upper: all zero if there is none. */
static int check_bytes(const uint8_t *p, size_t size, struct iso_template_facts *facts,
                       struct iso_upper_face *upper)
{
    if (size < HEADER_BYTES + 4 || memcmp(p, magic, sizeof magic) != 0) {
        return -EBADMSG;
    }
    if (iso_get_u16(p + 4) != ISO_TEMPLATE_VERSION) {
        return -EPROTONOSUPPORT;
    }
    *facts = facts_of(p);
    if (!counts_in_range(facts->n_radii, facts->n_points, facts->n_frames) ||
        !bytes_whole(p, size, facts)) {
        return -EBADMSG;
    }
    /* The checksum is right: if one of these checks fails, the writer made a mistake. */
    const int n_points = facts->n_radii * ISO_LANDMARKS * facts->n_points;
    if (!isfinite(iso_get_f32(p + QUALITY_AT)) || !memchr(p + SENSOR_AT, '\0', SENSOR_BYTES) ||
        !curves_fit(p + HEADER_BYTES, facts->n_radii, n_points)) {
        return -EBADMSG;
    }
    const uint8_t *block = p + curves_size(facts->n_radii, facts->n_points);
    const size_t upper_size = iso_get_u16(block);
    memset(upper, 0, sizeof *upper);
    return upper_size > 0 ? iso_upper_face_get(block + 2, upper_size, upper) : 0;
}

int iso_template_check(const void *bytes, size_t size, struct iso_template_facts *out)
{
    struct iso_template_facts facts;
    struct iso_upper_face upper;
    const int error = check_bytes(bytes, size, &facts, &upper);
    explicit_bzero(&upper, sizeof upper);
    if (!error) {
        *out = facts;
    }
    return error;
}

int iso_template_parse(const void *bytes, size_t size, struct iso_template *out)
{
    const uint8_t *p = bytes;
    struct iso_template_facts facts;
    struct iso_upper_face upper;
    const int error = check_bytes(p, size, &facts, &upper);
    if (!error) {
        memset(out, 0, sizeof *out);
        out->algorithm = facts.algorithm;
        out->n_radii = facts.n_radii;
        out->n_points = facts.n_points;
        out->n_frames = facts.n_frames;
        out->learned = facts.learned;
        memcpy(out->sensor, p + SENSOR_AT, sizeof out->sensor);
        out->quality = iso_get_f32(p + QUALITY_AT);
        get_curves(p + HEADER_BYTES, out);
        out->upper = upper;
    }
    explicit_bzero(&upper, sizeof upper);
    return error;
}

void iso_template_wipe(struct iso_template *tmpl)
{
    explicit_bzero(tmpl, sizeof *tmpl);
}

/* The result of a registration by ISO_ICP_RIGID as a rigid motion. */
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

enum { FUSED_MAX = ISO_UPPER_FUSED_MAX };

/* The templates that are fused, and the motions that take each to the first. */
struct fusion {
    int n;
    const struct iso_template *const *templates;
    struct iso_affine first_from[FUSED_MAX];
    struct iso_rigid rigid[FUSED_MAX]; /* the same */
};

static int register_all(struct iso_icp_workspace *work, struct fusion *fusion)
{
    const struct iso_icp_options options = iso_template_icp_options(0.8, 10);
    const struct iso_template *first = fusion->templates[0];
    const struct iso_icp_points to = iso_template_points(first);
    for (int i = 0; i < fusion->n; i++) {
        const struct iso_template *t = fusion->templates[i];
        if (!iso_template_comparable(t, first)) {
            return -EINVAL;
        }
        struct iso_icp_result registered = {.target_from_source = iso_affine_identity()};
        const struct iso_icp_points points = iso_template_points(t);
        const int error = i > 0 ? iso_icp(work, &points, &to, &options, &registered) : 0;
        if (error) {
            return error;
        }
        fusion->first_from[i] = registered.target_from_source;
        fusion->rigid[i] = rigid_of(&registered.target_from_source);
    }
    return 0;
}

/* The mean of one point by weight. */
static void fuse_point(const struct fusion *fusion, int r, int l, int i, struct iso_template *out)
{
    double sum_mm[3] = {0.0, 0.0, 0.0}, total = 0.0;
    for (int k = 0; k < fusion->n; k++) {
        const struct iso_template *t = fusion->templates[k];
        const float *q = t->points_mm[r][l][i];
        const struct iso_vec3 p = iso_affine_apply(
            &fusion->first_from[k], iso_vec3((double)q[0], (double)q[1], (double)q[2]));
        const double w = (double)t->weight[r][l][i];
        sum_mm[0] += w * p.x;
        sum_mm[1] += w * p.y;
        sum_mm[2] += w * p.z;
        total += w;
    }
    for (int k = 0; k < 3; k++) {
        out->points_mm[r][l][i][k] = total > 0.0 ? (float)(sum_mm[k] / total) : 0.0f;
    }
    out->weight[r][l][i] = (float)fmin(total / fusion->n, 1.0);
}

static void fuse_all(const struct fusion *fusion, struct iso_template *out)
{
    const struct iso_upper_face *upper[FUSED_MAX];
    double quality = 0.0;
    unsigned frames = 0;
    *out = *fusion->templates[0];
    for (int k = 0; k < fusion->n; k++) {
        upper[k] = &fusion->templates[k]->upper;
        quality += (double)fusion->templates[k]->quality;
        frames += fusion->templates[k]->n_frames;
    }
    out->n_frames = (uint16_t)(frames < ISO_TEMPLATE_FRAMES_MAX ? frames : ISO_TEMPLATE_FRAMES_MAX);
    out->learned = false;
    out->quality = (float)(quality / fusion->n);
    for (int r = 0; r < out->n_radii; r++) {
        for (int l = 0; l < ISO_LANDMARKS; l++) {
            for (int i = 0; i < out->n_points; i++) {
                fuse_point(fusion, r, l, i, out);
            }
        }
    }
    iso_upper_face_fuse(upper, fusion->rigid, fusion->n, &out->upper);
}

int iso_template_fuse(struct iso_icp_workspace *work, const struct iso_template *const *templates,
                      int n, struct iso_template *out)
{
    if (n < 1 || n > FUSED_MAX) {
        return -EINVAL;
    }
    struct fusion fusion = {.n = n, .templates = templates};
    const int error = register_all(work, &fusion);
    explicit_bzero(work, sizeof *work);
    if (!error) { /* nothing fails from here on */
        fuse_all(&fusion, out);
    }
    return error;
}
