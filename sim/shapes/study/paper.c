#include "sim/shapes/study/paper.h"

#include <stddef.h>

/* {method, classifier, title, size, distortion, figures} */
/* clang-format off */
static const struct sim_paper_row table_4_1[] = {
    {"td", "nn-l2", NULL, 0, {0}, {0.59, 0.36, 0.5, 0.33, 0.66}},
    {"shape-dna", "nn-l2", NULL, 0, {0}, {0.96, 0.64, 0.87, 0.55, 0.9}},
    {"srcp-td", "nn-l2", NULL, 0, {0}, {0.96, 0.67, 0.9, 0.56, 0.91}},
    {"td", "crc-rls", NULL, 0, {0}, {0.25, 0.18, 0.31, 0.2, 0.503}},
    {"shape-dna", "crc-rls", NULL, 0, {0}, {0.94, 0.78, 0.9, 0.55, 0.93}},
    {"srcp-td", "crc-rls", NULL, 0, {0}, {0.97, 0.81, 0.93, 0.56, 0.95}},
};

static const struct sim_paper_row table_4_2[] = {
    {"td", "nn-l2", NULL, 0, {0}, {0.64, 0.37, 0.47, 0.33, 0.66}},
    {"shape-dna", "nn-l2", NULL, 0, {0}, {0.99, 0.85, 0.92, 0.67, 0.96}},
    {"srcp-td", "nn-l2", NULL, 0, {0}, {0.99, 0.86, 0.94, 0.69, 0.96}},
    {"td", "crc-rls", NULL, 0, {0}, {0.18, 0.14, 0.24, 0.16, 0.46}},
    {"shape-dna", "crc-rls", NULL, 0, {0}, {0.56, 0.58, 0.74, 0.55, 0.78}},
    {"srcp-td", "crc-rls", NULL, 0, {0}, {0.97, 0.8, 0.89, 0.65, 0.94}},
};

static const struct sim_paper_row table_4_3[] = {
    {"srcp-td-one", "nn-l2", NULL, 0, {0}, {0.9833, 0.7621, 0.9209, 0.5633, 0.9493}},
    {"srcp-td-one", "crc-rls", NULL, 0, {0}, {0.975, 0.8056, 0.9278, 0.5652, 0.948}},
};

static const struct sim_paper_row table_4_4[] = {
    {"srcp-td", "crc-rls", NULL, 24, {0}, {0.7733, 0.6838, 0.8175, 0.5886, 0.8653}},
    {"srcp-td", "crc-rls", NULL, 44, {0}, {0.92, 0.7362, 0.8509, 0.6173, 0.9059}},
    {"srcp-td", "crc-rls", NULL, 64, {0}, {0.96, 0.7783, 0.8818, 0.6446, 0.9323}},
    {"srcp-td", "crc-rls", NULL, 84, {0}, {0.9683, 0.7944, 0.8875, 0.6496, 0.9385}},
    {"srcp-td", "crc-rls", NULL, 104, {0}, {0.9783, 0.8087, 0.8976, 0.6592, 0.9453}},
    {"srcp-td", "crc-rls", NULL, 124, {0}, {0.9783, 0.8111, 0.8998, 0.6602, 0.9467}},
    {"srcp-td", "crc-rls", NULL, 144, {0}, {0.9783, 0.8106, 0.8996, 0.6603, 0.9468}},
};

static const struct sim_paper_row table_4_5[] = {
    {"srcp-td", "crc-rls", NULL, 0, {0}, {0.97, 0.81, 0.93, 0.56, 0.95}},
    {"srcp-td", "crc-rls", NULL, 0, {SIM_DISTORTION_WHITE, 2}, {0.92, 0.74, 0.92, 0.55, 0.93}},
    {"srcp-td", "crc-rls", NULL, 0, {SIM_DISTORTION_WHITE, 3}, {0.87, 0.67, 0.85, 0.5, 0.88}},
};

static const struct sim_paper_row table_4_6[] = {
    {"td", "nn-l2", NULL, 0, {0}, {0.5917, 0.3646, 0.5036, 0.3307, 0.6654}},
    {"shape-dna", "nn-l2", NULL, 0, {0}, {0.9833, 0.7972, 0.9298, 0.5618, 0.9585}},
    {"shape-google", "nn-l1", NULL, 0, {0}, {0.9, 0.6666, 0.8656, 0.5443, 0.8874}},
    {"cp-hk", "rcr", NULL, 0, {0}, {0.9667, 0.775, 0.9053, 0.543, 0.9389}},
};

