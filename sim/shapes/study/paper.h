/* The tables of the dissertation, chapters 4 and 5: the settings of each row, and its figures. */
#ifndef SIM_SHAPES_STUDY_PAPER_H
#define SIM_SHAPES_STUDY_PAPER_H

#include "sim/shapes/make/distort.h"

/* The columns of a table. */
enum sim_paper_columns {
    SIM_PAPER_RETRIEVAL, /* NN, 1-tier, 2-tier, e-measure, DCG */
    SIM_PAPER_NEAREST,   /* NN */
    SIM_PAPER_CLASSES,   /* TP rate, FP rate, precision, recall, ROC area */
    SIM_PAPER_TEXTURED,  /* NN, 1-tier, 2-tier, ADR */
};

enum { SIM_PAPER_FIGURES = 5 };

/* The data sets of the dissertation. */
enum sim_paper_set {
    SIM_PAPER_NONRIGID_WORLD,
    SIM_PAPER_SHREC11,
    SIM_PAPER_SHREC13,
    SIM_PAPER_SETS
};

struct sim_paper_row {
    const char *method,
        *classifier;   /* names in this project; NULL: a method of others, figures only */
    const char *title; /* of a row without a method */
    int size;          /* number of features; 0: the method's own */
    struct sim_distortion distortion; /* of the queries; level 0: none */
    double figure[SIM_PAPER_FIGURES]; /* 0, 0, ...: the dissertation does not have this row */
};

struct sim_paper_table {
    const char *number, *title;
    enum sim_paper_set set;
    enum sim_paper_columns columns;
    const struct sim_paper_row *rows;
    int n_rows;
};

enum { SIM_PAPER_TABLES = 15 };

extern const struct sim_paper_table sim_paper_tables[SIM_PAPER_TABLES];

/* The number of figures in a row with these columns, and their names. */
int sim_paper_n_columns(enum sim_paper_columns columns);
const char *sim_paper_column_name(enum sim_paper_columns columns, int column);

#endif
