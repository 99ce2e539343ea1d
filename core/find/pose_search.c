#include "core/find/pose_search.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>

enum { FINALISTS = 6 };

static const double yaws_rad[3] = {0.0, -0.55, 0.55};
static const double pitches_rad[3] = {0.0, -0.35, 0.35};

/* Poses by rising cost. */
struct ranking {
    int n;
    struct iso_pose_fit fit[FINALISTS];
};

static void rank_insert(struct ranking *ranking, const struct iso_pose_fit *fit)
{
    int at = ranking->n < FINALISTS ? ranking->n++ : FINALISTS;
    for (; at > 0 && ranking->fit[at - 1].cost_mm2 > fit->cost_mm2; at--) {
        if (at < FINALISTS) {
            ranking->fit[at] = ranking->fit[at - 1];
        }
    }
    if (at < FINALISTS) {
        ranking->fit[at] = *fit;
    }
}

/* A face that looks into the camera, turned by yaw and pitch, its nose tip at a point. */
static struct iso_rigid posed_at(struct iso_vec3 nose_mm, double yaw_rad, double pitch_rad)
{
    struct iso_mat3 facing = {{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}}};
    struct iso_mat3 yaw = iso_mat3_rotation(iso_vec3(0, yaw_rad, 0));
    struct iso_mat3 pitch = iso_mat3_rotation(iso_vec3(pitch_rad, 0, 0));
    struct iso_mat3 turned = iso_mat3_mul(&yaw, &pitch);
    return (struct iso_rigid){iso_mat3_mul(&facing, &turned), nose_mm};
}

/* Missing measurements must not make a fit look good. */
static void penalise(struct iso_pose_fit *fit, double coverage_min)
{
    if (fit->coverage < coverage_min) {
        fit->cost_mm2 += 36.0 * (coverage_min - fit->coverage);
    }
}

static void try_candidate(const struct iso_pose_vertices *vertices, const struct iso_frame *frame,
                          struct iso_vec3 nose_mm, double coverage_min, struct ranking *ranking)
{
    const struct iso_pose_options rough = {
        .iterations = 5,
        .cutoff_first_mm = 35.0,
        .cutoff_last_mm = 15.0,
        .nose_sigma_mm = 8.0,
        .nose_mm = nose_mm,
    };
    for (int y = 0; y < 3; y++) {
        for (int p = 0; p < 3; p++) {
            struct iso_rigid start = posed_at(nose_mm, yaws_rad[y], pitches_rad[p]);
            struct iso_pose_fit fit;
            if (iso_pose_fit(vertices, frame, &rough, &start, &fit) == 0) {
                penalise(&fit, coverage_min);
                rank_insert(ranking, &fit);
            }
        }
    }
}

/* Refines the finalists and takes the best; false if there is none. */
static bool best_of(const struct iso_pose_vertices *vertices, const struct iso_frame *frame,
                    const struct ranking *ranking, double coverage_min, struct iso_pose_fit *best)
{
    const struct iso_pose_options fine = {
        .iterations = 10, .cutoff_first_mm = 15.0, .cutoff_last_mm = 8.0};
    bool found = false;
    for (int i = 0; i < ranking->n; i++) {
        struct iso_pose_fit fit;
        if (iso_pose_fit(vertices, frame, &fine, &ranking->fit[i].camera_from_face, &fit)) {
            continue;
        }
        penalise(&fit, coverage_min);
        if (!found || fit.cost_mm2 < best->cost_mm2) {
            *best = fit;
            found = true;
        }
    }
    return found;
}

int iso_pose_search(const struct iso_pose_vertices *vertices, const struct iso_frame *frame,
                    const struct iso_candidate *candidates, int n_candidates,
                    const struct iso_pose_search_options *options, struct iso_pose_fit *out,
                    double *best_cost_mm2)
{
    double best_cost = INFINITY;
    int error = -ENOENT;
    for (int i = 0; i < n_candidates && error;) {
        struct ranking ranking = {0};
        int part = candidates[i].part;
        for (; i < n_candidates && candidates[i].part == part; i++) {
            try_candidate(vertices, frame, candidates[i].point_mm, options->coverage_min, &ranking);
        }
        struct iso_pose_fit best;
        if (!best_of(vertices, frame, &ranking, options->coverage_min, &best)) {
            continue;
        }
        best_cost = fmin(best_cost, best.cost_mm2);
        if (best.cost_mm2 <= options->cost_max_mm2) {
            *out = best;
            error = 0;
        }
    }
    if (best_cost_mm2) {
        *best_cost_mm2 = best_cost;
    }
    return error;
}