static const struct sim_paper_row table_4_7[] = {
    {"td", "nn-l2", NULL, 0, {0}, {0.6483, 0.3704, 0.4768, 0.3369, 0.6684}},
    {"shape-dna", "nn-l2", NULL, 0, {0}, {0.9833, 0.6917, 0.805, 0.5827, 0.9155}},
    {"shape-google", "nn-l1", NULL, 0, {0}, {0.9567, 0.6225, 0.7288, 0.5245, 0.8718}},
    {"cp-hk", "rcr", NULL, 0, {0}, {0.9733, 0.7798, 0.8823, 0.6443, 0.9364}},
};

static const struct sim_paper_row table_4_8[] = {
    {"cp-hk", "rcr", NULL, 0, {SIM_DISTORTION_WHITE, 1}, {1}},
    {"srcp-td", "crc-rls", NULL, 0, {SIM_DISTORTION_WHITE, 1}, {0}},
    {"shape-google", "nn-l1", NULL, 0, {SIM_DISTORTION_WHITE, 1}, {1}},
    {"shape-dna", "nn-l2", NULL, 0, {SIM_DISTORTION_WHITE, 1}, {1}},
    {"cp-hk", "rcr", NULL, 0, {SIM_DISTORTION_WHITE, 2}, {1}},
    {"srcp-td", "crc-rls", NULL, 0, {SIM_DISTORTION_WHITE, 2}, {0}},
    {"shape-google", "nn-l1", NULL, 0, {SIM_DISTORTION_WHITE, 2}, {0.9}},
    {"shape-dna", "nn-l2", NULL, 0, {SIM_DISTORTION_WHITE, 2}, {0.9667}},
    {"cp-hk", "rcr", NULL, 0, {SIM_DISTORTION_WHITE, 3}, {0.9}},
    {"srcp-td", "crc-rls", NULL, 0, {SIM_DISTORTION_WHITE, 3}, {0}},
    {"shape-google", "nn-l1", NULL, 0, {SIM_DISTORTION_WHITE, 3}, {0.1333}},
    {"shape-dna", "nn-l2", NULL, 0, {SIM_DISTORTION_WHITE, 3}, {0.6}},
    {"cp-hk", "rcr", NULL, 0, {SIM_DISTORTION_SHOT, 1}, {1}},
    {"srcp-td", "crc-rls", NULL, 0, {SIM_DISTORTION_SHOT, 1}, {0}},
    {"shape-google", "nn-l1", NULL, 0, {SIM_DISTORTION_SHOT, 1}, {0.9333}},
    {"shape-dna", "nn-l2", NULL, 0, {SIM_DISTORTION_SHOT, 1}, {1}},
    {"cp-hk", "rcr", NULL, 0, {SIM_DISTORTION_SHOT, 2}, {1}},
    {"srcp-td", "crc-rls", NULL, 0, {SIM_DISTORTION_SHOT, 2}, {0}},
    {"shape-google", "nn-l1", NULL, 0, {SIM_DISTORTION_SHOT, 2}, {0.8666}},
    {"shape-dna", "nn-l2", NULL, 0, {SIM_DISTORTION_SHOT, 2}, {0.9667}},
    {"cp-hk", "rcr", NULL, 0, {SIM_DISTORTION_SHOT, 3}, {0.966}},
    {"srcp-td", "crc-rls", NULL, 0, {SIM_DISTORTION_SHOT, 3}, {0}},
    {"shape-google", "nn-l1", NULL, 0, {SIM_DISTORTION_SHOT, 3}, {0.5333}},
    {"shape-dna", "nn-l2", NULL, 0, {SIM_DISTORTION_SHOT, 3}, {0.4}},
    {"cp-hk", "rcr", NULL, 0, {SIM_DISTORTION_SCALE, 1}, {1}},
    {"srcp-td", "crc-rls", NULL, 0, {SIM_DISTORTION_SCALE, 1}, {0}},
    {"shape-google", "nn-l1", NULL, 0, {SIM_DISTORTION_SCALE, 1}, {0.8}},
    {"shape-dna", "nn-l2", NULL, 0, {SIM_DISTORTION_SCALE, 1}, {0.9667}},
    {"cp-hk", "rcr", NULL, 0, {SIM_DISTORTION_SCALE, 2}, {1}},
    {"srcp-td", "crc-rls", NULL, 0, {SIM_DISTORTION_SCALE, 2}, {0}},
    {"shape-google", "nn-l1", NULL, 0, {SIM_DISTORTION_SCALE, 2}, {0.4666}},
    {"shape-dna", "nn-l2", NULL, 0, {SIM_DISTORTION_SCALE, 2}, {0.9667}},
    {"cp-hk", "rcr", NULL, 0, {SIM_DISTORTION_SCALE, 3}, {1}},
    {"srcp-td", "crc-rls", NULL, 0, {SIM_DISTORTION_SCALE, 3}, {0}},
    {"shape-google", "nn-l1", NULL, 0, {SIM_DISTORTION_SCALE, 3}, {0.2333}},
    {"shape-dna", "nn-l2", NULL, 0, {SIM_DISTORTION_SCALE, 3}, {0.9667}},
    {"cp-hk", "rcr", NULL, 0, {SIM_DISTORTION_MISSING, 1}, {0}},
    {"srcp-td", "crc-rls", NULL, 0, {SIM_DISTORTION_MISSING, 1}, {0}},
    {"shape-google", "nn-l1", NULL, 0, {SIM_DISTORTION_MISSING, 1}, {0}},
    {"shape-dna", "nn-l2", NULL, 0, {SIM_DISTORTION_MISSING, 1}, {0}},
    {"cp-hk", "rcr", NULL, 0, {SIM_DISTORTION_MISSING, 2}, {0}},
    {"srcp-td", "crc-rls", NULL, 0, {SIM_DISTORTION_MISSING, 2}, {0}},
    {"shape-google", "nn-l1", NULL, 0, {SIM_DISTORTION_MISSING, 2}, {0}},
    {"shape-dna", "nn-l2", NULL, 0, {SIM_DISTORTION_MISSING, 2}, {0}},
    {"cp-hk", "rcr", NULL, 0, {SIM_DISTORTION_MISSING, 3}, {0}},
    {"srcp-td", "crc-rls", NULL, 0, {SIM_DISTORTION_MISSING, 3}, {0}},
    {"shape-google", "nn-l1", NULL, 0, {SIM_DISTORTION_MISSING, 3}, {0}},
    {"shape-dna", "nn-l2", NULL, 0, {SIM_DISTORTION_MISSING, 3}, {0}},
};

