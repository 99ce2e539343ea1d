/* The whole appliance on a virtual clock, with a few stored recordings. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "firmware/daemon/components.h"
#include "sim/base/virtual_clock.h"
#include "sim/door/level_report.h"
#include "sim/door/rehearsal.h"
#include "tests/support/scratch.h"
#include "tests/support/stored_corpus.h"

#define STORED ISOTHERM_SOURCE_DIR "/sim/stored"

enum { ROWS = 6, VISITS = 4 };

static const char manifest[] = STORED_CORPUS_HEADER "p01-enrol,0,5,p01,e,gallery,,,\n"
                                                    "p02-enrol,0,5,p02,e,gallery,,,\n"
                                                    "p01-v1,0,3,p01,v1,probe,,mild,\n"
                                                    "p02-v1,0,3,p02,v1,probe,,mild,\n"
                                                    "x01-v1,0,3,x01,v1,impostor,,,\n"
                                                    "none-photo1,0,3,none,n,impostor,,,photo\n";

static int setup(void **state)
{
    int error = scratch_setup(state);
    if (!error) {
        stored_corpus_make(*state, manifest);
    }
    return error;
}

static void count_visit(const struct sim_visit *visit, void *context)
{
    (void)visit;
    ++*(size_t *)context;
}

/* Runs with a state directory of that name. Returns the error. */
static int rehearse(const char *directory, const char *state, double threshold,
                    struct sim_corpus **corpus, struct sim_visit visits[ROWS])
{
    const struct sim_rehearsal_options options = {
        .corpus = directory,
        .state = scratch_path(directory, state),
        .model = ISOTHERM_SOURCE_DIR "/core/data/head.model",
        .metric = ISOTHERM_SOURCE_DIR "/core/data/face.metric",
        .threshold = threshold,
    };
    struct iso_fault fault = {.text = ""};
    size_t n_visits = 0, told = 0;
    scratch_mkdir(options.state);
    assert_int_equal(sim_corpus_read(directory, corpus, &fault), 0);
    int error = sim_rehearse(&options, *corpus, count_visit, &told, visits, &n_visits, &fault);
    if (!error) {
        assert_int_equal(n_visits, VISITS);
        assert_int_equal(told, VISITS);
    } else {
        assert_true(fault.text[0] != '\0');
    }
    return error;
}

static void the_right_people_are_let_in(void **state)
{
    struct sim_corpus *corpus = NULL;
    struct sim_visit visits[ROWS];
    assert_int_equal(rehearse(*state, "run", NAN, &corpus, visits), 0);
    assert_true(visits[0].verdict.allow && visits[0].unlocked);
    assert_string_equal(visits[0].verdict.person, "p01");
    assert_string_equal(visits[0].verdict.reason, "match");
    assert_true(visits[1].verdict.allow && visits[1].unlocked);
    assert_string_equal(visits[1].verdict.person, "p02");
    assert_true(visits[2].verdict.given && !visits[2].verdict.allow && !visits[2].unlocked);
    assert_true(!visits[3].verdict.allow && !visits[3].unlocked); /* a photograph is not admitted */
    assert_true(sim_visit_judge(visits, VISITS).good);
    sim_corpus_free(corpus);
}

/* Returns the text of a run's audit log, to be freed. The random identifier of the gallery is
 * replaced. */
static char *log_of(const char *directory, const char *run)
{
    struct iso_config config = iso_config_default();
    const struct iso_times times = iso_times_system();
    struct iso_fault fault = {.text = ""};
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    assert_non_null(out);
    config.log.journal = false;
    (void)snprintf(config.gallery.path, sizeof config.gallery.path, "%s/%s/gallery.db", directory,
                   run);
    (void)snprintf(config.log.path, sizeof config.log.path, "%s/%s/audit.log", directory, run);
    if (iso_components_print_log(&config, &times, out, &fault)) {
        fail_msg("%s", fault.text);
    }
    assert_int_equal(fclose(out), 0);
    for (char *at = text; (at = strstr(at, "\"gallery\":\"")); at++) {
        memset(at + 11, 'x', 16);
    }
    return text;
}

/* The time is virtual, so that no result depends on the speed of the machine. */
static void two_runs_are_the_same_to_the_bit(void **state)
{
    struct sim_corpus *corpus[2] = {NULL, NULL};
    struct sim_visit visits[2][ROWS];
    assert_int_equal(rehearse(*state, "one", NAN, &corpus[0], visits[0]), 0);
    assert_int_equal(rehearse(*state, "two", NAN, &corpus[1], visits[1]), 0);
    for (int i = 0; i < VISITS; i++) {
        const struct sim_door_verdict *a = &visits[0][i].verdict, *b = &visits[1][i].verdict;
        assert_int_equal(a->given, b->given);
        assert_int_equal(visits[0][i].unlocked, visits[1][i].unlocked);
        if (a->given) {
            assert_memory_equal(&a->score, &b->score, sizeof a->score);
            assert_int_equal(a->latency_us, b->latency_us);
        }
    }
    char *log[2] = {log_of(*state, "one"), log_of(*state, "two")};
    assert_string_equal(log[0], log[1]);
    free(log[0]);
    free(log[1]);
    sim_corpus_free(corpus[0]);
    sim_corpus_free(corpus[1]);
}

