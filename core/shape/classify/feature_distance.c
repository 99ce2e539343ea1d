#include "core/shape/classify/feature_distance.h"

#include <errno.h>
#include <math.h>
#include <stddef.h>

#include "core/shape/partial/local_heat.h"
#include "core/shape/partial/partial_distance.h"

static double l1(const float *a, const float *b, int32_t n)
{
    double sum = 0.0;
    for (int32_t i = 0; i < n; i++) {
        sum += fabs((double)a[i] - (double)b[i]);
    }
    return sum;
}

static double l2(const float *a, const float *b, int32_t n)
{
    double sum = 0.0;
    for (int32_t i = 0; i < n; i++) {
        sum += ((double)a[i] - (double)b[i]) * ((double)a[i] - (double)b[i]);
    }
    return sqrt(sum);
}

int iso_feature_distances(const struct iso_feature_layout *layout, enum iso_norm norm,
                          const float *feature, const float *item, int32_t n, int32_t left,
                          double *distance)
{
    struct iso_partial_query *query = NULL;
    if (norm == ISO_NORM_PARTIAL) {
        const int error = iso_is_local_heat(layout) ? iso_partial_query_new(feature, &query)
                                                    : -EINVAL;
        if (error) {
            return error;
        }
    }
    for (int32_t i = 0; i < n; i++) {
        const float *other = &item[(size_t)i * (size_t)layout->size];
        if (i == left) {
            distance[i] = 0.0;
        } else if (query) {
            distance[i] = iso_partial_distance(query, other, NULL);
        } else {
            distance[i] = (norm == ISO_NORM_L1 ? l1 : l2)(feature, other, layout->size);
        }
    }
    iso_partial_query_free(query);
    return 0;
}
