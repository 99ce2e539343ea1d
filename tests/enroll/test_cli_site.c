/* isotherm site, against a scripted daemon. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <string.h>

#include "tests/enroll/rigs/cli.h"

static struct fake_script script_of(const char *site, uint32_t people, bool estimated)
{
    struct fake_script script = cli_two_people;
    script.site = site;
    script.site_people = people;
    script.site_estimated = estimated;
    return script;
}

static void expect_text(const struct cli_result *result, const char *text)
{
    if (!strstr(result->out, text)) {
        fail_msg("'%s' is not in:\n%s", text, result->out);
    }
}

static void it_shows_rates_and_look_alikes(void **state)
{
    const struct fake_script script = script_of("adapted", 4, true);
    const struct cli_result result = cli_run(&script, "site");
    (void)state;
    cli_expect_exit(&result, 0);
    expect_text(&result,
                "\n  learned from           4 people, 1 of them with two templates or more\n");
    expect_text(&result, "\n  they have in common    6.31; rendered people have 5.10\n");
    expect_text(&result, "\n  variance within        1.10 times that of rendered people\n");
    expect_text(&result, "\n  balanced     3.0     1.11 % [0.12, 5.34]       not known");
    expect_text(&result,
                "\n  from 90 comparisons of two people and 7 of one person, among 4 people\n");
    expect_text(&result, "\nPeople who look alike\n  2.35  anna and Bo Ek\n");
    expect_text(&result,
                "\n  enrol Bo Ek in poses (isotherm enroll): there is one template only\n");
    expect_text(&result,
                "\n  anna and Bo Ek look alike: set level = strict in isotherm.conf(5), or "
                "give one of them a card\n");
}

/* The bus refuses the lists; the rest is shown. */
static void names_are_for_those_who_may_list(void **state)
{
    struct fake_script script = script_of("adapted", 4, true);
    script.fail_method = "ListLookAlikes";
    script.fail_error = "org.freedesktop.DBus.Error.AccessDenied";
    const struct cli_result result = cli_run(&script, "site show");
    (void)state;
    cli_expect_exit(&result, 0);
    expect_text(&result, "\n  1 pair; their names are for those who may list people\n");
    assert_null(strstr(result.out, "anna"));
    json_t *document = NULL;
    const struct cli_result again = cli_run(&script, "site --json");
    document = cli_json(&again);
    assert_true(json_is_null(json_object_get(document, "look-alike-pairs")));
    assert_int_equal(json_integer_value(json_object_get(document, "look-alikes")), 1);
    json_decref(document);
}

static void without_the_list_of_people_nobody_is_named(void **state)
{
    struct fake_script script = script_of("adapted", 4, false);
    script.fail_method = "ListPeople";
    script.fail_error = "org.freedesktop.DBus.Error.AccessDenied";
    const struct cli_result result = cli_run(&script, "site");
    (void)state;
    cli_expect_exit(&result, 0);
    expect_text(&result, "\n  not known: the people have just changed, or nobody is enrolled\n");
    assert_null(strstr(result.out, "Bo Ek"));
}

static void a_document_has_all_of_it(void **state)
{
    const struct fake_script script = script_of("adapted", 4, true);
    const struct cli_result result = cli_run(&script, "site --json");
    json_t *document = cli_json(&result);
    const json_t *pair = json_array_get(json_object_get(document, "look-alike-pairs"), 0);
    (void)state;
    cli_expect_exit(&result, 0);
    assert_string_equal(json_string_value(json_object_get(document, "site")), "adapted");
    assert_true(json_real_value(json_object_get(document, "balanced-fmr")) > 0.011);
    assert_string_equal(json_string_value(json_object_get(pair, "other")), "Bo Ek");
    assert_int_equal(json_array_size(json_object_get(document, "advice")), 2);
    json_decref(document);
}

