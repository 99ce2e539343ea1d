/* Two people stand at the door, and one of them is enrolled. The person in front is the visitor.
 * `isotherm-sim generate --preset pairs` and `replay` do the same with more people. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "sim/door/rehearsal.h"
#include "tests/sim/world/generated.h"
#include "tests/support/scratch.h"

static void pass(const struct sim_visit *visit, void *context)
{
    (void)visit;
    (void)context;
}

static void the_person_in_front_is_the_visitor(void **state)
{
    struct sim_generate_options pairs = generated_options("pairs", scratch_path(*state, "corpus"));
    struct iso_fault fault = {.text = ""};
    struct sim_visit visits[8];
    size_t n = 0;
    pairs.n_people = 1;
    pairs.n_probes = 1;
    pairs.n_strangers = 1;
    pairs.frames_per_visit = 5;
    struct sim_corpus *corpus = generated_corpus(&pairs);
    const struct sim_rehearsal_options options = {
        .corpus = pairs.directory,
        .state = scratch_path(*state, "state"),
        .model = ISOTHERM_SOURCE_DIR "/core/data/head.model",
        .metric = ISOTHERM_SOURCE_DIR "/core/data/face.metric",
        .threshold = NAN,
    };
    scratch_mkdir(options.state);
    if (sim_rehearse(&options, corpus, pass, NULL, visits, &n, &fault)) {
        fail_msg("%s", fault.text);
    }
    for (size_t i = 0; i < corpus->n_rows; i++) {
        /* The note begins with the source of the people. */
        assert_true(sim_corpus_row_is_of(&corpus->rows[i], "test-1"));
    }
    assert_int_equal(n, 2);
    assert_string_equal(visits[0].row->note, "test-1 stranger-behind");
    assert_true(visits[0].unlocked);
    assert_string_equal(visits[0].verdict.person, "p0000");
    assert_string_equal(visits[1].row->note, "test-1 enrolled-behind");
    assert_false(visits[1].unlocked || visits[1].verdict.allow);
    sim_corpus_free(corpus);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(the_person_in_front_is_the_visitor, scratch_setup,
                                        scratch_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