static void the_threshold_decides(void **state)
{
    struct sim_corpus *corpus = NULL;
    struct sim_visit visits[ROWS];
    assert_int_equal(rehearse(*state, "strict", 50.0, &corpus, visits), 0);
    const struct sim_visit_summary summary = sim_visit_judge(visits, VISITS);
    assert_int_equal(summary.people_admitted, 0);
    assert_int_equal(summary.impostors_let_in, 0);
    assert_false(summary.good);
    sim_corpus_free(corpus);
}

/* Plays the visits at one level, or at all levels side by side. */
static void rehearse_levels(const char *directory, const char *state, const enum iso_level *level,
                            const struct sim_corpus *corpus, struct sim_visit *visits)
{
    const struct sim_rehearsal_options options = {
        .corpus = directory,
        .state = scratch_path(directory, state),
        .model = ISOTHERM_SOURCE_DIR "/core/data/head.model",
        .metric = ISOTHERM_SOURCE_DIR "/core/data/face.metric",
        .threshold = NAN,
        .level = level,
        .all_levels = level == NULL,
    };
    struct iso_fault fault = {.text = ""};
    size_t n_visits = 0, told = 0;
    scratch_mkdir(options.state);
    if (sim_rehearse(&options, corpus, count_visit, &told, visits, &n_visits, &fault)) {
        fail_msg("%s", fault.text);
    }
    assert_int_equal(n_visits, VISITS);
    assert_int_equal(told, level ? VISITS : SIM_LEVELS * VISITS);
}

static void assert_same_visit(const struct sim_visit *a, const struct sim_visit *b)
{
    assert_ptr_equal(a->row, b->row);
    assert_int_equal(a->unlocked, b->unlocked);
    assert_int_equal(a->verdict.given, b->verdict.given);
    assert_int_equal(a->verdict.allow, b->verdict.allow);
    assert_string_equal(a->verdict.person, b->verdict.person);
    assert_string_equal(a->verdict.reason, b->verdict.reason);
    assert_int_equal(a->verdict.frames, b->verdict.frames);
    assert_memory_equal(&a->verdict.score, &b->verdict.score, sizeof a->verdict.score);
    assert_true(a->verdict.threshold == b->verdict.threshold);
}

/* Three doors share the templates of their frames. Each door decides exactly as it would alone, and
 * so counts the same visits. */
static void every_level_decides_as_it_would_alone(void **state)
{
    struct sim_corpus *corpus = NULL;
    struct sim_visit together[SIM_LEVELS * ROWS], alone[ROWS];
    assert_int_equal(sim_corpus_read(*state, &corpus, NULL), 0);
    rehearse_levels(*state, "together", NULL, corpus, together);
    for (int l = 0; l < SIM_LEVELS; l++) {
        const enum iso_level level = (enum iso_level)l;
        const struct sim_visit *own = &together[(size_t)l * ROWS];
        rehearse_levels(*state, sim_level_name(level), &level, corpus, alone);
        for (int i = 0; i < VISITS; i++) {
            assert_same_visit(&own[i], &alone[i]);
        }
        struct sim_level_counts a, b;
        memset(&a, 0, sizeof a);
        memset(&b, 0, sizeof b);
        sim_level_count(SIM_CROWD_PEOPLE, own, VISITS, &a);
        sim_level_count(SIM_CROWD_PEOPLE, alone, VISITS, &b);
        assert_memory_equal(&a, &b, sizeof a);
        assert_int_equal(a.refused.trials, 2);
        assert_int_equal(a.strangers.trials, 2);
    }
    /* The doors have three levels. */
    assert_true(together[0].verdict.threshold < together[ROWS].verdict.threshold);
    assert_true(together[ROWS].verdict.threshold < together[2 * ROWS].verdict.threshold);
    sim_corpus_free(corpus);
}

/* Three people, the fewest that a metric adapts to. */
static const char three_people[] = STORED_CORPUS_HEADER "p01-enrol,0,5,p01,e,gallery,,,\n"
                                                        "p02-enrol,0,5,p02,e,gallery,,,\n"
                                                        "p03-enrol,0,5,p03,e,gallery,,,\n"
                                                        "p01-v1,0,3,p01,v1,probe,,mild,\n"
                                                        "x01-v1,0,3,x01,v1,impostor,,,\n";

enum { ADAPTED_ROWS = 5, ADAPTED_VISITS = 2 };