static const struct sim_paper_row table_4_9[] = {
    {"cp-hk-plain", "decision-tree", NULL, 0, {0}, {0.883, 0.016, 0.893, 0.883, 0.939}},
    {"cp-hk-plain", "naive-bayes", NULL, 0, {0}, {0.858, 0.022, 0.845, 0.858, 0.954}},
    {"cp-hk-plain", "nn-l2", NULL, 0, {0}, {0.883, 0.021, 0.901, 0.883, 0.931}},
    {"cp-hk-plain", "svm", NULL, 0, {0}, {0.908, 0.015, 0.917, 0.908, 0.984}},
    {"td", "decision-tree", NULL, 0, {0}, {0.608, 0.067, 0.601, 0.608, 0.789}},
    {"td", "naive-bayes", NULL, 0, {0}, {0.542, 0.071, 0.57, 0.542, 0.848}},
    {"td", "nn-l2", NULL, 0, {0}, {0.533, 0.079, 0.535, 0.533, 0.727}},
    {"td", "svm", NULL, 0, {0}, {0.642, 0.063, 0.641, 0.642, 0.876}},
    {"shape-dna", "decision-tree", NULL, 0, {0}, {0.933, 0.009, 0.94, 0.933, 0.962}},
    {"shape-dna", "naive-bayes", NULL, 0, {0}, {0.867, 0.018, 0.876, 0.867, 0.983}},
    {"shape-dna", "nn-l2", NULL, 0, {0}, {0.975, 0.005, 0.975, 0.975, 0.985}},
    {"shape-dna", "svm", NULL, 0, {0}, {0.983, 0.003, 0.983, 0.983, 0.996}},
};

