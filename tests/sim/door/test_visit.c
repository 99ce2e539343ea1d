/* The slot, and the counts of a day of visits. Visits at a running door are in tests/e2e. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "sim/door/slot.h"
#include "sim/door/visit.h"
#include "sim/door/visit_report.h"
#include "tests/support/scratch.h"

static void assert_names(const char *slot, const char *corpus, const char *recording)
{
    char target[PATH_MAX] = "", expected[PATH_MAX];

    assert_true(readlink(slot, target, sizeof target - 1) > 0);
    (void)snprintf(expected, sizeof expected, "%s/%s", corpus, recording);
    assert_string_equal(target, expected);
}

static void the_slot_is_pointed_and_cleared(void **state)
{
    const char *corpus = *state, *slot = scratch_path(corpus, "slot");
    struct iso_fault fault = {.text = ""};

    assert_int_equal(sim_slot_clear(slot, &fault), 0); /* the slot is empty already */
    assert_int_equal(sim_slot_point(slot, corpus, "anna-v1", &fault), 0);
    assert_names(slot, corpus, "anna-v1");
    assert_int_equal(sim_slot_point(slot, corpus, "bob-v2", &fault), 0);
    assert_names(slot, corpus, "bob-v2");
    assert_int_equal(sim_slot_clear(slot, &fault), 0);
    assert_false(scratch_exists(slot));
    assert_false(scratch_exists(scratch_path(corpus, "slot.next")));
}

static void a_relative_corpus_is_made_absolute(void **state)
{
    const char *corpus = *state, *slot = scratch_path(corpus, "slot");
    struct iso_fault fault = {.text = ""};

    assert_int_equal(chdir(corpus), 0);
    assert_int_equal(sim_slot_point(slot, ".", "anna-v1", &fault), 0);
    assert_names(slot, corpus, "anna-v1");
    assert_int_equal(chdir("/"), 0);
}

static void a_killed_run_does_not_stand_in_the_way(void **state)
{
    const char *corpus = *state, *slot = scratch_path(corpus, "slot");
    struct iso_fault fault = {.text = ""};

    scratch_write_text(scratch_path(corpus, "slot.next"), "left over");
    assert_int_equal(sim_slot_point(slot, corpus, "anna-v1", &fault), 0);
    assert_names(slot, corpus, "anna-v1");
}

static void a_file_that_is_no_link_is_left_alone(void **state)
{
    const char *corpus = *state, *slot = scratch_path(corpus, "slot");
    struct iso_fault fault = {.text = ""};

    scratch_write_text(slot, "precious");
    assert_int_equal(sim_slot_point(slot, corpus, "anna-v1", &fault), -EINVAL);
    assert_non_null(strstr(fault.text, "slot: is no symbolic link"));
    assert_int_equal(sim_slot_clear(slot, &fault), -EINVAL);
    assert_true(scratch_exists(slot));
}

static void a_slot_that_cannot_be_made_is_named(void **state)
{
    struct iso_fault fault = {.text = ""};
    const char *slot = scratch_path(*state, "missing/slot");

    assert_int_equal(sim_slot_point(slot, *state, "anna-v1", &fault), -ENOENT);
    assert_non_null(strstr(fault.text, "missing/slot: "));
    assert_int_equal(sim_slot_point(scratch_path(*state, "slot"), "/nowhere", "a", &fault),
                     -ENOENT);
    assert_non_null(strstr(fault.text, "/nowhere: "));
}

static const struct sim_corpus_row anna_1 = {
    .recording = "anna-v1", .count = 3, .subject = "anna", .role = SIM_ROLE_PROBE};
static const struct sim_corpus_row anna_2 = {
    .recording = "anna-v2", .count = 3, .subject = "anna", .role = SIM_ROLE_PROBE};
static const struct sim_corpus_row bob_1 = {
    .recording = "bob-v1", .count = 3, .subject = "bob", .role = SIM_ROLE_PROBE};
static const struct sim_corpus_row stranger = {
    .recording = "x01-v1", .count = 3, .subject = "x01", .role = SIM_ROLE_IMPOSTOR};
static const struct sim_corpus_row nobody = {.recording = "nobody",
                                             .count = 3,
                                             .subject = "none",
                                             .role = SIM_ROLE_IMPOSTOR,
                                             .note = "nobody"};

static struct sim_visit visit(const struct sim_corpus_row *row, bool allow, const char *person)
{
    struct sim_visit made = {.row = row, .unlocked = allow};

    made.verdict = (struct sim_door_verdict){.given = true,
                                             .allow = allow,
                                             .score = 2.5,
                                             .threshold = 3,
                                             .frames = 2,
                                             .latency_us = 123456};
    (void)snprintf(made.verdict.person, sizeof made.verdict.person, "%s", person);
    (void)snprintf(made.verdict.reason, sizeof made.verdict.reason, allow ? "match" : "unknown");
    return made;
}

