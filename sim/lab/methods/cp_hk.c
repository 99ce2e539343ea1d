/* CP-HK of the face crop (Abdelrahman 2013, 4.3.3; core/shape): measures how well a description
 * for creatures works on faces, alone or as a filter before a finer comparison. */
#include <math.h>

#include "isotherm/shape_method.h"
#include "sim/lab/methods/method.h"
#include "sim/lab/methods/scan_mesh.h"

/* 4 mm of the default grid: some 2,000 vertices, as many as the shapes of chapter 4 have. */
enum { STEP = 2 };

static void discard(void *description)
{
    iso_shape_description_free(description);
}

static int describe(const void *knowledge, const struct sim_scan *face, void **description)
{
    (void)knowledge;
    struct sim_scan_mesh *crop = NULL;
    struct iso_shape *shape = NULL;
    struct iso_shape_description *made = NULL;
    int error = sim_scan_mesh_new(face, STEP, &crop);
    if (!error) {
        error = iso_shape_new(crop->mesh, NULL, 0, &shape);
    }
    if (!error) {
        error = iso_shape_describe(iso_shape_method_find("cp-hk"), shape, &made);
    }
    iso_shape_free(shape);
    sim_scan_mesh_free(crop);
    if (!error) {
        *description = made;
    }
    return error;
}

/* The L1 distance, as in CP-HK's nearest neighbour search. */
static int distance(const void *knowledge, const void *probe, const void *gallery, double *out)
{
    (void)knowledge;
    const struct iso_shape_description *p = probe, *g = gallery;
    double sum = 0.0;
    int32_t at = 0;
    for (int32_t part = 0; part < p->n_parts; part++) {
        for (int32_t i = 0; i < p->part_size[part]; i++, at++) {
            sum += fabs((double)p->whole[at] - (double)g->whole[at]);
        }
    }
    *out = sum;
    return 0;
}

const struct sim_method sim_method_cp_hk = {
    .name = "cp-hk",
    .source = "scale-invariant heat from critical points of the face crop (Abdelrahman 2013, "
              "4.3.3), nearest by L1",
    .describe = describe,
    .discard = discard,
    .distance = distance,
};