static const struct sim_paper_row table_4_10[] = {
    {"cp-hk-plain", "decision-tree", NULL, 0, {0}, {0.826, 0.006, 0.827, 0.826, 0.916}},
    {"cp-hk-plain", "naive-bayes", NULL, 0, {0}, {0.859, 0.005, 0.885, 0.859, 0.974}},
    {"cp-hk-plain", "nn-l2", NULL, 0, {0}, {0.862, 0.005, 0.88, 0.862, 0.929}},
    {"cp-hk-plain", "svm", NULL, 0, {0}, {0.914, 0.003, 0.916, 0.914, 0.983}},
    {"td", "decision-tree", NULL, 0, {0}, {0.646, 0.012, 0.659, 0.646, 0.831}},
    {"td", "naive-bayes", NULL, 0, {0}, {0.648, 0.012, 0.69, 0.648, 0.922}},
    {"td", "nn-l2", NULL, 0, {0}, {0.513, 0.017, 0.569, 0.513, 0.748}},
    {"td", "svm", NULL, 0, {0}, {0.619, 0.013, 0.596, 0.619, 0.925}},
    {"shape-dna", "decision-tree", NULL, 0, {0}, {0.951, 0.002, 0.954, 0.951, 0.975}},
    {"shape-dna", "naive-bayes", NULL, 0, {0}, {0.966, 0.001, 0.967, 0.966, 0.998}},
    {"shape-dna", "nn-l2", NULL, 0, {0}, {0.99, 0, 0.99, 0.99, 0.995}},
    {"shape-dna", "svm", NULL, 0, {0}, {0.824, 0.006, 0.873, 0.824, 0.978}},
};

static const struct sim_paper_row table_4_11[] = {
    {"cp-hk-plain", "svm", NULL, 0, {SIM_DISTORTION_WHITE, 1}, {0.933, 0.002, 0.9, 0.933, 0.998}},
    {"cp-hk-plain", "svm", NULL, 0, {SIM_DISTORTION_WHITE, 2}, {0.9, 0.003, 0.85, 0.9, 0.996}},
    {"cp-hk-plain", "svm", NULL, 0, {SIM_DISTORTION_WHITE, 3}, {0.733, 0.009, 0.636, 0.733, 0.948}},
    {"shape-dna", "svm", NULL, 0, {SIM_DISTORTION_WHITE, 1}, {0.8, 0.007, 0.733, 0.8, 0.756}},
    {"shape-dna", "svm", NULL, 0, {SIM_DISTORTION_WHITE, 2}, {0.8, 0.007, 0.733, 0.8, 0.756}},
    {"shape-dna", "svm", NULL, 0, {SIM_DISTORTION_WHITE, 3}, {0.733, 0.009, 0.644, 0.733, 0.672}},
};

static const struct sim_paper_row table_4_12[] = {
    {"cp-hk-plain", "svm", NULL, 0, {SIM_DISTORTION_SHOT, 1}, {0.8, 0.007, 0.722, 0.8, 0.9447}},
    {"cp-hk-plain", "svm", NULL, 0, {SIM_DISTORTION_SHOT, 2}, {0.867, 0.005, 0.825, 0.867, 0.958}},
    {"cp-hk-plain", "svm", NULL, 0, {SIM_DISTORTION_SHOT, 3}, {0.467, 0.018, 0.394, 0.467, 0.928}},
};

static const struct sim_paper_row table_4_13[] = {
    {"cp-hk-plain", "svm", NULL, 0, {SIM_DISTORTION_SCALE, 1}, {1, 0, 1, 1, 1}},
    {"cp-hk-plain", "svm", NULL, 0, {SIM_DISTORTION_SCALE, 2}, {1, 0, 1, 1, 1}},
    {"cp-hk-plain", "svm", NULL, 0, {SIM_DISTORTION_SCALE, 3}, {1, 0, 1, 1, 1}},
    {"shape-dna", "svm", NULL, 0, {SIM_DISTORTION_SCALE, 1}, {0.833, 0.006, 0.767, 0.833, 0.971}},
    {"shape-dna", "svm", NULL, 0, {SIM_DISTORTION_SCALE, 2}, {0.833, 0.006, 0.767, 0.833, 0.971}},
    {"shape-dna", "svm", NULL, 0, {SIM_DISTORTION_SCALE, 3}, {0.833, 0.006, 0.767, 0.833, 0.971}},
};

static const struct sim_paper_row table_5_1[] = {
    {"si-hk-colour", "nn-l1", NULL, 0, {0}, {0.508, 0.561, 0.73, 0.38}},
    {"w-hks1", "nn-l1", NULL, 0, {0}, {0.7765, 0.535, 0.6458, 0.4047}},
};

