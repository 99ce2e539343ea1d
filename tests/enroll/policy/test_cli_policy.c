/* isotherm policy, against a scripted daemon and with the real reader of files. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <string.h>

#include "tests/enroll/rigs/cli.h"
#include "tests/support/scratch.h"

#define DOORS                                                                                      \
    "\"security_levels\":[{\"token\":\"face\",\"priority\":0,\"recognition_groups\":[[\"face\"]]}" \
    "],"                                                                                           \
    "\"authentication_profiles\":[{\"token\":\"face\",\"default_level\":\"face\"}],"               \
    "\"access_points\":[{\"token\":\"front\",\"authentication_profile\":\"face\"}]"
#define OFFICE(hours)                                                  \
    "\"schedules\":[{\"token\":\"office\",\"zone\":\"Europe/Berlin\"," \
    "\"weekly\":{\"monday-friday\":[\"" hours "\"]}}],"
#define STORED "{" OFFICE("08:00-17:00") DOORS "}"

static struct fake_script script_of(const char *policy, uint64_t revision)
{
    struct fake_script script = cli_two_people;

    script.policy = policy;
    script.policy_revision = revision;
    return script;
}

static void expect_text(const struct cli_result *result, const char *text)
{
    if (!strstr(result->out, text)) {
        fail_msg("'%s' is not in:\n%s%s", text, result->out, result->err);
    }
}

/* Runs `isotherm policy import FILE OPTIONS` with a file of these contents. */
static struct cli_result import(const char *scratch, const struct fake_script *script,
                                const char *name, const char *contents, const char *options)
{
    char words[512];
    const char *path = scratch_path(scratch, name);

    scratch_write_text(path, contents);
    (void)snprintf(words, sizeof words, "policy import %s%s", path, options);
    return cli_run(script, words);
}

/* ---- import ---- */

static void it_imports_json(void **state)
{
    struct fake_script script = script_of("", 0);
    script.policy_remark = "access point \"front\" lets nobody in at any time";
    const struct cli_result result = import(
        *state, &script, "p.json",
        "{\"access_points\":[{\"token\":\"front\"}], " OFFICE("08:00-17:00") "\"areas\":[]}", "");
    cli_expect_exit(&result, 0);
    assert_string_equal(result.calls, "GetPolicy;SetPolicy 0 " STORED);
    assert_string_equal(result.out, "schedule \"office\": added\n"
                                    "security level \"face\": added\n"
                                    "authentication profile \"face\": added\n"
                                    "access point \"front\": added\n"
                                    "The policy is stored as revision 1.\n");
    assert_string_equal(result.err,
                        "isotherm: access point \"front\" lets nobody in at any time\n");
}

#ifdef ISOTHERM_HAS_TOML
static void it_imports_toml(void **state)
{
    const struct fake_script script = script_of(STORED, 7);
    const struct cli_result result = import(*state, &script, "p.toml",
                                            "[[access_points]]\n"
                                            "token = \"front\"\n"
                                            "[[schedules]]\n"
                                            "token = \"office\"\n"
                                            "zone = \"Europe/Berlin\"\n"
                                            "[schedules.weekly]\n"
                                            "monday-friday = [\"08:00-18:30\"]\n",
                                            "");
    cli_expect_exit(&result, 0);
    assert_string_equal(result.calls, "GetPolicy;SetPolicy 7 {" OFFICE("08:00-18:30") DOORS "}");
    assert_string_equal(result.out, "schedule \"office\": changed\n"
                                    "The policy is stored as revision 8.\n");
}

#endif

#define CALENDAR                                        \
    "BEGIN:VCALENDAR\r\nVERSION:2.0\r\nPRODID:-//t\r\n" \
    "X-WR-CALNAME:office\r\nBEGIN:VEVENT\r\nUID:1\r\n"  \
    "SUMMARY:Work\r\nDTSTART%s:20260105T093000%s\r\n"   \
    "DTEND%s:20260105T160000%s\r\n"                     \
    "RRULE:FREQ=WEEKLY;BYDAY=MO,TU,WE,TH,FR\r\n"        \
    "END:VEVENT\r\nEND:VCALENDAR\r\n"

