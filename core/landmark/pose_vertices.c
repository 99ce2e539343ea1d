#include "core/landmark/pose_fit.h"

#include <errno.h>
#include <stdlib.h>

#include "core/landmark/meet_many.h"
#include "core/landmark/normals.h"
#include "core/landmark/spread.h"

static struct iso_pose_vertices *vertices_alloc(size_t n)
{
    struct iso_pose_vertices *v = calloc(1, sizeof *v);
    if (v) {
        v->points = calloc((n + ISO_MEET_MANY - 1) / ISO_MEET_MANY, sizeof *v->points);
        v->weight = calloc(n, sizeof *v->weight);
    }
    if (v && v->points && v->weight) {
        return v;
    }
    iso_pose_vertices_free(v);
    return NULL;
}

int iso_pose_vertices_new(const struct iso_head_model *model, int count, double soft_weight,
                          struct iso_pose_vertices **out)
{
    int available = 0;
    for (uint32_t i = 0; i < model->n_vertices; i++) {
        available += (model->region[i] & ISO_HEAD_FACE) != 0;
    }
    if (available == 0 || count < 0 || soft_weight < 0.0) {
        return -EINVAL;
    }
    int n = count == 0 || count > available ? available : count;
    struct iso_pose_vertices *v = vertices_alloc((size_t)n);
    struct iso_vec3 *normal = calloc(model->n_vertices, sizeof *normal);
    uint32_t *order = calloc(model->n_vertices, sizeof *order);
    const int error = v && normal && order ? iso_head_spread(model, n, order, &n) : -ENOMEM;
    if (error) {
        free(order);
        free(normal);
        iso_pose_vertices_free(v);
        return error;
    }
    iso_head_normals(model, model->mean_mm, normal);
    for (v->n = 0; v->n < n; v->n++) {
        const uint32_t i = order[v->n];
        iso_meet_points_set(&v->points[v->n / ISO_MEET_MANY], v->n % ISO_MEET_MANY,
                            model->mean_mm[i], normal[i]);
        v->weight[v->n] = model->region[i] & ISO_HEAD_RIGID ? 1.0 : soft_weight;
    }
    free(order);
    free(normal);
    *out = v;
    return 0;
}

void iso_pose_vertices_free(struct iso_pose_vertices *vertices)
{
    if (vertices) {
        free(vertices->points);
        free(vertices->weight);
        free(vertices);
    }
}
