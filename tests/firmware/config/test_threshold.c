/* The score that an appliance requires depends on the number of people with whom it compares a
 * face. */
#include <stdio.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/firmware/rigs/rig.h"

static int many_people_setup(void **state)
{
    rig_capacity = 30;
    const int error = rig_setup(state);
    rig_capacity = 0;
    return error;
}

/* At `strict`, a score of 4 is enough for a door of one person, and for a verification. A search
 * among twenty people needs 4.3. */
static void more_people_need_a_higher_score(void **state)
{
    struct rig *rig = *state;
    rig->config.decision.threshold = 0;
    rig->config.decision.level = ISO_LEVEL_STRICT;
    rig_enrol(rig, "anna", 50);
    rig_start(rig);
    rig_show(rig, 56, 2); /* 10 - 6 */
    rig_run(rig, 100);
    assert_non_null(strstr(rig_news(rig), "visit allow anna match 2"));
    assert_non_null(strstr(rig_record(rig, "visit"), "\"threshold\":4,"));
    rig_run(rig, 20000);
    for (int i = 1; i < 20; i++) {
        char name[16];
        (void)snprintf(name, sizeof name, "p%02d", i);
        rig_enrol(rig, name, 100 + 50 * i);
    }
    (void)rig_news(rig);
    rig_show(rig, 56, 6);
    rig_run(rig, 300);
    assert_non_null(strstr(rig_news(rig), "visit deny unknown 6"));
    assert_non_null(strstr(rig_record(rig, "visit"), "\"threshold\":4.30"));
    rig_run(rig, 20000);
    (void)rig_news(rig);
    rig_show(rig, 55, 2); /* 10 - 5 */
    rig_run(rig, 100);
    assert_non_null(strstr(rig_news(rig), "visit allow anna match 2"));
    assert_int_equal(iso_appliance_claim(rig->appliance), 0);
    assert_int_equal(iso_appliance_verify(rig->appliance, "anna", NULL), 0);
    (void)rig_news(rig);
    rig_show(rig, 56, 2);
    rig_run(rig, 100);
    assert_string_equal(rig_news(rig), "verify match anna done");
    assert_int_equal(iso_appliance_identify(rig->appliance, NULL), 0);
    rig_show(rig, 56, 6);
    rig_run(rig, 300);
    assert_string_equal(rig_news(rig), "identify no-match done");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(more_people_need_a_higher_score, many_people_setup,
                                        rig_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