static const char *calendar(const char *parameter, const char *end)
{
    static char text[1024];

    (void)snprintf(text, sizeof text, CALENDAR, parameter, end, parameter, end);
    return text;
}

static void a_calendar_is_added(void **state)
{
    const struct fake_script script = script_of(STORED, 7);
    const struct cli_result result = import(*state, &script, "c.ics",
                                            calendar(";TZID=Europe/Berlin", ""), "");
    cli_expect_exit(&result, 0);
    assert_string_equal(result.calls, "GetPolicy;SetPolicy 7 {" OFFICE("09:30-16:00") DOORS "}");
    assert_string_equal(result.out, "schedule \"office\": changed\n"
                                    "The policy is stored as revision 8.\n");
}

static void a_calendar_without_a_zone_needs_one(void **state)
{
    const struct fake_script script = script_of("", 0);
    struct cli_result result = import(*state, &script, "c.ics", calendar("", ""), " --json");
    cli_expect_error(&result, 2, "invalid-policy");
    expect_text(&result, "event \\\"Work\\\": its time has no time zone: name one with --zone");
    result = import(*state, &script, "c.ics", calendar("", ""), " --zone Europe/Berlin");
    cli_expect_exit(&result, 0);
    assert_string_equal(result.calls, "GetPolicy;SetPolicy 0 {\"schedules\":[{\"token\":\"office\","
                                      "\"zone\":\"Europe/Berlin\",\"weekly\":{\"monday-friday\":"
                                      "[\"09:30-16:00\"]}}]}");
}

static void a_dry_run_stores_nothing(void **state)
{
    const struct fake_script script = script_of(STORED, 7);
    struct cli_result result = import(*state, &script, "p.json", "{" DOORS "}", " --dry-run");
    cli_expect_exit(&result, 0);
    assert_string_equal(result.calls, "GetPolicy");
    assert_string_equal(result.out, "schedule \"office\": removed\n"
                                    "Nothing is stored: this was a dry run.\n");
    result = import(*state, &script, "p.json", "{" DOORS "}", " --dry-run --json");
    cli_expect_exit(&result, 0);
    json_t *document = cli_json(&result);
    json_t *expected = json_pack("{s:[{s:s,s:s,s:s}], s:[], s:I, s:b}", "changes", "kind",
                                 "schedule", "token", "office", "change", "removed", "remarks",
                                 "revision", (json_int_t)7, "dry_run", 1);
    assert_true(json_equal(document, expected));
    json_decref(document);
    json_decref(expected);
}

static void the_same_policy_is_not_stored_again(void **state)
{
    const struct fake_script script = script_of(STORED, 7);
    const struct cli_result result = import(*state, &script, "p.json", " " STORED, "");
    cli_expect_exit(&result, 0);
    assert_string_equal(result.calls, "GetPolicy");
    assert_string_equal(result.out, "The policy is the same as before.\n");
}

static void another_change_meanwhile_is_a_conflict(void **state)
{
    struct fake_script script = script_of(STORED, 7);
    script.fail_method = "SetPolicy";
    script.fail_error = "org.isotherm.Error.Conflict";
    const struct cli_result result = import(*state, &script, "p.json", "{}", " --json");
    cli_expect_error(&result, 1, "conflict");
}

static void a_wrong_file_is_refused_with_its_line(void **state)
{
    static const struct {
        const char *name, *contents, *line;
    } cases[] = {
        {"a.json", "{\"areas\":[{\"token\":\"x\",\"colour\":1}]}",
         "isotherm: area \"x\": it has an unknown member \"colour\"\n"},
        {"b.json", "{\"schedules\":[{\"token\":\"s\",\"zone\":\"Europe/Berln\"}]}",
         "isotherm: schedule \"s\": the zone cannot be read: there is no time zone "
         "\"Europe/Berln\"\n"},
        {"c.json", "{", "line 1, column 1: string or '}' expected near end of file\n"},
        {"d.json", "[]", "the document is not an object\n"},
#ifdef ISOTHERM_HAS_TOML
        {"e.toml", "areas = [\n", "line 1, column 11: "},
        {"f.toml", "a = 09:00:00\n", "line 1: a time stands in quotes"},
#endif
        /* libical has messages of its own about this one. */
        {"h.ics", "END:VCALENDAR\r\nEND:X\r\n",
         "h.ics: it is not one iCalendar object (VCALENDAR)\n"},
        {"g.ics", "no calendar", "it is not one iCalendar object (VCALENDAR)\n"},
    };
    const struct fake_script script = script_of("", 0);

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const struct cli_result result = import(*state, &script, cases[i].name, cases[i].contents,
                                                "");
        cli_expect_exit(&result, 2);
        assert_string_equal(result.calls, "GetPolicy");
        if (!strstr(result.err, cases[i].line)) {
            fail_msg("'%s' is not in: %s", cases[i].line, result.err);
        }
    }
}