static void one_admittance_of_each_person_will_do(void **state)
{
    const struct sim_visit visits[] = {
        visit(&anna_1, false, ""),    visit(&bob_1, true, "bob"), visit(&stranger, false, ""),
        visit(&anna_2, true, "anna"), {.row = &nobody},
    };
    const struct sim_visit_summary summary = sim_visit_judge(visits, 5);

    (void)state;
    assert_int_equal(summary.people, 2);
    assert_int_equal(summary.people_admitted, 2);
    assert_int_equal(summary.probes, 3);
    assert_int_equal(summary.probes_admitted, 2);
    assert_int_equal(summary.impostors, 2);
    assert_int_equal(summary.impostors_let_in, 0);
    assert_true(summary.good);
}

static void somebody_refused_at_every_visit_is_not_good(void **state)
{
    const struct sim_visit visits[] = {
        visit(&anna_1, false, ""), {.row = &anna_2}, visit(&bob_1, true, "bob")};
    const struct sim_visit_summary summary = sim_visit_judge(visits, 3);

    (void)state;
    assert_int_equal(summary.people_admitted, 1);
    assert_false(summary.good);
}

/* A visit with the verdict "allow" whose door did not unlock admitted nobody. For a stranger the
 * verdict is still a false one. */
static void a_door_that_did_not_unlock_admits_nobody(void **state)
{
    struct sim_visit visits[] = {visit(&bob_1, true, "bob"), visit(&stranger, true, "bob")};

    (void)state;
    for (size_t i = 0; i < 2; i++) {
        visits[i].unlocked = false;
        (void)snprintf(visits[i].verdict.door, sizeof visits[i].verdict.door, "not-unlocked");
    }
    const struct sim_visit_summary summary = sim_visit_judge(visits, 2);
    assert_int_equal(summary.probes_admitted, 0);
    assert_int_equal(summary.people_admitted, 0);
    assert_int_equal(summary.impostors_let_in, 1);
    assert_false(summary.good);
}

static void a_stranger_let_in_is_not_good(void **state)
{
    const struct sim_visit visits[] = {visit(&bob_1, true, "bob"), visit(&stranger, true, "bob")};
    const struct sim_visit_summary summary = sim_visit_judge(visits, 2);

    (void)state;
    assert_int_equal(summary.impostors_let_in, 1);
    assert_false(summary.good);
}

static void somebody_taken_for_another_is_not_good(void **state)
{
    const struct sim_visit visits[] = {visit(&anna_1, true, "bob"), visit(&anna_2, true, "anna")};
    const struct sim_visit_summary summary = sim_visit_judge(visits, 2);

    (void)state;
    assert_int_equal(summary.people_admitted, 1);
    assert_int_equal(summary.probes_admitted, 1);
    assert_int_equal(summary.misnamed, 1);
    assert_false(summary.good);
}

static void a_door_that_opens_for_nobody_is_not_good(void **state)
{
    const struct sim_visit visits[] = {visit(&bob_1, true, "bob"),
                                       {.row = &nobody, .unlocked = true}};

    (void)state;
    assert_false(sim_visit_judge(visits, 2).good);
    assert_false(sim_visit_judge(visits, 0).good); /* no frame was shown */
    assert_true(sim_visit_judge(visits, 1).good);
}

static void visits_are_written_as_csv(void **state)
{
    struct sim_visit visits[] = {
        visit(&anna_1, true, "anna"), visit(&stranger, false, ""), {.row = &nobody}};
    struct iso_fault fault = {.text = ""};
    size_t size;

    visits[1].verdict.score = NAN;
    assert_int_equal(sim_visit_write_csv(*state, visits, 3, &fault), 0);
    char *text = scratch_read(scratch_path(*state, "visits.csv"), &size);
    static const char expected[] =
        "recording,subject,role,note,verdict,person,score,threshold,frames,latency_ms,door,"
        "reason\n"
        "anna-v1,anna,probe,,allow,anna,2.500000,3.000000,2,123.456,unlocked,match\n"
        "x01-v1,x01,impostor,,deny,,,3.000000,2,123.456,locked,unknown\n"
        "nobody,none,impostor,nobody,none,,,,,,locked,\n";
    assert_int_equal(size, sizeof expected - 1);
    assert_memory_equal(text, expected, size);
    free(text);
    assert_int_equal(sim_visit_write_csv(scratch_path(*state, "missing"), visits, 3, &fault),
                     -ENOENT);
    assert_non_null(strstr(fault.text, "missing/visits.csv: "));
}

#define IN_SCRATCH(test) cmocka_unit_test_setup_teardown(test, scratch_setup, scratch_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        IN_SCRATCH(the_slot_is_pointed_and_cleared),
        IN_SCRATCH(a_relative_corpus_is_made_absolute),
        IN_SCRATCH(a_killed_run_does_not_stand_in_the_way),
        IN_SCRATCH(a_file_that_is_no_link_is_left_alone),
        IN_SCRATCH(a_slot_that_cannot_be_made_is_named),
        cmocka_unit_test(one_admittance_of_each_person_will_do),
        cmocka_unit_test(somebody_refused_at_every_visit_is_not_good),
        cmocka_unit_test(a_door_that_did_not_unlock_admits_nobody),
        cmocka_unit_test(a_stranger_let_in_is_not_good),
        cmocka_unit_test(somebody_taken_for_another_is_not_good),
        cmocka_unit_test(a_door_that_opens_for_nobody_is_not_good),
        IN_SCRATCH(visits_are_written_as_csv),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
