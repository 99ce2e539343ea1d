#include "sim/lab/methods/method.h"

#include <string.h>

const struct sim_method sim_method_hfpc = {
    .name = "hfpc",
    .source = "heat front propagation contours (Abdelrahman 2013, chapter 6) as the appliance uses "
              "them; with a metric, the best candidates are reranked by their upper faces",
};

const struct sim_method sim_method_hfpc_metric = {
    .name = "hfpc-metric",
    .source = "the same by the learned metric alone",
};

const struct sim_method sim_method_hfpc_upper = {
    .name = "hfpc-upper",
    .source = "the same by distance, even if there is a metric, with the landmarks that a mouth "
              "does not move",
};

const struct sim_method *const sim_methods[SIM_METHODS + 1] = {
    &sim_method_hfpc,          &sim_method_hfpc_metric,
    &sim_method_hfpc_upper,    &sim_method_hfpc_literal,
    &sim_method_icp,           &sim_method_icp_upper,
    &sim_method_eigensurfaces, &sim_method_fishersurfaces,
    &sim_method_anthroface_10, &sim_method_anthroface_25,
    &sim_method_hfpc_weighted, &sim_method_hfpc_weighted_1,
    &sim_method_cp_hk,         NULL,
};

const struct sim_method *sim_method_find(const char *name)
{
    for (size_t i = 0; sim_methods[i]; i++) {
        if (strcmp(sim_methods[i]->name, name) == 0) {
            return sim_methods[i];
        }
    }
    return NULL;
}