static void it_says_what_is_missing(void **state)
{
    const struct fake_script few = script_of("provisional", 2, false),
                             off = script_of(NULL, 0, false);
    (void)state;
    struct cli_result result = cli_run(&few, "site");
    expect_text(&result,
                "\n  enrol more people: the metric has learned from 2 of the 3 that it needs\n");
    result = cli_run(&off, "site");
    expect_text(&result,
                "Metric\n  state                  off\n\nWhat would help\n  let the metric adapt");
    assert_null(strstr(result.out, "Error rates"));
}

static void people_of_another_sensor_are_to_be_enrolled_again(void **state)
{
    struct fake_script script = script_of("adapted", 4, false);
    (void)state;
    struct cli_result result = cli_run(&script, "site");
    assert_null(strstr(result.out, "another model"));
    assert_null(strstr(result.calls, "ListOtherSensor")); /* an older daemon does not have it */
    script.site_other = 1;
    result = cli_run(&script, "site");
    expect_text(&result, "\n  do not teach it        1 person: enrolled before another model of "
                         "camera\n");
    expect_text(&result, "\n  enrol anna again before this camera: another model has made all "
                         "templates\n");
    assert_null(strstr(result.out, "more people again"));
    script.site_other = 12;
    result = cli_run(&script, "site");
    expect_text(&result, "\n  do not teach it        12 people: enrolled before another model of "
                         "camera\n");
    expect_text(&result, "\n  enrol carl 4 again before this camera");
    expect_text(&result, "\n  enrol 7 more people again before this camera");
}

/* The bus refuses the names; the number is shown. */
static void people_of_another_sensor_are_counted_for_all(void **state)
{
    struct fake_script script = script_of("adapted", 4, false);
    (void)state;
    script.site_other = 12;
    script.fail_method = "ListOtherSensor";
    script.fail_error = "org.freedesktop.DBus.Error.AccessDenied";
    const struct cli_result result = cli_run(&script, "site");
    cli_expect_exit(&result, 0);
    expect_text(&result, "\n  enrol 12 people again before this camera");
    assert_null(strstr(result.out, "carl"));
}

static void it_takes_back(void **state)
{
    const struct fake_script some = script_of("adapted", 4, false);
    const struct fake_script one = script_of("adapted", 1, false);
    const struct fake_script none = script_of("provisional", 0, false);
    (void)state;
    struct cli_result result = cli_run(&some, "site reset");
    cli_expect_exit(&result, 0);
    assert_string_equal(result.out, "4 templates no longer teach the metric.\n");
    assert_non_null(strstr(result.calls, "ResetSite"));
    result = cli_run(&one, "site rollback");
    assert_string_equal(result.out, "1 template no longer teaches the metric.\n");
    assert_non_null(strstr(result.calls, "RollBackSite"));
    result = cli_run(&none, "site rollback");
    cli_expect_exit(&result, 0);
    expect_text(&result, "Nothing has changed");
    result = cli_run(&some, "site reset --json");
    json_t *document = cli_json(&result);
    assert_int_equal(json_integer_value(json_object_get(document, "excluded")), 4);
    json_decref(document);
}

static void faults_are_faults(void **state)
{
    struct fake_script script = script_of("adapted", 4, true);
    (void)state;
    script.fail_method = "ListLookAlikes";
    script.fail_error = "org.isotherm.Error.Storage";
    struct cli_result result = cli_run(&script, "site --json");
    cli_expect_error(&result, 4, "storage");
    result = cli_run(&cli_two_people, "site hide --json");
    cli_expect_error(&result, 2, "usage");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_shows_rates_and_look_alikes),
        cmocka_unit_test(names_are_for_those_who_may_list),
        cmocka_unit_test(without_the_list_of_people_nobody_is_named),
        cmocka_unit_test(a_document_has_all_of_it),
        cmocka_unit_test(it_says_what_is_missing),
        cmocka_unit_test(people_of_another_sensor_are_to_be_enrolled_again),
        cmocka_unit_test(people_of_another_sensor_are_counted_for_all),
        cmocka_unit_test(it_takes_back),
        cmocka_unit_test(faults_are_faults),
    };

    if (!cli_find_bus()) {
        return TEST_SKIPPED;
    }
    return cmocka_run_group_tests(tests, NULL, cli_teardown);
}
