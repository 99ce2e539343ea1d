#include "core/landmark/occlusion.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

/* How far the parts reach from their landmarks, mm. */
static const double eye_reach_mm = 20.0, mouth_reach_mm = 26.0, nose_half_width_mm = 18.0;
static const double side_from_mm = 12.0;

/* A vertex is covered if it lies further than this behind the surface. Less may be an error of the
 * fit. */
static const double before_mm = 10.0;

/* A part with fewer visible vertices is not judged. */
enum { VERTICES_MIN = 8 };

enum {
    BROW_IBUG = 19,
    NASION_IBUG = 27,
    SUBNASALE_IBUG = 33,
    EYES_IBUG = 36,
    EYE_POINTS = 6,
    MOUTH_R_IBUG = 48,
    MOUTH_L_IBUG = 54,
};

const char *iso_face_part_name(enum iso_face_part part)
{
    static const char *const names[ISO_FACE_PARTS] = {
        "brow", "eyes", "nose", "mouth", "left", "right",
    };
    return (unsigned)part < ISO_FACE_PARTS ? names[part] : NULL;
}

static struct iso_vec3 ibug(const struct iso_head_model *model, int index)
{
    return iso_head_point_on(model, model->mean_mm, model->landmarks[index]);
}

static struct iso_vec3 middle_of_eye(const struct iso_head_model *model, int eye)
{
    struct iso_vec3 sum = {0, 0, 0};
    for (int k = 0; k < EYE_POINTS; k++) {
        sum = iso_add(sum, ibug(model, EYES_IBUG + eye * EYE_POINTS + k));
    }
    return iso_scale(1.0 / EYE_POINTS, sum);
}

static double apart_mm(struct iso_vec3 a, struct iso_vec3 b)
{
    return hypot(a.x - b.x, a.y - b.y); /* as seen from the front */
}

void iso_face_parts_of(const struct iso_head_model *model, uint8_t *parts)
{
    const struct iso_vec3 eye[2] = {middle_of_eye(model, 0), middle_of_eye(model, 1)};
    const struct iso_vec3 mouth = iso_scale(
        0.5, iso_add(ibug(model, MOUTH_R_IBUG), ibug(model, MOUTH_L_IBUG)));
    const double brow_mm = ibug(model, BROW_IBUG).y, nose_top_mm = ibug(model, NASION_IBUG).y,
                 nose_end_mm = ibug(model, SUBNASALE_IBUG).y;
    for (uint32_t i = 0; i < model->n_vertices; i++) {
        struct iso_vec3 p = model->mean_mm[i];
        const bool eyes = apart_mm(p, eye[0]) < eye_reach_mm || apart_mm(p, eye[1]) < eye_reach_mm;
        const bool at_nose = fabs(p.x) < nose_half_width_mm && p.y <= nose_top_mm &&
                             p.y >= nose_end_mm;
        const bool at_mouth = apart_mm(p, mouth) < mouth_reach_mm;
        const bool aside = !at_nose && !at_mouth;
        const int bits = (p.y >= brow_mm) << ISO_PART_BROW | eyes << ISO_PART_EYES |
                         at_nose << ISO_PART_NOSE | at_mouth << ISO_PART_MOUTH |
                         (aside && p.x > side_from_mm) << ISO_PART_LEFT |
                         (aside && p.x < -side_from_mm) << ISO_PART_RIGHT;
        parts[i] = model->region[i] & ISO_HEAD_FACE ? (uint8_t)bits : 0;
    }
}

struct iso_occlusion iso_occlusion_measure(const struct iso_shape_residuals *head,
                                           const uint8_t *parts)
{
    struct iso_occlusion out = {.rest_mm2 = 0.0};
    int seen[ISO_FACE_PARTS] = {0}, covered[ISO_FACE_PARTS] = {0}, bare = 0;
    for (uint32_t i = 0; i < head->n; i++) {
        enum iso_meeting meeting = (enum iso_meeting)head->meeting[i];
        if (meeting != ISO_MEETING_MEASURED && meeting != ISO_MEETING_UNMEASURED) {
            continue;
        }
        const bool is_covered = meeting == ISO_MEETING_UNMEASURED ||
                                (double)head->residual_mm[i] < -before_mm;
        if (!is_covered) {
            const double r = (double)head->residual_mm[i];
            out.rest_mm2 += fmin(r * r, ISO_POSE_COST_LIMIT_MM2);
            bare++;
        }
        for (int part = 0; part < ISO_FACE_PARTS; part++) {
            if (parts[i] & (1 << part)) {
                seen[part]++;
                covered[part] += is_covered;
            }
        }
    }
    out.rest_mm2 = bare > 0 ? out.rest_mm2 / bare : ISO_POSE_COST_LIMIT_MM2;
    for (int part = 0; part < ISO_FACE_PARTS; part++) {
        if (seen[part] >= VERTICES_MIN) {
            out.covered[part] = (double)covered[part] / seen[part];
        }
    }
    return out;
}
