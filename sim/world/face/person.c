#include "sim/world/face/person.h"

#include <stddef.h>

#include "sim/base/random.h"

enum { NOSE_TIP_IBUG = 30, BLOCK = 512 };

struct sim_person sim_person_draw(const char *population, uint64_t seed, uint32_t index,
                                  double variance_scale)
{
    struct sim_random random = sim_random_seeded(seed, sim_random_hash(population), index);
    struct sim_person person;
    const double sd = sqrt(variance_scale);
    for (int i = 0; i < SIM_IDENTITY_MODES; i++) {
        person.identity[i] = sd * sim_random_normal(&random);
    }
    person.key = sim_random_u64(&random);
    return person;
}

struct sim_person sim_person_mean(void)
{
    return (struct sim_person){{0.0}, 0};
}

/* Adds weight x mode to n consecutive coordinates. */
static void add_mode(float *sum, const float *mode, size_t n, double weight)
{
    const float w = (float)weight;
    for (size_t i = 0; i < n; i++) {
        sum[i] += w * mode[i];
    }
}

/* The sum over all modes for the vertices [from, from + n), n <= BLOCK: a block stays in the
 * first-level cache. */
static void block_surface(const struct sim_ict *ict, const struct sim_person *person,
                          const double *expression, size_t from, size_t n,
                          struct iso_vec3 *vertices_mm)
{
    const float *nose = ict->mean_mm + (size_t)ict->landmarks[NOSE_TIP_IBUG] * 3;
    const size_t stride = (size_t)ict->n_vertices * 3;
    float sum[3 * BLOCK];
    for (size_t i = 0; i < 3 * n; i++) {
        sum[i] = ict->mean_mm[3 * from + i] - nose[i % 3];
    }
    for (uint32_t m = 0; m < ict->n_identity && m < SIM_IDENTITY_MODES; m++) {
        add_mode(sum, ict->identity_mm + m * stride + 3 * from, 3 * n, person->identity[m]);
    }
    for (uint32_t m = 0; expression && m < ict->n_expression; m++) {
        add_mode(sum, ict->expression_mm + m * stride + 3 * from, 3 * n, expression[m]);
    }
    for (size_t i = 0; i < n; i++) {
        vertices_mm[from + i] = iso_vec3(sum[3 * i], sum[3 * i + 1], sum[3 * i + 2]);
    }
}

void sim_person_surface(const struct sim_ict *ict, const struct sim_person *person,
                        const double *expression, struct iso_vec3 *vertices_mm)
{
    for (size_t from = 0; from < ict->n_vertices; from += BLOCK) {
        const size_t left = ict->n_vertices - from;
        block_surface(ict, person, expression, from, left < BLOCK ? left : BLOCK, vertices_mm);
    }
}
