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
    struct sim_level_counts counts = {{0, 0}, {0, 0}, {0, 0}};
    sim_level_count(crowd, visits, sizeof visits / sizeof *visits, &counts);
    return counts;
}

static void people_and_strangers_are_counted_apart(void **state)
{
    (void)state;
    const struct sim_level_counts counts = count(SIM_CROWD_PEOPLE);
    assert_int_equal(counts.refused.events, 2);
    assert_int_equal(counts.refused.trials, 3);
    assert_int_equal(counts.strangers.events, 1);
    assert_int_equal(counts.strangers.trials, 4);
    assert_int_equal(counts.alike.trials, 0);
}

static void of_people_alike_only_strangers_count(void **state)
{
    (void)state;
    const struct sim_level_counts counts = count(SIM_CROWD_ALIKE);
    assert_int_equal(counts.refused.trials, 0);
    assert_int_equal(counts.strangers.trials, 0);
    assert_int_equal(counts.alike.events, 1);
    assert_int_equal(counts.alike.trials, 4);
}

static void corpora_add_up(void **state)
{
    (void)state;
    const struct sim_visit visits[] = {visit_of(&stranger, "ada")};
    struct sim_level_counts counts = count(SIM_CROWD_PEOPLE);
    sim_level_count(SIM_CROWD_PEOPLE, visits, 1, &counts);
    assert_int_equal(counts.strangers.events, 2);
    assert_int_equal(counts.strangers.trials, 5);
}

/* No event in 1,000: the rate is at most 0.37 % with 95 % confidence (Clopper and Pearson: 1 -
 * 0.025^(1/1000)). */
static void the_table_has_rates_intervals_and_counts(void **state)
{
    (void)state;
    const struct sim_level_counts counts[SIM_LEVELS] = {
        {{5, 1000}, {3, 1000}, {0, 0}},
        {{6, 1000}, {0, 1000}, {0, 0}},
        {{7, 1000}, {0, 1000}, {1, 2}},
    };
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    assert_non_null(out);
    sim_level_print(counts, out);
    assert_int_equal(fclose(out), 0);
    assert_non_null(strstr(text, "| `convenient` | 0.5 % [0.16, 1.16] (5 of 1000) |"));
    assert_non_null(
        strstr(text, "(6 of 1000) | 0.0 % [0.00, 0.37] (0 of 1000) | not measured |\n"));
    assert_non_null(strstr(text, "| 50.0 % [1.26, 98.74] (1 of 2) |\n"));
    free(text);
}

static void the_file_has_a_line_for_each(void **state)
{
    const struct sim_level_counts counts[SIM_LEVELS] = {
        {{5, 1000}, {3, 1000}, {0, 0}},
        {{6, 1000}, {1, 1000}, {0, 0}},
        {{7, 1000}, {0, 1000}, {1, 2}},
    };
    struct iso_fault fault = {.text = ""};
    assert_int_equal(sim_level_write_csv(*state, counts, &fault), 0);
    size_t size = 0;
    char *bytes = scratch_read(scratch_path(*state, "levels.csv"), &size);
    char *text = strndup(bytes, size);
    assert_non_null(text);
    assert_non_null(
        strstr(text, "level,who,errors,visits,rate,low,high\nconvenient,refused,5,1000,"));
    assert_non_null(strstr(text, "\nbalanced,strangers,1,1000,0.001000,"));
    assert_non_null(strstr(text, "\nstrict,alike,1,2,0.500000,"));
    free(text);
    free(bytes);
    assert_int_equal(sim_level_write_csv("/nowhere", counts, &fault), -ENOENT);
    assert_non_null(strstr(fault.text, "/nowhere/levels.csv"));
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
        cmocka_unit_test(a_frame_is_extracted_once),
        cmocka_unit_test(a_failure_is_not_remembered),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
