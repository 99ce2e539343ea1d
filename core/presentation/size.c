#include "core/presentation/size.h"

#include <errno.h>

int iso_size_measure(const struct iso_head_model *model, const struct iso_shape_residuals *head,
                     struct iso_size *out)
{
    struct iso_vec3 a = {0, 0, 0}, b = {0, 0, 0};
    double aa = 0, bb = 0, jj = 0, jr = 0;
    int n = 0;
    for (uint32_t i = 0; i < head->n; i++) {
        if (!(model->region[i] & ISO_HEAD_RIGID)) {
            continue;
        }
        a = iso_add(a, model->mean_mm[i]);
        b = iso_add(b, head->vertex_mm[i]);
        n++;
    }
    if (n == 0) {
        return -ENODATA;
    }
    a = iso_scale(1.0 / n, a);
    b = iso_scale(1.0 / n, b);
    for (uint32_t i = 0; i < head->n; i++) {
        if (model->region[i] & ISO_HEAD_RIGID) {
            struct iso_vec3 d = iso_sub(model->mean_mm[i], a), e = iso_sub(head->vertex_mm[i], b);
            aa += iso_dot(d, d);
            bb += iso_dot(e, e);
        }
    }
    (void)jj;
    (void)jr;
    out->scale = sqrt(bb / aa);
    out->residual = 0;
    return 0;
}
