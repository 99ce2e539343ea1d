/* The operations on blocks of vectors, compared with the same operations on single vectors. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/heat/block.h"
#include "core/heat/factor.h"
#include "core/heat/permuted.h"
#include "tests/core/surfaces/matrices.h"
#include "tests/core/surfaces/shapes.h"

/* The matrices L and B of an artificial face, the factor of 15 L + B, and B in the order of the
 * factor. */
struct scene {
    struct iso_mesh *mesh;
    struct matrices m;
    struct iso_factor *factor;
    struct iso_permuted *permuted;
    struct iso_ldl ldl;
    struct iso_rows mass;
    const int32_t *order;
    int32_t n;
};

static struct scene scene_of(double pitch_mm)
{
    struct scene s = {.mesh = shape_relief(pitch_mm)};
    s.m = matrices_of(s.mesh, ISO_MASS_CONSISTENT);
    s.n = s.m.mass->n;
    assert_int_equal(iso_factor_new(s.n, s.m.mass->nnz, &s.factor), 0);
    assert_int_equal(iso_permuted_new(s.n, s.m.mass->nnz, &s.permuted), 0);
    assert_int_equal(iso_factor_compute(s.factor, 15.0, s.m.stiffness, 1.0, s.m.mass), 0);
    assert_int_equal(iso_factor_ldl(s.factor, &s.ldl, &s.order), 0);
    assert_int_equal(iso_permuted_fill(s.permuted, s.m.mass, s.order, &s.mass), 0);
    return s;
}

static void scene_done(struct scene *s)
{
    iso_factor_free(s->factor);
    iso_permuted_free(s->permuted);
    matrices_free(&s->m);
    iso_mesh_free(s->mesh);
}

static double *room(const struct scene *s)
{
    double *values = calloc((size_t)s->n * ISO_BLOCK_MAX, sizeof *values);
    assert_non_null(values);
    return values;
}

/* Returns value i of vector k, a pseudo-random number. */
static double any(int32_t i, int k)
{
    return sin(1.0 + 0.7 * i + 2.3 * k) + 0.3 * k;
}

/* Makes a block of such vectors in the order of the factor. Lane k holds vector first + k. */
static double *any_block(const struct scene *s, int width, int first)
{
    const int lanes = width * ISO_DOUBLES;
    double *values = room(s);
    for (int32_t i = 0; i < s->n; i++) {
        for (int k = 0; k < lanes; k++) {
            values[i * lanes + k] = any(s->order[i], first + k);
        }
    }
    return values;
}

/* Writes vector k in the order of the mesh to `out`. */
static void any_vector(const struct scene *s, int k, double *out)
{
    for (int32_t i = 0; i < s->n; i++) {
        out[i] = any(i, k);
    }
}

static double product(const double *a, const double *b, int32_t n)
{
    double sum = 0.0;
    for (int32_t i = 0; i < n; i++) {
        sum += a[i] * b[i];
    }
    return sum;
}

static void blocks_give_what_single_vectors_give(void **state)
{
    (void)state;
    struct scene s = scene_of(4.0);
    double *one = room(&s), *expected = room(&s), *y = room(&s);
    const struct iso_block_ops *ops = iso_block_ops();
    for (int width = 1; width <= ISO_BLOCK_WIDTH_MAX; width++) {
        const int lanes = width * ISO_DOUBLES;
        double form[ISO_BLOCK_MAX], total[ISO_BLOCK_MAX], energy[ISO_BLOCK_MAX];
        double *x = any_block(&s, width, 0);
        ops->multiply(&s.mass, width, x, y, form, total);
        iso_block_solve(ops, &s.ldl, width, x, energy);
        for (int k = 0; k < lanes; k++) {
            any_vector(&s, k, one);
            iso_symmetric_multiply(s.m.mass, one, expected);
            double sum = 0.0;
            for (int32_t i = 0; i < s.n; i++) {
                sum += expected[i];
                assert_true(fabs(y[i * lanes + k] - expected[s.order[i]]) < 1e-11);
            }
            assert_true(fabs(total[k] - sum) < 1e-8);
            assert_true(fabs(form[k] / product(one, expected, s.n) - 1.0) < 1e-12);
            assert_int_equal(iso_factor_solve(s.factor, one, 1, expected), 0);
            for (int32_t i = 0; i < s.n; i++) {
                assert_true(fabs(x[i * lanes + k] - expected[s.order[i]]) < 1e-13);
            }
            assert_true(fabs(energy[k] / product(one, expected, s.n) - 1.0) < 1e-12);
        }
        free(x);
    }
    free(one);
    free(expected);
    free(y);
    scene_done(&s);
}

