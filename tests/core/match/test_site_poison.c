/* An attacker who knows the code enrols crafted templates in order to change the scores of other
 * people. The templates may have any vectors, even those that no real face could give; the limits
 * of core/match/site.c bound their effect. The attacker tries vectors far along axes of the metric,
 * towards people and strangers, and along their differences, and captures that are spread along
 * each of these directions. The test bounds how far the scores of honest people and of strangers
 * change.
 *
 * People are drawn from the distribution of the shipped metric (its `between`; 1 within a person),
 * with an offset that they have in common, as real people before one sensor have. The first
 * strangers look like one of the people: they are half way between this person and a stranger. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "core/match/site.h"

enum {
    PEOPLE_MAX = 70,
    ATTACKERS_MAX = 2,
    TEMPLATES = 2,
    ATTACK_TEMPLATES = 16,
    STRANGERS = 6,
    ALIKE = 5
};

static const double common_offset = 0.5; /* in each dimension, standard deviations between people */

/* The numbers of the attackers. The first one is enrolled after all others, the second one before
 * them, so that no group of people that a score leaves out (iso_site_score) has both. */
static const int64_t attacker_numbers[ATTACKERS_MAX] = {PEOPLE_MAX, -1};

/* What an attack by one or two people, who enrol the same templates, may do to the scores of
 * others. */
struct bound {
    int people, attackers;
    double rises; /* of the highest score of a stranger */
    double falls; /* of an honest person with the own templates */
};

static const struct bound bounds[] = {
    {10, 1, 3.5, 2.5}, {30, 1, 1.0, 1.5}, {70, 1, 1.0, 1.5},
    {10, 2, 6.0, 5.0}, {30, 2, 1.5, 2.0}, {70, 2, 1.5, 2.0},
};

struct world {
    const struct iso_metric *metric;
    int people, attackers;
    struct iso_metric_vector templates[PEOPLE_MAX][TEMPLATES]; /* by the shipped metric */
    struct iso_metric_vector probe[PEOPLE_MAX];                /* of the same people */
    struct iso_metric_vector stranger[STRANGERS];
};

/* The scores of the people with their own templates, and the highest score of a stranger. */
struct scores {
    double mated[PEOPLE_MAX], highest;
};

/* ---- people ---- */

/* The variances of the shipped metric, with few values, so that it is quick to adapt. */
static struct iso_metric *metric_of_people(void)
{
    struct iso_metric *shipped = NULL, *metric = NULL;
    FILE *stream = fopen(ISOTHERM_SOURCE_DIR "/core/data/face.metric", "rb");
    uint8_t *bytes = malloc(ISO_METRIC_BYTES_MAX);
    assert_non_null(stream);
    assert_non_null(bytes);
    const size_t size = fread(bytes, 1, ISO_METRIC_BYTES_MAX, stream);
    assert_int_equal(fclose(stream), 0);
    assert_int_equal(iso_metric_parse(bytes, size, &shipped, NULL), 0);
    free(bytes);
    const struct iso_metric shape = {
        .landmarks = 1,
        .n_radii = 2,
        .n_points = 5,
        .n_dimensions = shipped->n_dimensions,
        .weight_min = 0.25f,
        .gain = shipped->gain,
        .bias = shipped->bias,
    };
    assert_int_equal(iso_metric_new(&shape, &metric), 0);
    for (int d = 0; d < shape.n_dimensions; d++) {
        metric->between[d] = shipped->between[d];
    }
    iso_metric_free(shipped);
    return metric;
}

static uint64_t random_state;

/* A number of the normal distribution (Box and Muller 1958); the generator is that of Knuth's
 * MMIX. */
static double normal(void)
{
    double u[2];
    for (int i = 0; i < 2; i++) {
        random_state = random_state * 6364136223846793005U + 1442695040888963407U;
        u[i] = ((double)(random_state >> 11) + 1.0) / 9007199254740993.0;
    }
    return sqrt(-2.0 * log(u[0])) * cos(6.283185307179586 * u[1]);
}

static void draw_person(const struct world *world, struct iso_metric_vector *templates, int n,
                        struct iso_metric_vector *probe)
{
    for (int i = 0; i < n; i++) {
        templates[i] = (struct iso_metric_vector){.n = 1};
    }
    *probe = (struct iso_metric_vector){.n = 1};
    for (int d = 0; d < world->metric->n_dimensions; d++) {
        const double spread = sqrt((double)world->metric->between[d]);
        const double own = spread * (common_offset + normal());
        for (int i = 0; i < n; i++) {
            templates[i].mean[d] = (float)(own + normal());
        }
        probe->mean[d] = (float)(own + normal());
    }
}

static void make_world(struct world *world, int people, int attackers)
{
    random_state = 17;
    world->people = people;
    world->attackers = attackers;
    for (int p = 0; p < people; p++) {
        draw_person(world, world->templates[p], TEMPLATES, &world->probe[p]);
    }
    for (int s = 0; s < STRANGERS; s++) {
        draw_person(world, NULL, 0, &world->stranger[s]);
        for (int d = 0; s < ALIKE && d < world->metric->n_dimensions; d++) {
            world->stranger[s].mean[d] += world->probe[s].mean[d];
            world->stranger[s].mean[d] *= 0.5f;
        }
    }
}

/* Adapts the metric to the honest people and to the attackers with n templates each, if n is not 0.
 */
