/* Counts of visits at each security level, and appliances that share the template of a frame. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "sim/door/level_report.h"
#include "sim/door/shared_extraction.h"
#include "sim/lab/measure/rate.h"
#include "tests/support/near.h"
#include "tests/support/scratch.h"

/* ---- counts ---- */

static const struct sim_corpus_row ada = {.subject = "ada", .role = SIM_ROLE_PROBE};
static const struct sim_corpus_row stranger = {.subject = "x1", .role = SIM_ROLE_IMPOSTOR};

static struct sim_visit visit_of(const struct sim_corpus_row *row, const char *let_in_as)
{
    struct sim_visit visit = {.row = row};
    visit.verdict.given = true;
    visit.verdict.allow = visit.unlocked = let_in_as != NULL;
    (void)snprintf(visit.verdict.person, sizeof visit.verdict.person, "%s",
                   let_in_as ? let_in_as : "");
    return visit;
}

/* The enrolled person is admitted once, refused once, and taken for another person once. One of
 * four visits of a stranger is admitted. */
static struct sim_level_counts count(enum sim_level_crowd crowd)
{
    const struct sim_visit visits[] = {
        visit_of(&ada, "ada"),     visit_of(&ada, NULL),       visit_of(&ada, "bob"),
        visit_of(&stranger, NULL), visit_of(&stranger, "ada"), visit_of(&stranger, NULL),
        visit_of(&stranger, NULL),
    };
    struct sim_level_counts counts = {.refused = {.people = 0}};
    sim_level_count(crowd, visits, sizeof visits / sizeof *visits, &counts);
    return counts;
}

static void people_and_strangers_are_counted_apart(void **state)
{
    (void)state;
    const struct sim_level_counts counts = count(SIM_CROWD_PEOPLE);
    assert_int_equal(counts.refused.errors, 2);
    assert_int_equal(counts.refused.trials, 3);
    assert_int_equal(counts.strangers.errors, 1);
    assert_int_equal(counts.strangers.trials, 4);
    assert_int_equal(counts.alike.trials, 0);
}

static void of_people_alike_only_strangers_count(void **state)
{
    (void)state;
    const struct sim_level_counts counts = count(SIM_CROWD_ALIKE);
    assert_int_equal(counts.refused.trials, 0);
    assert_int_equal(counts.strangers.trials, 0);
    assert_int_equal(counts.alike.errors, 1);
    assert_int_equal(counts.alike.trials, 4);
}

static void corpora_add_up(void **state)
{
    (void)state;
    const struct sim_visit visits[] = {visit_of(&stranger, "ada")};
    struct sim_level_counts counts = count(SIM_CROWD_PEOPLE);
    sim_level_count(SIM_CROWD_PEOPLE, visits, 1, &counts);
    assert_int_equal(counts.strangers.errors, 2);
    assert_int_equal(counts.strangers.trials, 5);
}

/* A rate of this many people, each with one visit. */
static struct iso_people_rate one_visit_each(size_t errors, size_t people)
{
    struct iso_people_rate rate = {.people = 0};
    for (size_t i = 0; i < people; i++) {
        iso_people_rate_add(&rate, i < errors, 1);
    }
    return rate;
}

static void fill_counts(struct sim_level_counts counts[SIM_LEVELS])
{
    for (size_t level = 0; level < SIM_LEVELS; level++) {
        counts[level].refused = one_visit_each(5 + level, 1000);
        counts[level].strangers = one_visit_each(level == 0 ? 3 : level % 2, 1000);
        counts[level].alike = one_visit_each(1, level == SIM_LEVELS - 1 ? 2 : 0);
    }
}

/* No event in 1,000: the rate is at most 0.37 % with 95 % confidence (Clopper and Pearson: 1 -
 * 0.025^(1/1000)). */
static void the_table_has_rates_intervals_and_counts(void **state)
{
    (void)state;
    struct sim_level_counts counts[SIM_LEVELS];
    fill_counts(counts);
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    assert_non_null(out);
    sim_level_print_head(out);
    sim_level_print(counts, "", out);
    sim_level_print(counts, ", adapted", out);
    assert_int_equal(fclose(out), 0);
    assert_non_null(strstr(text, "| `convenient` | 0.5 % [0.16, 1.16] (5 of 1000) |"));
    assert_non_null(strstr(text, "(7 of 1000) | 0.0 % [0.00, 0.37] (0 of 1000) | 50.0 %"));
    assert_non_null(
        strstr(text, "(6 of 1000) | 0.1 % [0.00, 0.56] (1 of 1000) | not measured |\n"));
    assert_non_null(strstr(text, "| 50.0 % [1.26, 98.74] (1 of 2) |\n"));
    assert_non_null(strstr(text, "\n| `convenient`, adapted | 0.5 % [0.16, 1.16] (5 of 1000) |"));
    free(text);
}