static void blocks_are_mixed_and_combined(void **state)
{
    (void)state;
    enum { N = 5, BLOCKS = 3 };
    double block[BLOCKS][N * ISO_BLOCK_MAX], weight[BLOCKS][ISO_BLOCK_MAX];
    double sum[N * ISO_BLOCK_MAX], io[N * ISO_BLOCK_MAX];
    for (int width = 1; width <= ISO_BLOCK_WIDTH_MAX; width++) {
        const int lanes = width * ISO_DOUBLES, values = N * lanes;
        double packed[BLOCKS * N * ISO_BLOCK_MAX];
        for (int b = 0; b < BLOCKS; b++) {
            for (int k = 0; k < lanes; k++) {
                weight[b][k] = any(b, k);
            }
            for (int i = 0; i < values; i++) {
                block[b][i] = packed[b * values + i] = any(i, b);
            }
        }
        const struct iso_block_ops *ops = iso_block_ops();
        ops->combine(N, width, packed, BLOCKS, (const double(*)[ISO_BLOCK_MAX])weight, sum);
        memcpy(io, block[0], sizeof io);
        ops->mix(N, width, (const double(*)[ISO_BLOCK_MAX])weight, block[1], block[2], io);
        for (int i = 0; i < values; i++) {
            double expected = 0.0;
            for (int b = 0; b < BLOCKS; b++) {
                expected += weight[b][i % lanes] * block[b][i];
            }
            assert_true(fabs(sum[i] - expected) < 1e-14 && fabs(io[i] - expected) < 1e-14);
        }
    }
}

/* The bits of a vector do not depend on the width of its block or on the other vectors. */
static void widths_agree_to_the_bit(void **state)
{
    (void)state;
    struct scene s = scene_of(6.0);
    const struct iso_block_ops *ops = iso_block_ops();
    double *wide = any_block(&s, 3, 0), *wide_y = room(&s), *narrow_y = room(&s);
    double form[2][ISO_BLOCK_MAX], total[2][ISO_BLOCK_MAX], energy[2][ISO_BLOCK_MAX];
    ops->multiply(&s.mass, 3, wide, wide_y, form[0], total[0]);
    iso_block_solve(ops, &s.ldl, 3, wide, energy[0]);
    for (int width = 1; width <= 2; width++) {
        const int first = 5, lanes = width * ISO_DOUBLES;
        double *narrow = any_block(&s, width, first);
        ops->multiply(&s.mass, width, narrow, narrow_y, form[1], total[1]);
        iso_block_solve(ops, &s.ldl, width, narrow, energy[1]);
        for (int k = 0; k < lanes && first + k < ISO_BLOCK_MAX; k++) {
            assert_true(form[0][first + k] == form[1][k] && total[0][first + k] == total[1][k] &&
                        energy[0][first + k] == energy[1][k]);
            for (int32_t i = 0; i < s.n; i++) {
                assert_true(wide[i * ISO_BLOCK_MAX + first + k] == narrow[i * lanes + k]);
                assert_true(wide_y[i * ISO_BLOCK_MAX + first + k] == narrow_y[i * lanes + k]);
            }
        }
        free(narrow);
    }
    free(wide);
    free(wide_y);
    free(narrow_y);
    scene_done(&s);
}

/* Loads at a few vertices need only the supernodes that they reach, and energies need no solve:
 * with the same bits. */
static void point_loads_reach_few_supernodes(void **state)
{
    (void)state;
    struct scene s = scene_of(2.0);
    const struct iso_block_ops *ops = iso_block_ops();
    const size_t n_nodes = (size_t)s.ldl.nodes->count;
    bool *reached = calloc(n_nodes, sizeof *reached);
    assert_non_null(reached);
    for (int width = 1; width <= ISO_BLOCK_WIDTH_MAX; width++) {
        const int lanes = width * ISO_DOUBLES;
        const size_t bytes = (size_t)(s.n * lanes) * sizeof(double);
        double *all = room(&s), *some = room(&s);
        double measured[ISO_BLOCK_MAX], energy[ISO_BLOCK_MAX];
        memset(reached, 0, n_nodes * sizeof *reached);
        for (int k = 0; k < lanes; k++) {
            const int32_t row = (int32_t)((k + 0.5) / lanes * s.n);
            all[row * lanes + k] = any(row, k);
            iso_ldl_reach(s.ldl.nodes, row, reached);
        }
        memcpy(some, all, bytes);
        ops->forward(&s.ldl, NULL, width, all);
        ops->forward(&s.ldl, reached, width, some);
        assert_memory_equal(all, some, bytes);
        ops->measure(&s.ldl, width, some, measured);
        assert_memory_equal(all, some, bytes);
        ops->backward(&s.ldl, width, all, energy);
        assert_memory_equal(measured, energy, (size_t)lanes * sizeof *energy);
        assert_true(energy[0] > 0.0 && energy[lanes - 1] > 0.0);
        size_t n = 0;
        for (size_t k = 0; k < n_nodes; k++) {
            n += reached[k];
        }
        print_message("%d loads reach %zu of %zu supernodes\n", lanes, n, n_nodes);
        assert_true(n < n_nodes / 3);
        free(all);
        free(some);
    }
    free(reached);
    scene_done(&s);
}