static struct iso_site_metric adapt(const struct world *world,
                                    const struct iso_metric_vector *attacker, int n)
{
    struct iso_site_metric adapted;
    struct iso_site *site = NULL;
    assert_int_equal(iso_site_new(world->metric, &site), 0);
    for (int p = 0; p < world->people; p++) {
        assert_int_equal(iso_site_add(site, p, world->templates[p], TEMPLATES), 0);
    }
    for (int a = 0; n > 0 && a < world->attackers; a++) {
        assert_int_equal(iso_site_add(site, attacker_numbers[a], attacker, n), 0);
    }
    assert_int_equal(iso_site_find_directions(site), 0);
    for (int p = 0; p < world->people; p++) {
        assert_int_equal(iso_site_review(site, world->templates[p], TEMPLATES), 0);
    }
    for (int a = 0; n > 0 && a < world->attackers; a++) {
        assert_int_equal(iso_site_review(site, attacker, n), 0);
    }
    assert_int_equal(iso_site_adapt(site, world->metric, &adapted), 0);
    iso_site_free(site);
    return adapted;
}

/* Computes the score of a person and a probe by the shipped metric. */
static double score_one(const struct world *world, const struct iso_site_metric *adapted,
                        int number, const struct iso_metric_vector *probe)
{
    struct iso_metric_vector one, person = {.n = 0};
    for (int i = 0; i < TEMPLATES; i++) {
        iso_site_turn(adapted, &world->templates[number][i], &one);
        iso_metric_vector_add(adapted->metric, &one, &person);
    }
    iso_site_turn(adapted, probe, &one);
    return iso_site_score(adapted, number, &person, &one);
}

static void score_all(const struct world *world, const struct iso_metric_vector *attacker, int n,
                      struct scores *scores)
{
    struct iso_site_metric adapted = adapt(world, attacker, n);
    scores->highest = -INFINITY;
    for (int p = 0; p < world->people; p++) {
        scores->mated[p] = score_one(world, &adapted, p, &world->probe[p]);
        for (int s = 0; s < STRANGERS; s++) {
            const double score = score_one(world, &adapted, p, &world->stranger[s]);
            scores->highest = fmax(scores->highest, score);
        }
    }
    iso_site_metric_free(&adapted);
}

/* ---- attacks ---- */

/* The worst that attacks have done so far. */
struct damage {
    double highest, falls;
};

/* Enrols the attacker and compares the scores. */
static void attack(struct world *world, const struct scores *before,
                   const struct iso_metric_vector *captures, int n, struct damage *worst)
{
    struct scores after;
    score_all(world, captures, n, &after);
    worst->highest = fmax(worst->highest, after.highest);
    for (int p = 0; p < world->people; p++) {
        worst->falls = fmax(worst->falls, before->mated[p] - after.mated[p]);
    }
}

/* One template far along a direction, and templates that are spread along it, both ways. */
static void attack_along(struct world *world, const struct scores *before, const float *direction,
                         struct damage *worst)
{
    static const float far = 1e5f;
    struct iso_metric_vector captures[ATTACK_TEMPLATES];
    for (int way = -1; way <= 1; way += 2) {
        for (int i = 0; i < ATTACK_TEMPLATES; i++) {
            captures[i] = (struct iso_metric_vector){.n = 1};
            for (int d = 0; d < world->metric->n_dimensions; d++) {
                captures[i].mean[d] = (float)way * far * direction[d];
            }
        }
        attack(world, before, captures, 1, worst);
        for (int i = 0; i < ATTACK_TEMPLATES; i++) {
            for (int d = 0; d < world->metric->n_dimensions; d++) {
                captures[i].mean[d] = (i % 2 ? 1.0f : -1.0f) * far * direction[d];
            }
        }
        attack(world, before, captures, ATTACK_TEMPLATES, worst);
        for (int i = 0; i < ATTACK_TEMPLATES / 2; i++) {
            for (int d = 0; d < world->metric->n_dimensions; d++) {
                captures[2 * i].mean[d] = 3.0f * (float)way * far * direction[d];
            }
        }
        attack(world, before, captures, ATTACK_TEMPLATES, worst);
    }
}

static void attack_everything(struct world *world, const struct scores *before,
                              struct damage *worst)
{
    const int n = world->metric->n_dimensions;
    float direction[ISO_METRIC_DIMENSIONS_MAX];
    for (int axis = 0; axis < n; axis += axis < 12 ? 1 : 35) {
        for (int d = 0; d < n; d++) {
            direction[d] = d == axis ? 1.0f : 0.0f;
        }
        attack_along(world, before, direction, worst);
    }
    for (int s = 0; s < STRANGERS; s++) {
        for (int from_mean = 0; from_mean <= 1; from_mean++) {
            for (int d = 0; d < n; d++) {
                const float from = from_mean ? 0.0f : world->stranger[s].mean[d];
                direction[d] = world->templates[s][0].mean[d] - from;
            }
            attack_along(world, before, direction, worst);
        }
    }
}

static void nobody_moves_the_scores_of_others_far(void **state)
{
    static struct world world;
    static struct scores before;
    struct iso_metric *metric = metric_of_people();
    (void)state;
    world.metric = metric;
    for (size_t i = 0; i < sizeof bounds / sizeof *bounds; i++) {
        make_world(&world, bounds[i].people, bounds[i].attackers);
        score_all(&world, NULL, 0, &before);
        struct damage worst = {before.highest, 0.0};
        attack_everything(&world, &before, &worst);
        print_message(
            "%d people and %d more who attack: the highest score of a stranger is %.2f and "
            "becomes %.2f; a person falls by at most %.2f\n",
            bounds[i].people, bounds[i].attackers, before.highest, worst.highest, worst.falls);
        assert_true(worst.highest > before.highest && worst.falls > 0.0);
        assert_true(worst.highest <= before.highest + bounds[i].rises);
        assert_true(worst.falls <= bounds[i].falls);
    }
    iso_metric_free(metric);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nobody_moves_the_scores_of_others_far),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