static void the_file_has_a_line_for_each(void **state)
{
    struct sim_level_counts counts[SIM_LEVELS];
    struct iso_fault fault = {.text = ""};
    fill_counts(counts);
    assert_int_equal(sim_level_write_csv(*state, "levels.csv", counts, &fault), 0);
    size_t size = 0;
    char *bytes = scratch_read(scratch_path(*state, "levels.csv"), &size);
    char *text = strndup(bytes, size);
    assert_non_null(text);
    assert_non_null(
        strstr(text, "level,who,errors,visits,rate,low,high,people\nconvenient,refused,5,1000,"));
    assert_non_null(strstr(text, "\nbalanced,strangers,1,1000,0.001000,"));
    assert_non_null(strstr(text, "\nstrict,alike,1,2,0.500000,"));
    assert_non_null(strstr(text, ",2\n"));
    free(text);
    free(bytes);
    assert_int_equal(sim_level_write_csv("/nowhere", "levels.csv", counts, &fault), -ENOENT);
    assert_non_null(strstr(fault.text, "/nowhere/levels.csv"));
}

/* ---- intervals over people ---- */

static void assert_interval(struct iso_interval a, struct sim_interval b)
{
    assert_near(a.low, b.low, 1e-9);
    assert_near(a.high, b.high, 1e-9);
}

/* One visit each: the exact interval. If each of a hundred people always or never is refused, ten
 * visits of each say hardly more than one. If visits do not depend on people, they all count. */
static void dependent_visits_say_less(void **state)
{
    struct iso_people_rate same = {.people = 0}, even = {.people = 0};
    const struct iso_people_rate once = one_visit_each(3, 100);
    (void)state;
    for (size_t i = 0; i < 100; i++) {
        iso_people_rate_add(&same, i < 10 ? 10 : 0, 10);
        iso_people_rate_add(&even, 1, 10);
    }
    assert_interval(iso_people_rate_interval(&once),
                    sim_rate_exact_interval((struct sim_rate){3, 100}));
    assert_near(iso_people_rate_effective(&same), 99.0, 1e-6);
    assert_near(iso_people_rate_effective(&even), 1000.0, 1e-6);
    assert_interval(iso_people_rate_interval(&even),
                    sim_rate_exact_interval((struct sim_rate){100, 1000}));
    assert_true(iso_people_rate_interval(&same).high > 0.17);
}

static void no_error_counts_people(void **state)
{
    struct iso_people_rate rate = {.people = 0};
    (void)state;
    assert_interval(iso_people_rate_interval(&rate), (struct sim_interval){0.0, 1.0});
    for (size_t i = 0; i < 50; i++) {
        iso_people_rate_add(&rate, 0, 4);
    }
    assert_interval(iso_people_rate_interval(&rate),
                    sim_rate_exact_interval((struct sim_rate){0, 50}));
}

/* The three visits of ada are those of one person. */
static void people_are_counted_once(void **state)
{
    (void)state;
    const struct sim_level_counts counts = count(SIM_CROWD_PEOPLE);
    assert_int_equal(counts.refused.people, 1);
    assert_int_equal(counts.strangers.people, 1);
    assert_near(counts.refused.errors_squared, 4.0, 0.0);
    assert_near(counts.refused.trials_squared, 9.0, 0.0);
}

/* ---- templates that are shared ---- */

/* A pipeline that counts its calls. */
struct counter {
    int extracted, searched, error;
};

static int extract(void *self, const struct iso_frame *frame, const char *sensor,
                   struct iso_extraction *out)
{
    struct counter *counter = self;
    (void)sensor;
    counter->extracted++;
    if (!counter->error) {
        *out = (struct iso_extraction){.distance_mm = (double)frame->depth_mm[5]};
    }
    return counter->error;
}