static const struct sim_paper_row table_5_2[] = {
    {"si-hk-colour", "nn-l1", NULL, 0, {0}, {0.508, 0.561, 0.73, 0.38}},
    {NULL, NULL, "G1", 0, {0}, {0.788, 0.658, 0.748, 0.47}},
    {NULL, NULL, "G2", 0, {0}, {0.898, 0.733, 0.893, 0.508}},
    {NULL, NULL, "V2", 0, {0}, {0.879, 0.764, 0.904, 0.52}},
    {NULL, NULL, "PHOG", 0, {0}, {0.951, 0.773, 0.899, 0.534}},
    {"w-hks2", "nn-l1", NULL, 0, {0}, {0.9242, 0.8338, 0.9257, 0.5701}},
    {"w-hks1", "nn-l1", NULL, 0, {0}, {0}},
    {"shape-google", "nn-l1", NULL, 0, {0}, {0}},
    {"shape-dna", "nn-l2", NULL, 0, {0}, {0}},
    {"cp-hk", "rcr", NULL, 0, {0}, {0}},
};

/* clang-format on */

#define ROWS(table) table, (int)(sizeof(table) / sizeof *(table))

const struct sim_paper_table sim_paper_tables[SIM_PAPER_TABLES] = {
    {"4.1", "Nearest neighbour above, CRC-RLS below", SIM_PAPER_NONRIGID_WORLD, SIM_PAPER_RETRIEVAL,
     ROWS(table_4_1)},
    {"4.2", "Nearest neighbour above, CRC-RLS below", SIM_PAPER_SHREC11, SIM_PAPER_RETRIEVAL,
     ROWS(table_4_2)},
    {"4.3", "One critical point", SIM_PAPER_NONRIGID_WORLD, SIM_PAPER_RETRIEVAL, ROWS(table_4_3)},
    {"4.4", "Size of SRCP-TD", SIM_PAPER_SHREC11, SIM_PAPER_RETRIEVAL, ROWS(table_4_4)},
    {"4.5", "White noise of NSR 0, 0.001, 0.01", SIM_PAPER_NONRIGID_WORLD, SIM_PAPER_RETRIEVAL,
     ROWS(table_4_5)},
    {"4.6", "CP-HK and others", SIM_PAPER_NONRIGID_WORLD, SIM_PAPER_RETRIEVAL, ROWS(table_4_6)},
    {"4.7", "CP-HK and others", SIM_PAPER_SHREC11, SIM_PAPER_RETRIEVAL, ROWS(table_4_7)},
    {"4.8", "Nearest neighbour of distorted queries", SIM_PAPER_SHREC11, SIM_PAPER_NEAREST,
     ROWS(table_4_8)},
    {"4.9", "Classifiers, by cross-validation", SIM_PAPER_NONRIGID_WORLD, SIM_PAPER_CLASSES,
     ROWS(table_4_9)},
    {"4.10", "Classifiers, by cross-validation", SIM_PAPER_SHREC11, SIM_PAPER_CLASSES,
     ROWS(table_4_10)},
    {"4.11", "White noise, three levels", SIM_PAPER_SHREC11, SIM_PAPER_CLASSES, ROWS(table_4_11)},
    {"4.12", "Shot noise, three levels", SIM_PAPER_SHREC11, SIM_PAPER_CLASSES, ROWS(table_4_12)},
    {"4.13", "Scale, three levels", SIM_PAPER_SHREC11, SIM_PAPER_CLASSES, ROWS(table_4_13)},
    {"5.1", "W-HKS1 and scale-invariant heat kernels with a colour histogram (A2)",
     SIM_PAPER_SHREC13, SIM_PAPER_TEXTURED, ROWS(table_5_1)},
    {"5.2", "W-HKS2 and others", SIM_PAPER_SHREC13, SIM_PAPER_TEXTURED, ROWS(table_5_2)},
};

static const char *const columns_of[][SIM_PAPER_FIGURES] = {
    [SIM_PAPER_RETRIEVAL] = {"NN", "1-tier", "2-tier", "e", "DCG"},
    [SIM_PAPER_NEAREST] = {"NN"},
    [SIM_PAPER_CLASSES] = {"TP", "FP", "prec.", "recall", "ROC"},
    [SIM_PAPER_TEXTURED] = {"NN", "1-tier", "2-tier", "ADR"},
};

int sim_paper_n_columns(enum sim_paper_columns columns)
{
    int n = 0;
    while (n < SIM_PAPER_FIGURES && columns_of[columns][n]) {
        n++;
    }
    return n;
}

const char *sim_paper_column_name(enum sim_paper_columns columns, int column)
{
    return columns_of[columns][column];
}
