/* The common part of the files that fit the head model (shape_fit.h): the fitter, and the steps of
 * a fit. Internal to core/landmark. */
#ifndef ISO_CORE_LANDMARK_SHAPE_FITTER_H
#define ISO_CORE_LANDMARK_SHAPE_FITTER_H

#include "core/landmark/meet_many.h"
#include "core/landmark/shape_fit.h"
#include "core/landmark/shape_vertices.h"

enum {
    ISO__SHAPE_POSE = 6, /* unknowns of the pose: three of the turn, then three of the shift */
    ISO__SHAPE_UNKNOWNS_MAX = ISO__SHAPE_POSE + ISO_HEAD_IDENTITY_MAX + ISO_HEAD_EXPRESSION_MAX,
    ISO__SHAPE_MEASURED_MIN = 100, /* the least vertices that must be measured */
};

struct iso_shape_fitter {
    const struct iso_head_model *model;
    struct iso_shape_fit_options options;
    double jaw_sign; /* of the first expression mode when the chin goes down */
    int n_modes, mode_stride;
    float *modes; /* the modes at each vertex, identity first, in the order of `vertex`
                     (shape_vertices.h) */
    /* All vertices: first those that are compared, of which the first few are spread evenly; then
     * their neighbours, which the steps need as well; then the others. The steps read the modes in
     * this order, one after the other, because they are larger than the cache next to a core. */
    uint32_t *vertex;   /* [n_vertices] */
    uint32_t *place;    /* [n_vertices] where a vertex is in `vertex` */
    int n_face, n_near; /* vertices that are compared; these and their neighbours */
    int n_triangles;
    uint32_t (*triangle)[3]; /* [n_triangles] the triangles at compared vertices */
    struct iso_vec3 *shape;  /* [n_vertices] the head as fitted so far, face frame; between steps
                                only the vertices that are near */
    struct iso_vec3 *normal; /* [n_vertices] its unit normals, outward, at the compared vertices */
    struct iso_vec3 *best_shape, *best_normal; /* the same of the best start so far */
    struct iso_vec3 *start_mm; /* [jaws][2][n_vertices] shape and normal where the fits begin */
    int given_up;              /* starts of the last fit that were given up, because they lagged */
    struct iso_vec3 *fitted;   /* [n_vertices] the last fit, with its expression */
    float *residual_mm;        /* [n_vertices] of the last fit */
    uint8_t *meeting;          /* [n_vertices] */
    float *rows;  /* [n_face][iso_gram_stride(ISO__SHAPE_UNKNOWNS_MAX + 1)] of the Jacobian, and
                     residuals */
    double *gram; /* [ISO__SHAPE_UNKNOWNS_MAX + 1][ISO__SHAPE_UNKNOWNS_MAX + 1] of the rows */
    double *h;    /* [ISO__SHAPE_UNKNOWNS_MAX][ISO__SHAPE_UNKNOWNS_MAX] normal equations, lower
                     triangle; after a step their factor */
};

/* The state of a fit. */
struct iso__shape_state {
    struct iso_rigid pose;
    double coefficient[ISO_HEAD_IDENTITY_MAX + ISO_HEAD_EXPRESSION_MAX]; /* identity first */
};

/* What a step solves for. */
struct iso__shape_unknowns {
    int n_vertices, n; /* most vertices that are compared; unknowns: the pose, or pose and modes */
    double cutoff_mm;  /* Tukey's cut-off */
};

/* Mode k of the model, identity first, as [n_vertices][3]. */
const float *iso__shape_mode(const struct iso_head_model *model, uint32_t k);

/* The modes at a vertex: how far mode k moves it along x is at iso_shape_mode_at(k)
 * (shape_vertices.h). */
static inline float *iso__shape_modes_at(const struct iso_shape_fitter *f, uint32_t vertex)
{
    return &f->modes[iso_shape_modes_of(f->place[vertex], f->mode_stride)];
}

/* Sets the vertices of f->shape at the places `first` to end - 1 to those of the head with the
 * first n_modes coefficients; the others count as 0. It may set others of their groups as well. */
void iso__shape_make(struct iso_shape_fitter *f, const double *coefficient, int n_modes, int first,
                     int end);

/* Sets f->shape and f->normal to those of the state, where the steps need them. */
void iso__shape_set(struct iso_shape_fitter *f, const struct iso__shape_state *state);

/* Compares the vertices f->vertex[first] to f->vertex[end - 1], at most ISO_MEET_MANY, with the
 * frame. Returns how many. */
int iso__shape_meet(const struct iso_shape_fitter *f, const struct iso_frame *frame,
                    const struct iso_rigid *pose, int first, int end, double cutoff_mm,
                    struct iso_meetings *out);

/* One step of Gauss-Newton. -ENODATA if too few vertices are measured, or if they do not fix the
 * unknowns. */
int iso__shape_step(struct iso_shape_fitter *f, const struct iso_frame *frame,
                    const struct iso__shape_unknowns *unknowns, struct iso__shape_state *state)
    __attribute__((warn_unused_result));

/* Compares the head with the frame vertex by vertex: sets f->meeting, f->residual_mm and *out. */
void iso__shape_measure(struct iso_shape_fitter *f, const struct iso_frame *frame,
                        const struct iso_rigid *pose, struct iso_pose_fit *out);

/* Fills in *out after a step with all unknowns. f->fitted becomes the fitted head, and f->shape at
 * the landmarks the head without its expression; other vertices of f->shape may change. */
void iso__shape_report(struct iso_shape_fitter *f, const struct iso_frame *frame,
                       const struct iso__shape_state *state, struct iso_shape_fit *out);

#endif
