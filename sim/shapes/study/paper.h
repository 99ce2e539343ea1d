/* The tables of the dissertation, chapters 4 and 5: what each row was made of, and its figures. */
#ifndef SIM_SHAPES_STUDY_PAPER_H
#define SIM_SHAPES_STUDY_PAPER_H

#include "sim/shapes/make/distort.h"

/* What the columns of a table are. */
enum sim_paper_columns {
    SIM_PAPER_RETRIEVAL, /* NN, 1-tier, 2-tier, e-measure, DCG */
    SIM_PAPER_NEAREST,   /* NN */
    SIM_PAPER_CLASSES,   /* TP rate, FP rate, precision, recall, ROC area */
    SIM_PAPER_TEXTURED,  /* NN, 1-tier, 2-tier, ADR */
};

enum { SIM_PAPER_FIGURES = 5 };

/* Its data sets. */
enum sim_paper_set {
    SIM_PAPER_NONRIGID_WORLD,
    SIM_PAPER_SHREC11,
    SIM_PAPER_SHREC13,
    SIM_PAPER_SETS
};

struct sim_paper_row {
    const char *method, *classifier;  /* names of ours; NULL: of others, figures only */
    const char *title;                /* of a row without a method */
    int size;                         /* of features; 0: the method's */
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

/* How many figures a row of such columns has, and what they are called. */
int sim_paper_n_columns(enum sim_paper_columns columns);
const char *sim_paper_column_name(enum sim_paper_columns columns, int column);

#endif
