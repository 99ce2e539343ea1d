/* How each method of isotherm/shape_method.h describes a shape, and what the methods share. The
 * functions iso_describe_ with the name of a method fill in a description that is all zero. `times`
 * are those of iso_shape_method_times(). They return 0 or -ENOMEM. iso_shape_describe frees the
 * description after an error. */
#ifndef ISO_CORE_SHAPE_DESCRIBE_DESCRIBE_H
#define ISO_CORE_SHAPE_DESCRIBE_DESCRIBE_H

#include "isotherm/shape_method.h"

int iso_describe_shape_dna(const struct iso_shape *shape, const struct iso_describe_times *times,
                           struct iso_shape_description *out);
int iso_describe_td(const struct iso_shape *shape, const struct iso_describe_times *times,
                    struct iso_shape_description *out);
int iso_describe_cp_td(const struct iso_shape *shape, const struct iso_describe_times *times,
                       struct iso_shape_description *out);
int iso_describe_cp_td_one(const struct iso_shape *shape, const struct iso_describe_times *times,
                           struct iso_shape_description *out);
int iso_describe_cp_hk(const struct iso_shape *shape, const struct iso_describe_times *times,
                       struct iso_shape_description *out);
int iso_describe_shape_google(const struct iso_shape *shape, const struct iso_describe_times *times,
                              struct iso_shape_description *out);
int iso_describe_local_heat(const struct iso_shape *shape, const struct iso_describe_times *times,
                            struct iso_shape_description *out);
int iso_describe_si_hk_colour(const struct iso_shape *shape, const struct iso_describe_times *times,
                              struct iso_shape_description *out);
int iso_describe_w_hks1(const struct iso_shape *shape, const struct iso_describe_times *times,
                        struct iso_shape_description *out);
int iso_describe_w_hks2(const struct iso_shape *shape, const struct iso_describe_times *times,
                        struct iso_shape_description *out);

/* The parts of CP-HK before the eigenvalues. */
enum { ISO_DESCRIBE_CP_HK_PLAIN_PARTS = 7 };

/* The description by a method, made of one by another method that has the same `describe` and keeps
 * as many parts or more. -EINVAL if the methods do not share, -ENOMEM. */
int iso_describe_share(const struct iso_shape_method *method, const struct iso_shape_method *from,
                       const struct iso_shape_description *shared,
                       struct iso_shape_description **out) __attribute__((warn_unused_result));

/* Allocates the given parts, filled with zeros. -ENOMEM. */
int iso_describe_parts(struct iso_shape_description *out, int32_t n_parts, const int32_t *part_size)
    __attribute__((warn_unused_result));

/* Adds values [n][stride] to a histogram of 2 or more bins over from..to, each with its weight. A
 * value is divided between the two bins whose middles are next to it. Values outside count in the
 * first or last bin. */
void iso_describe_histogram(const double *value, int32_t n, int stride, const double *weight,
                            double from, double to, int bins, float *histogram);

/* n eigenvalues from the first non-trivial one on, normalised, times `weight`. Each is the
 * difference to the value that it would have if all eigenvalues rose evenly at their mean slope (as
 * Weyl (1911) states for high ones), as a share of that value. This depends less on missing
 * parts than eigenvalues divided by the first one, which changes as much as any other. 0 where the
 * shape has fewer eigenvalues. */
void iso_describe_eigenvalues(const struct iso_shape *shape, int n, double weight, float *out);

#endif