static void files_that_are_none(void **state)
{
    const struct fake_script script = script_of("", 0);
    const char *folder = *state;
    char words[512];

    (void)snprintf(words, sizeof words, "policy import %s/none.json --json", folder);
    struct cli_result result = cli_run(&script, words);
    cli_expect_error(&result, 3, "no-file");
    result = cli_run(&script, "policy import /dev/zero.json --json");
    cli_expect_error(&result, 3, "no-file");
    result = import(folder, &script, "p.yaml", "{}", " --json");
    cli_expect_error(&result, 2, "usage");
    result = import(folder, &script, "p.json", "{}", " --json --zone UTC");
    cli_expect_error(&result, 2, "usage");
    result = import(folder, &script, "p", "{}", " --json");
    cli_expect_error(&result, 2, "usage");
}

/* ---- show, check, remove ---- */

static void it_shows_a_table(void **state)
{
    const struct fake_script script = script_of(
        "{\"special_day_groups\":[{\"token\":\"free\",\"days\":[\"2026-12-25\"]}],"
        "\"schedules\":[{\"token\":\"office\",\"zone\":\"Europe/Berlin\","
        "\"weekly\":{\"monday-friday\":[\"08:00-12:00\",\"13:00-17:00\"],\"sunday\":[\"10:00-"
        "11:00\"]},\"special_days\":[{\"group\":\"free\",\"hours\":[]}]}],"
        "\"areas\":[{\"token\":\"hall\"}],"
        "\"security_levels\":[{\"token\":\"face\",\"priority\":1,\"recognition_groups\":[[\"face\"]"
        "]},{\"token\":\"strict\",\"priority\":2,\"recognition_groups\":[[\"face\",\"card\","
        "\"pin\"],[\"card\",\"pin\"]]}],"
        "\"authentication_profiles\":[{\"token\":\"doors\",\"default_level\":\"face\",\"policies\":"
        "[{\"schedule\":\"office\",\"inactive\":{\"level\":\"strict\",\"two_people\":true}}]}],"
        "\"access_points\":[{\"token\":\"front\",\"to\":\"hall\",\"authentication_profile\":"
        "\"doors\",\"antipassback\":\"timed\",\"antipassback_s\":60}],"
        "\"access_profiles\":[{\"token\":\"staff\",\"policies\":[{\"access_point\":\"front\","
        "\"schedule\":\"office\"}]}],\"default_profile\":\"staff\"}",
        9);
    const struct cli_result result = cli_run(&script, "policy show");
    (void)state;
    cli_expect_exit(&result, 0);
    assert_string_equal(
        result.out,
        "Access points\n"
        "  front                from anywhere to hall, timed antipassback of 60 s\n"
        "                       face\n"
        "                       not in office: face, card and PIN, or card and PIN, two people\n"
        "Access profiles\n"
        "  staff                the profile of people who name none\n"
        "                       front in office\n"
        "Schedules\n"
        "  office               Europe/Berlin\n"
        "                       Monday to Friday 08:00-12:00, 13:00-17:00\n"
        "                       Sunday 10:00-11:00\n"
        "                       on free: closed\n"
        "Special days\n"
        "  free                 2026-12-25\n"
        "Revision 9\n");
}