static void rehearse_adapted(const char *directory, const char *state,
                             struct sim_rehearsal_options options, const struct sim_corpus *corpus,
                             size_t doors, struct sim_visit *visits)
{
    struct iso_fault fault = {.text = ""};
    size_t n_visits = 0, told = 0;
    options.corpus = directory;
    options.state = scratch_path(directory, state);
    options.model = ISOTHERM_SOURCE_DIR "/core/data/head.model";
    options.metric = ISOTHERM_SOURCE_DIR "/core/data/face.metric";
    options.threshold = NAN;
    scratch_mkdir(options.state);
    if (sim_rehearse(&options, corpus, count_visit, &told, visits, &n_visits, &fault)) {
        fail_msg("%s", fault.text);
    }
    assert_int_equal(n_visits, ADAPTED_VISITS);
    assert_int_equal(told, doors * ADAPTED_VISITS);
}

/* Doors that adapt their metric stand beside doors that do not. Both decide as they would alone. */
static void doors_that_adapt_stand_beside_the_others(void **state)
{
    const enum iso_level strict = ISO_LEVEL_STRICT;
    struct sim_corpus *corpus = NULL;
    struct sim_visit both[SIM_DOORS_MAX * ADAPTED_ROWS], alone[ADAPTED_ROWS];
    stored_corpus_make(*state, three_people);
    assert_int_equal(sim_corpus_read(*state, &corpus, NULL), 0);
    rehearse_adapted(*state, "both",
                     (struct sim_rehearsal_options){.all_levels = true, .adapt_too = true}, corpus,
                     SIM_DOORS_MAX, both);
    for (int adapt = 0; adapt < 2; adapt++) {
        const size_t door = (size_t)adapt * SIM_LEVELS + ISO_LEVEL_STRICT;
        rehearse_adapted(*state, adapt ? "yes" : "no",
                         (struct sim_rehearsal_options){.level = &strict, .adapt = adapt == 1},
                         corpus, 1, alone);
        for (int i = 0; i < ADAPTED_VISITS; i++) {
            assert_same_visit(&both[door * ADAPTED_ROWS + (size_t)i], &alone[i]);
        }
    }
    const struct sim_visit *shipped = &both[ISO_LEVEL_STRICT * ADAPTED_ROWS];
    const struct sim_visit *adapted = &both[(SIM_LEVELS + ISO_LEVEL_STRICT) * ADAPTED_ROWS];
    assert_true(shipped->verdict.allow && adapted->verdict.allow);
    assert_true(shipped->verdict.score != adapted->verdict.score);
    sim_corpus_free(corpus);
}

static void a_person_who_cannot_be_enrolled_is_a_fault(void **state)
{
    /* The same face is enrolled under two names. */
    scratch_write_text(scratch_path(*state, "manifest.csv"),
                       STORED_CORPUS_HEADER "p01-enrol,0,5,ada,e,gallery,,,\n"
                                            "p01-v1,0,3,ada,v1,probe,,mild,\n"
                                            "p02-enrol,0,5,bob,e,gallery,,,\n");
    assert_int_equal(unlink(scratch_path(*state, "p02-enrol")), 0);
    assert_int_equal(symlink(STORED "/p01-enrol", scratch_path(*state, "p02-enrol")), 0);
    struct sim_corpus *corpus = NULL;
    struct sim_visit visits[ROWS];
    assert_int_equal(rehearse(*state, "twice", NAN, &corpus, visits), -ENOMSG);

    /* Duplicates can be left out: then one face has one name, and the visit is that person's. */
    size_t not_enrolled = 0, n_visits = 0, told = 0;
    const struct sim_rehearsal_options options = {
        .corpus = *state,
        .state = scratch_path(*state, "left-out"),
        .model = ISOTHERM_SOURCE_DIR "/core/data/head.model",
        .metric = ISOTHERM_SOURCE_DIR "/core/data/face.metric",
        .threshold = NAN,
        .not_enrolled = &not_enrolled,
    };
    scratch_mkdir(options.state);
    assert_int_equal(sim_rehearse(&options, corpus, count_visit, &told, visits, &n_visits, NULL),
                     0);
    assert_int_equal(not_enrolled, 1);
    assert_int_equal(n_visits, 1);
    assert_string_equal(visits[0].verdict.person, "ada");
    sim_corpus_free(corpus);
}

static void the_clock_moves_only_when_told(void **state)
{
    (void)state;
    struct sim_virtual_clock clock = sim_virtual_clock_start();
    const struct iso_times times = sim_virtual_clock_times(&clock);
    assert_int_equal(iso_times_now_ns(&times), 0);
    assert_true(iso_wall_is_set(iso_times_wall_ns(&times) / ISO_NS_PER_S));
    sim_virtual_clock_advance(&clock, 5 * ISO_NS_PER_S);
    sim_virtual_clock_advance(&clock, 2 * ISO_NS_PER_S); /* the clock never goes back */
    assert_int_equal(iso_times_now_ns(&times), 5 * ISO_NS_PER_S);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(the_right_people_are_let_in, setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(two_runs_are_the_same_to_the_bit, setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(the_threshold_decides, setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(every_level_decides_as_it_would_alone, setup,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(doors_that_adapt_stand_beside_the_others, scratch_setup,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(a_person_who_cannot_be_enrolled_is_a_fault, setup,
                                        scratch_teardown),
        cmocka_unit_test(the_clock_moves_only_when_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