static int search(void *self, const struct iso_candidate_list *among,
                  const struct iso_template *probe, struct iso_search_hit *hits, int capacity,
                  int *n_hits)
{
    (void)among;
    (void)probe;
    (void)hits;
    (void)capacity;
    *n_hits = 0;
    ((struct counter *)self)->searched++;
    return 0;
}

static const struct iso_pipeline_ops counter_ops = {.extract = extract, .search = search};

enum { WIDTH = 4, HEIGHT = 3 };

static struct iso_frame frame_of(float depth_mm[WIDTH * HEIGHT], int64_t t_ns)
{
    return (struct iso_frame){.width_px = WIDTH,
                              .height_px = HEIGHT,
                              .t_ns = t_ns,
                              .depth_mm = depth_mm,
                              .camera = {.width_px = WIDTH, .height_px = HEIGHT}};
}

/* Returns the pipeline's result for a frame whose sixth depth is `depth_mm`. */
static double seen_by(const struct iso_pipeline *pipeline, float depth_mm, int64_t t_ns)
{
    float depths_mm[WIDTH * HEIGHT] = {700, 701, 702, 703, 704, depth_mm};
    const struct iso_frame frame = frame_of(depths_mm, t_ns);
    struct iso_extraction extraction;
    assert_int_equal(pipeline->ops->extract(pipeline->self, &frame, "", &extraction), 0);
    return extraction.distance_mm;
}

static void a_frame_is_extracted_once(void **state)
{
    struct counter one = {0, 0, 0}, two = {0, 0, 0};
    const struct iso_pipeline own[] = {{&counter_ops, &one}, {&counter_ops, &two}};
    struct sim_shared_extraction shared = {.frame = NULL};
    struct sim_shared_pipeline joined[2];
    struct iso_pipeline first = sim_shared_pipeline_join(&shared, &own[0], &joined[0]);
    struct iso_pipeline second = sim_shared_pipeline_join(&shared, &own[1], &joined[1]);
    int n_hits = -1;
    (void)state;
    assert_true(seen_by(&first, 600, 1) == 600);
    assert_true(seen_by(&second, 600, 1) == 600);
    assert_int_equal(one.extracted, 1);
    assert_true(seen_by(&second, 601, 1) == 601); /* one depth differs */
    assert_true(seen_by(&first, 601, 2) == 601);  /* the time differs */
    assert_int_equal(one.extracted, 3);
    assert_int_equal(two.extracted, 0);
    assert_int_equal(second.ops->search(second.self, NULL, NULL, NULL, 0, &n_hits), 0);
    assert_int_equal(two.searched, 1); /* each searches its own gallery */
    assert_int_equal(one.searched, 0);
    assert_null(first.ops->seen);
    sim_shared_extraction_done(&shared);
}

static void a_failure_is_not_remembered(void **state)
{
    struct counter one = {0, 0, -ENOMEM};
    const struct iso_pipeline own = {&counter_ops, &one};
    struct sim_shared_extraction shared = {.frame = NULL};
    struct sim_shared_pipeline joined;
    struct iso_pipeline pipeline = sim_shared_pipeline_join(&shared, &own, &joined);
    float depths_mm[WIDTH * HEIGHT] = {0, 0, 0, 0, 0, 650};
    const struct iso_frame frame = frame_of(depths_mm, 1);
    struct iso_extraction extraction;
    (void)state;
    assert_int_equal(pipeline.ops->extract(pipeline.self, &frame, "", &extraction), -ENOMEM);
    one.error = 0;
    assert_int_equal(pipeline.ops->extract(pipeline.self, &frame, "", &extraction), 0);
    assert_int_equal(one.extracted, 2);
    assert_true(extraction.distance_mm == 650);
    sim_shared_extraction_done(&shared);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(people_and_strangers_are_counted_apart),
        cmocka_unit_test(of_people_alike_only_strangers_count),
        cmocka_unit_test(corpora_add_up),
        cmocka_unit_test(the_table_has_rates_intervals_and_counts),
        cmocka_unit_test_setup_teardown(the_file_has_a_line_for_each, scratch_setup,
                                        scratch_teardown),
        cmocka_unit_test(dependent_visits_say_less),
        cmocka_unit_test(no_error_counts_people),
        cmocka_unit_test(people_are_counted_once),
        cmocka_unit_test(a_frame_is_extracted_once),
        cmocka_unit_test(a_failure_is_not_remembered),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