static void it_shows_json(void **state)
{
    struct fake_script script = script_of(STORED, 9);
    struct cli_result result = cli_run(&script, "policy show --json");
    (void)state;
    cli_expect_exit(&result, 0);
    json_t *document = cli_json(&result), *policy = json_loads(STORED, 0, NULL);
    assert_true(json_equal(json_object_get(document, "policy"), policy));
    assert_int_equal(json_integer_value(json_object_get(document, "revision")), 9);
    json_decref(document);
    json_decref(policy);
    script = script_of(NULL, 0);
    result = cli_run(&script, "policy show --json");
    document = cli_json(&result);
    assert_true(json_is_null(json_object_get(document, "policy")));
    json_decref(document);
    result = cli_run(&script, "policy show");
    cli_expect_exit(&result, 0);
    assert_string_equal(result.out, "There is no policy: everybody who is enrolled may enter, "
                                    "within the limits of each person.\n");
}

static void it_checks(void **state)
{
    struct fake_script script = script_of(STORED, 9);
    struct cli_result result = cli_run(&script, "policy check");
    (void)state;
    cli_expect_exit(&result, 0);
    assert_string_equal(result.out, "No findings.\n");
    script.finding = "schedule \"office\" is never active";
    result = cli_run(&script, "policy check");
    cli_expect_exit(&result, 1);
    assert_string_equal(result.out, "schedule \"office\" is never active\n");
    result = cli_run(&script, "policy check --json");
    cli_expect_exit(&result, 1);
    json_t *document = cli_json(&result);
    assert_int_equal(json_array_size(json_object_get(document, "findings")), 1);
    json_decref(document);
}

static void it_removes(void **state)
{
    struct fake_script script = script_of(STORED, 9);
    struct cli_result result = cli_run(&script, "policy remove");
    (void)state;
    cli_expect_exit(&result, 0);
    assert_string_equal(result.calls, "GetPolicy;SetPolicy 9 ");
    assert_string_equal(result.out, "The policy is removed: everybody who is enrolled may enter, "
                                    "within the limits of each person.\n");
    script = script_of("", 0);
    result = cli_run(&script, "policy remove --json");
    cli_expect_exit(&result, 0);
    assert_string_equal(result.calls, "GetPolicy");
    json_t *document = cli_json(&result);
    assert_true(json_is_false(json_object_get(document, "removed")));
    json_decref(document);
}

/* ---- the command line ---- */

static void wrong_command_lines(void **state)
{
    static const char *const lines[] = {"policy",
                                        "policy shw",
                                        "policy show x.json",
                                        "policy import",
                                        "policy show --dry-run",
                                        "policy check --person anna",
                                        "policy import x.json --door front",
                                        "policy test",
                                        "policy test --person anna --person ben",
                                        "policy test --person anna --shown iris",
                                        "policy test --person anna --at noon",
                                        "policy test --person anna --zone UTC",
                                        "policy show --card 7"};
    const struct fake_script script = cli_two_people;

    (void)state;
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
        const struct cli_result result = cli_run(&script, lines[i]);
        cli_expect_exit(&result, 2);
        assert_string_equal(result.calls, "");
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(it_imports_json, scratch_setup, scratch_teardown),
#ifdef ISOTHERM_HAS_TOML
        cmocka_unit_test_setup_teardown(it_imports_toml, scratch_setup, scratch_teardown),
#endif
        cmocka_unit_test_setup_teardown(a_calendar_is_added, scratch_setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(a_calendar_without_a_zone_needs_one, scratch_setup,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(a_dry_run_stores_nothing, scratch_setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(the_same_policy_is_not_stored_again, scratch_setup,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(another_change_meanwhile_is_a_conflict, scratch_setup,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(a_wrong_file_is_refused_with_its_line, scratch_setup,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(files_that_are_none, scratch_setup, scratch_teardown),
        cmocka_unit_test(it_shows_a_table),
        cmocka_unit_test(it_shows_json),
        cmocka_unit_test(it_checks),
        cmocka_unit_test(it_removes),
        cmocka_unit_test(wrong_command_lines),
    };

    if (!cli_find_bus()) {
        return 77;
    }
    return cmocka_run_group_tests(tests, NULL, cli_teardown);
}
