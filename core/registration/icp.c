#include "core/registration/icp.h"

#include <errno.h>
#include <stdint.h>

#include "core/registration/rigid.h"

static struct iso_vec3 point_of(const struct iso_icp_points *points, int i)
{
    return iso_vec3((double)points->point_mm[i][0], (double)points->point_mm[i][1],
                    (double)points->point_mm[i][2]);
}

/* Index of the present target point nearest to p in the group that starts at `first`, or -1. */
static int nearest_in_group(const struct iso_icp_points *target, int first, struct iso_vec3 p)
{
    int best = -1;
    double best_squared = INFINITY;
    for (int i = first; i < first + target->n_per_group; i++) {
        if (!(target->weight[i] > 0.0f)) {
            continue;
        }
        const struct iso_vec3 d = iso_sub(point_of(target, i), p);
        const double squared = iso_dot(d, d);
        if (squared < best_squared) {
            best_squared = squared;
            best = i;
        }
    }
    return best;
}

static void make_pairs(const struct iso_icp_points *source, const struct iso_icp_points *target,
                       const struct iso_affine *target_from_source,
                       const struct iso_icp_options *options, enum iso_icp_pairing pairing,
                       struct iso_icp_workspace *pairs)
{
    pairs->n = 0;
    for (int i = 0; i < source->n_groups * source->n_per_group; i++) {
        const double group_weight = options->group_weight
                                        ? (double)options->group_weight[i / source->n_per_group]
                                        : 1.0;
        if (!(source->weight[i] > 0.0f) || !(group_weight > 0.0)) {
            continue;
        }
        const struct iso_vec3 moved = iso_affine_apply(target_from_source, point_of(source, i));
        const int first = i - i % source->n_per_group;
        const int j = pairing == ISO_ICP_ORDERED ? i : nearest_in_group(target, first, moved);
        if (j < 0 || !(target->weight[j] > 0.0f)) {
            continue;
        }
        const int k = pairs->n++;
        pairs->source[k] = point_of(source, i);
        pairs->target[k] = point_of(target, j);
        pairs->weight[k] = (double)source->weight[i] * (double)target->weight[j] * group_weight;
        pairs->distance[k] = iso_norm(iso_sub(moved, pairs->target[k]));
    }
}

/* The k-th smallest value (k from 0) of a, which is reordered (Hoare 1961). */
static double select_smallest(double *a, int n, int k)
{
    int low = 0, high = n - 1;
    while (low < high) {
        const double pivot = a[(low + high) / 2];
        int i = low, j = high;
        while (i <= j) {
            while (a[i] < pivot) {
                i++;
            }
            while (a[j] > pivot) {
                j--;
            }
            if (i <= j) {
                const double swap = a[i];
                a[i++] = a[j];
                a[j--] = swap;
            }
        }
        if (k <= j) {
            high = j;
        } else if (k >= i) {
            low = i;
        } else {
            break;
        }
    }
    return a[k];
}

/* Keeps the closest share of the pairs; returns their weighted mean distance. */
static double trim_pairs(struct iso_icp_workspace *pairs, double trim)
{
    for (int i = 0; i < pairs->n; i++) {
        pairs->sorted[i] = pairs->distance[i];
    }
    const int kept = (int)ceil(trim * pairs->n);
    const double limit = select_smallest(pairs->sorted, pairs->n, kept - 1);
    double sum = 0.0, total = 0.0;
    for (int i = 0; i < pairs->n; i++) {
        pairs->trimmed[i] = pairs->distance[i] <= limit ? pairs->weight[i] : 0.0;
        sum += pairs->trimmed[i] * pairs->distance[i];
        total += pairs->trimmed[i];
    }
    return sum / total;
}

static int fit_transform(const struct iso_icp_workspace *pairs, enum iso_icp_transform kind,
                         struct iso_affine *target_from_source)
{
    if (kind == ISO_ICP_AFFINE) {
        return iso_affine_fit(pairs->source, pairs->target, pairs->trimmed, pairs->n,
                              target_from_source);
    }
    struct iso_rigid rigid;
    const int error = iso_rigid_fit(pairs->source, pairs->target, pairs->trimmed, pairs->n, &rigid);
    if (!error) {
        *target_from_source = iso_affine_of_rigid(&rigid);
    }
    return error;
}

static int check(const struct iso_icp_points *source, const struct iso_icp_points *target,
                 const struct iso_icp_options *options)
{
    const bool same = source->n_groups == target->n_groups &&
                      source->n_per_group == target->n_per_group;
    bool size = source->n_groups >= 1 && source->n_per_group >= 1 &&
                source->n_groups <= ISO_ICP_POINTS_MAX / source->n_per_group;
    bool sane = options->trim > 0.0 && options->trim <= 1.0 && options->iterations_max >= 1 &&
                options->tolerance_mm >= 0.0;
    return same && size && sane ? 0 : -EINVAL;
}

int iso_icp(struct iso_icp_workspace *work, const struct iso_icp_points *source,
            const struct iso_icp_points *target, const struct iso_icp_options *options,
            struct iso_icp_result *result)
{
    enum { PAIRS_MIN = 12 };
    int error = check(source, target, options);
    if (error) {
        return error;
    }
    struct iso_icp_result found = {.target_from_source = iso_affine_identity()};
    make_pairs(source, target, &found.target_from_source, options, ISO_ICP_ORDERED, work);
    if (work->n < PAIRS_MIN) {
        return -ENODATA;
    }
    found.distance_mm = trim_pairs(work, options->trim);
    while (found.iterations < options->iterations_max && !found.converged) {
        error = fit_transform(work, options->transform, &found.target_from_source);
        if (error) {
            return error;
        }
        make_pairs(source, target, &found.target_from_source, options, options->pairing, work);
        const double distance = trim_pairs(work, options->trim);
        found.converged = fabs(found.distance_mm - distance) < options->tolerance_mm;
        found.distance_mm = distance;
        found.iterations++;
    }
    found.pairs = work->n;
    *result = found;
    return 0;
}
