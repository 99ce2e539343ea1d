#include "isotherm/shape_method.h"

#include <string.h>

#include "core/shape/describe/describe.h"

/* Times are given in areas of the shape, which also normalises eigenvalues and eigenfunctions
 * (4.2). From critical points, the first one is the shortest that 100 pairs resolve. At the last
 * one heat has spread over the whole shape (CP-HK, because amplitudes need the whole course), or
 * only over a limb (CP-TD), so that it does not reach places where parts may be missing. Shape
 * Google has 12 octaves in steps of 1/16, the methods for colours 127 such steps from 2^0.01 / 200
 * on (5.3). */
#define TIMES_CP_TD           \
    {                         \
        100, 1.0 / 400.0, 0.5 \
    }
#define TIMES_CP_HK           \
    {                         \
        100, 1.0 / 400.0, 4.0 \
    }
#define TIMES_GOOGLE           \
    {                          \
        193, 1.0 / 1024.0, 4.0 \
    }
/* From 2^0.01 / 200 to 2^7.9475 / 200 */
#define TIMES_COLOUR                                  \
    {                                                 \
        128, 0.005034777750283595, 1.2342578409624967 \
    }

static const struct iso_shape_method shape_dna = {
    .name = "shape-dna",
    .title = "Shape-DNA",
    .source = "Reuter, Wolter and Peinecke 2006",
    .coding = ISO_CODING_PLAIN,
    .norm = ISO_NORM_L2,
    .classifier = "nn-l2",
    .describe = iso_describe_shape_dna,
};

static const struct iso_shape_method td = {
    .name = "td",
    .title = "TD",
    .source = "Fang, Sun, Kim and Ramani 2011; Abdelrahman 2013, 3.4.5",
    .coding = ISO_CODING_PLAIN,
    .norm = ISO_NORM_L2,
    .classifier = "nn-l2",
    .describe = iso_describe_td,
};

static const struct iso_shape_method cp_td = {
    .name = "cp-td",
    .title = "CP-TD",
    .source = "Abdelrahman 2013, 4.2.1",
    .coding = ISO_CODING_PLAIN,
    .norm = ISO_NORM_L2,
    .classifier = "nn-l2",
    .times = TIMES_CP_TD,
    .describe = iso_describe_cp_td,
};

static const struct iso_shape_method srcp_td = {
    .name = "srcp-td",
    .title = "SRCP-TD",
    .source = "Abdelrahman 2013, 4.2.2",
    .coding = ISO_CODING_REDUCED,
    .size = 64,
    .norm = ISO_NORM_L2,
    .classifier = "crc-rls",
    .times = TIMES_CP_TD,
    .describe = iso_describe_cp_td,
};

static const struct iso_shape_method srcp_td_one = {
    .name = "srcp-td-one",
    .title = "SRCP-TD, one point",
    .source = "Abdelrahman 2013, 4.2.3, table 4.3",
    .coding = ISO_CODING_REDUCED,
    .size = 64,
    .norm = ISO_NORM_L2,
    .classifier = "crc-rls",
    .times = TIMES_CP_TD,
    .describe = iso_describe_cp_td_one,
};

static const struct iso_shape_method cp_hk = {
    .name = "cp-hk",
    .title = "CP-HK",
    .source = "Abdelrahman 2013, 4.3.3",
    .coding = ISO_CODING_PLAIN,
    .norm = ISO_NORM_L1,
    .classifier = "rcr",
    .times = TIMES_CP_HK,
    .describe = iso_describe_cp_hk,
};

static const struct iso_shape_method cp_hk_plain = {
    .name = "cp-hk-plain",
    .title = "CP-HK without eigenvalues",
    .source = "Abdelrahman 2013, 4.3.7",
    .coding = ISO_CODING_PLAIN,
    .norm = ISO_NORM_L1,
    .classifier = "svm",
    .kept_parts = ISO_DESCRIBE_CP_HK_PLAIN_PARTS,
    .times = TIMES_CP_HK,
    .describe = iso_describe_cp_hk,
};

static const struct iso_shape_method shape_google = {
    .name = "shape-google",
    .title = "Shape Google",
    .source = "Bronstein, Bronstein, Guibas and Ovsjanikov 2011",
    .coding = ISO_CODING_BAGS,
    .size = 64,
    .norm = ISO_NORM_L1,
    .classifier = "nn-l1",
    .times = TIMES_GOOGLE,
    .describe = iso_describe_shape_google,
};

static const struct iso_shape_method local_heat = {
    .name = "local-heat",
    .title = "Local heat",
    .source = "heat at short times, nearest points; for shapes with missing parts",
    .coding = ISO_CODING_PLAIN,
    .norm = ISO_NORM_PARTIAL,
    .classifier = "nn",
    .describe = iso_describe_local_heat,
};

static const struct iso_shape_method w_hks1 = {
    .name = "w-hks1",
    .title = "W-HKS1",
    .source = "Abdelrahman 2013, 5.3",
    .colour = true,
    .coding = ISO_CODING_BAGS,
    .size = 64,
    .norm = ISO_NORM_L1,
    .classifier = "nn-l1",
    .times = TIMES_COLOUR,
    .describe = iso_describe_w_hks1,
};

static const struct iso_shape_method w_hks2 = {
    .name = "w-hks2",
    .title = "W-HKS2",
    .source = "Abdelrahman 2013, 5.4",
    .colour = true,
    .coding = ISO_CODING_BAGS,
    .size = 64,
    .norm = ISO_NORM_L1,
    .classifier = "nn-l1",
    .times = TIMES_COLOUR,
    .describe = iso_describe_w_hks2,
};

static const struct iso_shape_method si_hk_colour = {
    .name = "si-hk-colour",
    .title = "SI-HK and colours (A2)",
    .source = "Cerri et al., 3DOR 2013",
    .colour = true,
    .coding = ISO_CODING_BAGS,
    .size = 64,
    .norm = ISO_NORM_L1,
    .classifier = "nn-l1",
    .times = TIMES_COLOUR,
    .describe = iso_describe_si_hk_colour,
};

const struct iso_shape_method *const iso_shape_methods[] = {
    &shape_dna,    &td,         &cp_td,  &srcp_td, &srcp_td_one,  &cp_hk, &cp_hk_plain,
    &shape_google, &local_heat, &w_hks1, &w_hks2,  &si_hk_colour, NULL,
};

const struct iso_shape_method *iso_shape_method_find(const char *name)
{
    for (const struct iso_shape_method *const *method = iso_shape_methods; *method; method++) {
        if (strcmp((*method)->name, name) == 0) {
            return *method;
        }
    }
    return NULL;
}
