/* Courses of heat at the vertices of a shape, for some vertices at a time: those of all vertices of
 * a large shape need as much memory as its eigenpairs. */
#ifndef ISO_CORE_SHAPE_DESCRIBE_HEAT_COURSES_H
#define ISO_CORE_SHAPE_DESCRIBE_HEAT_COURSES_H

#include "isotherm/eigenpairs.h"

enum {
    ISO_HEAT_ROWS = 256, /* vertices at a time */
    ISO_HEAT_OWN = -1,   /* as `vertex`: the heat of each vertex comes from itself */
};

struct iso_heat_courses {
    const struct iso_eigenpairs *pairs;
    int32_t vertex, first;
    int n_times;
    const double *t; /* [n_times] */
    double *decay;   /* [pairs from the first][n_times] */
    double *factor;  /* [pairs from the first][ISO_HEAT_ROWS]: working memory */
};

/* Prepares sum_i exp(-lambda_i t) phi_i(x) phi_i(vertex) over the pairs from `first` on, as in
 * iso_heat_from_vertex() and iso_heat_signature(). The pairs and t must outlive it. -ENOMEM;
 * iso_heat_courses_done is needed after an error as well. */
int iso_heat_courses_init(struct iso_heat_courses *courses, const struct iso_eigenpairs *pairs,
                          int32_t vertex, int32_t first, const double *t, int n_times)
    __attribute__((warn_unused_result));

/* The courses of `rows` vertices, at most ISO_HEAT_ROWS, of which `from` is the first one: out is
 * [rows][n_times]. */
void iso_heat_courses_at(const struct iso_heat_courses *courses, int32_t from, int32_t rows,
                         double *out);

/* How many vertices are left from one on, at most ISO_HEAT_ROWS. */
static inline int32_t iso_heat_rows_from(int32_t from, int32_t n)
{
    return n - from < ISO_HEAT_ROWS ? n - from : ISO_HEAT_ROWS;
}

/* Releases what it holds. */
void iso_heat_courses_done(struct iso_heat_courses *courses);

#endif