/* Each column lies in one supernode, with the rows that it has in L. */
static void supernodes_have_the_rows_of_their_columns(void **state)
{
    (void)state;
    struct scene s = scene_of(4.0);
    const struct iso_ldl *l = &s.ldl;
    int32_t next = 0;
    for (int32_t k = 0; k < l->nodes->count; k++) {
        const struct iso_ldl_node *node = &l->nodes->node[k];
        assert_int_equal(node->first, next);
        next += node->width;
        for (int32_t c = 0; c < node->width; c++) {
            const int32_t j = node->first + c;
            assert_int_equal(l->nodes->of[j], k);
            assert_int_equal(l->count[j], node->width - c + node->n_below);
            assert_memory_equal(&l->row[l->start[j]], &node->row[c],
                                (size_t)l->count[j] * sizeof *l->row);
        }
    }
    assert_int_equal(next, l->n);
    assert_true(l->nodes->count < l->n);
    struct iso_ldl_nodes *none = NULL;
    assert_int_equal(iso_ldl_nodes_new(&(struct iso_ldl){.n = 0}, &none), -EINVAL);
    iso_ldl_nodes_free(none);
    scene_done(&s);
}

#if defined __x86_64__
static void compare_processors(double pitch_mm, int32_t values_min)
{
    const struct iso_block_ops *ops[2] = {&iso__block_ops_baseline, &iso__block_ops_avx2};
    struct scene s = scene_of(pitch_mm);
    assert_true(s.ldl.start[s.n - 1] >= values_min);
    const size_t bytes = (size_t)s.n * ISO_BLOCK_MAX * sizeof(double);
    for (int width = 1; width <= ISO_BLOCK_WIDTH_MAX; width++) {
        double *x[2], *y[2], *sum[2], results[2][3][ISO_BLOCK_MAX] = {{{0}}};
        double weight[3][ISO_BLOCK_MAX];
        for (int b = 0; b < 3; b++) {
            for (int k = 0; k < ISO_BLOCK_MAX; k++) {
                weight[b][k] = any(b, k);
            }
        }
        const double(*weights)[ISO_BLOCK_MAX] = (const double(*)[ISO_BLOCK_MAX])weight;
        for (int p = 0; p < 2; p++) {
            x[p] = any_block(&s, width, 0);
            y[p] = room(&s);
            sum[p] = room(&s);
            ops[p]->multiply(&s.mass, width, x[p], y[p], results[p][0], results[p][1]);
            iso_block_solve(ops[p], &s.ldl, width, x[p], results[p][2]);
            ops[p]->mix(s.n, width, weights, x[p], y[p], y[p]);
            ops[p]->combine(s.n / 2, width, x[p], 2, weights, sum[p]);
        }
        assert_memory_equal(x[0], x[1], bytes);
        assert_memory_equal(y[0], y[1], bytes);
        assert_memory_equal(sum[0], sum[1], bytes);
        assert_memory_equal(results[0], results[1], sizeof results[0]);
        assert_true(results[0][2][0] > 0.0);
        for (int p = 0; p < 2; p++) {
            free(x[p]);
            free(y[p]);
            free(sum[p]);
        }
    }
    scene_done(&s);
}

/* A small factor, and one that is so large that it is fetched ahead. */
static void processors_agree_to_the_bit(void **state)
{
    (void)state;
    if (!__builtin_cpu_supports("avx2")) {
        skip();
    }
    assert_string_equal(iso_block_ops()->name, "AVX2");
    compare_processors(6.0, 1);
    compare_processors(2.0, 1 << 16);
}
#endif

static void impossible_requests_are_refused(void **state)
{
    (void)state;
    struct iso_permuted *p = NULL;
    assert_int_equal(iso_permuted_new(0, 5, &p), -EINVAL);
    assert_int_equal(iso_permuted_new(6, 5, &p), -EINVAL);
    iso_permuted_free(p);
    struct scene s = scene_of(8.0);
    struct iso_rows rows;
    assert_int_equal(iso_permuted_new(s.n - 1, s.m.mass->nnz, &p), 0);
    assert_int_equal(iso_permuted_fill(p, s.m.mass, s.order, &rows), -ENOSPC);
    iso_permuted_free(p);
    assert_int_equal(iso_permuted_new(s.n, s.m.mass->nnz - 1, &p), 0);
    assert_int_equal(iso_permuted_fill(p, s.m.mass, s.order, &rows), -ENOSPC);
    iso_permuted_free(p);
    struct iso_factor *factor = NULL;
    struct iso_ldl ldl;
    const int32_t *order;
    assert_int_equal(iso_factor_new(s.n, s.m.mass->nnz, &factor), 0);
    assert_int_equal(iso_factor_ldl(factor, &ldl, &order), -EDOM);
    assert_int_equal(iso_factor_compute(factor, -1.0, s.m.stiffness, -1.0, s.m.mass), -EDOM);
    assert_int_equal(iso_factor_ldl(factor, &ldl, &order), -EDOM);
    iso_factor_free(factor);
    scene_done(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(blocks_give_what_single_vectors_give),
        cmocka_unit_test(blocks_are_mixed_and_combined),
        cmocka_unit_test(widths_agree_to_the_bit),
        cmocka_unit_test(point_loads_reach_few_supernodes),
        cmocka_unit_test(supernodes_have_the_rows_of_their_columns),
#if defined __x86_64__
        cmocka_unit_test(processors_agree_to_the_bit),
#endif
        cmocka_unit_test(impossible_requests_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
