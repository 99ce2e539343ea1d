/* `isotherm update`: the program itself against a stand-in for RAUC on a private bus, and what it
 * shows of an image. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <jansson.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/cli/image/os_release.h"
#include "enroll/cli/image/update_text.h"
#include "tests/enroll/rigs/fake_rauc.h"
#include "tests/support/programs/private_bus.h"
#include "tests/support/programs/run.h"
#include "tests/support/scratch.h"

static const char isotherm[] = ISOTHERM_BINARY_DIR "/enroll/isotherm";
static const struct fake_rauc_script sound;
static struct private_bus bus;

/* What the program said, and what RAUC was asked. */
struct answer {
    struct run run; /* to be freed with run_free() */
    const char *asked;
};

/* Runs `isotherm --bus ADDRESS update [WORD] [OPTION]`. Without a script there is no RAUC. */
static struct answer update(const struct fake_rauc_script *script, const char *word,
                            const char *option)
{
    const char *argv[] = {isotherm, "--bus", bus.address, "update", NULL, NULL, NULL};
    struct answer answer = {.asked = ""};
    struct fake_rauc rauc;
    size_t argc = 4;

    argv[argc] = word;
    argc += word != NULL;
    argv[argc] = option;
    if (script) {
        fake_rauc_start(&rauc, bus.address, script);
    }
    run_start(&answer.run, argv);
    run_finish(&answer.run);
    if (script) {
        answer.asked = fake_rauc_stop(&rauc);
    }
    return answer;
}

static const char *bundle_in(const char *scratch)
{
    const char *path = scratch_path(scratch, "next.raucb");

    scratch_write_text(path, "the stand-in does not read it");
    return path;
}

/* The program refuses with this exit code and exactly this line. */
static void expect_refusal(struct answer *answer, int exit, const char *line)
{
    char expected[512];

    const int length = snprintf(expected, sizeof expected, "isotherm: %s\n", line);
    assert_in_range(length, 1, sizeof expected - 1);
    run_expect(&answer->run, exit);
    assert_string_equal(answer->run.err, expected);
    assert_string_equal(answer->run.out, "");
    run_free(&answer->run);
}

/* A line about the file in *state. */
static const char *about(const char *path, const char *what)
{
    static char line[512];

    (void)snprintf(line, sizeof line, "%s: %s", path, what);
    return line;
}

static void an_update_is_installed(void **state)
{
    const char *path = bundle_in(*state);
    char asked[512];
    struct answer answer = update(&sound, path, NULL);

    run_expect(&answer.run, 0);
    assert_string_equal(answer.run.out, "The update is installed in slot b: version 2.0.0. It "
                                        "starts at the next restart: systemctl reboot\n");
    (void)snprintf(asked, sizeof asked, "Info %s;InstallBundle %s;", path, path);
    assert_string_equal(answer.asked, asked);
    run_free(&answer.run);

    answer = update(&sound, path, "--json");
    json_t *document = json_loads(answer.run.out, 0, NULL);
    assert_true(json_is_true(json_object_get(document, "installed")));
    assert_string_equal(json_string_value(json_object_get(document, "slot")), "b");
    assert_string_equal(json_string_value(json_object_get(document, "version")), "2.0.0");
    json_decref(document);
    run_free(&answer.run);
}

static void refused_bundles_are_named_with_the_reason(void **state)
{
    const char *path = bundle_in(*state);
    const struct fake_rauc_script foreign = {.foreign_key = true},
                                  other = {.board = "isotherm-rock-5b-arm64"},
                                  older = {.error = "Pre-install handler error: Child process "
                                                    "exited with code 3"},
                                  ignored = {.error = "Pre-install handler error: Child process "
                                                      "exited with code 4"},
                                  trial = {.error = "Pre-install handler error: Child process "
                                                    "exited with code 5"},
                                  damaged = {.error = "Installation error: Failed updating slot "
                                                      "root.1: Input/output error\nmore"},
                                  silent = {.error = ""};
    struct answer answer = update(&foreign, path, NULL);

    assert_null(strstr(answer.asked, "InstallBundle"));
    expect_refusal(&answer, 1,
                   about(path, "no update that is signed with a key of this appliance (journalctl "
                               "--unit=rauc)"));
    answer = update(&other, path, NULL);
    assert_null(strstr(answer.asked, "InstallBundle"));
    expect_refusal(&answer, 1,
                   about(path, "it is for the board isotherm-rock-5b-arm64, and this is "
                               "isotherm-test-amd64"));
    answer = update(&older, path, NULL);
    expect_refusal(&answer, 1, about(path, "it is not newer than the running version"));
    answer = update(&ignored, path, NULL);
    expect_refusal(&answer, 1, about(path, "it is for another board"));
    answer = update(&trial, path, NULL);
    expect_refusal(&answer, 1,
                   about(path, "the running version is not yet found to be good: try again in some "
                               "minutes"));
    answer = update(&damaged, path, NULL);
    expect_refusal(&answer, 4,
                   about(path, "not installed: Installation error: Failed updating slot root.1: "
                               "Input/output error"));
    answer = update(&silent, path, NULL);
    expect_refusal(&answer, 4,
                   about(path, "not installed: RAUC gives no reason (journalctl --unit=rauc)"));
}

/* A bus that answers for RAUC says nothing about the bundle. */
static void a_rauc_that_does_not_answer_is_no_foreign_key(void **state)
{
    const struct fake_rauc_script mute = {.mute = true};
    struct answer answer = update(&mute, bundle_in(*state), NULL);

    assert_null(strstr(answer.asked, "InstallBundle"));
    expect_refusal(&answer, 5, "RAUC does not answer");
}

/* RAUC answers as to a foreign key, because another way has begun an update meanwhile. */
static void a_rauc_that_was_overtaken_is_busy(void **state)
{
    const struct fake_rauc_script overtaken = {.overtaken = true};
    struct answer answer = update(&overtaken, bundle_in(*state), NULL);

    assert_non_null(strstr(answer.asked, "Info"));
    assert_null(strstr(answer.asked, "InstallBundle"));
    expect_refusal(&answer, 4,
                   "another update is being installed; isotherm update shows how far it is");
}

static void a_refusal_as_json(void **state)
{
    const struct fake_rauc_script older = {
        .error = "Pre-install handler error: Child process exited with code 3"};
    struct answer answer = update(&older, bundle_in(*state), "--json");
    json_t *document = json_loads(answer.run.out, 0, NULL);
    json_t *error = json_object_get(document, "error");

    run_expect(&answer.run, 1);
    assert_string_equal(json_string_value(json_object_get(error, "code")), "not-newer");
    json_decref(document);
    run_free(&answer.run);
}

static void files_that_are_none_are_not_given_to_rauc(void **state)
{
    const char *missing = scratch_path(*state, "missing");
    struct answer answer = update(&sound, missing, NULL);

    assert_string_equal(answer.asked, "");
    expect_refusal(&answer, 3, about(missing, "No such file or directory"));
    answer = update(&sound, *state, NULL);
    assert_string_equal(answer.asked, "");
    expect_refusal(&answer, 4, about(*state, "not a regular file"));
    answer = update(&sound, missing, "--status");
    expect_refusal(&answer, 2, "give FILE or --status, not both");
}

static void a_machine_without_rauc_is_no_image(void **state)
{
    struct answer answer = update(NULL, bundle_in(*state), NULL);

    expect_refusal(&answer, 3,
                   "there is no RAUC on this bus: only an image of the appliance is updated like "
                   "this, other machines by their packages");
    answer = update(NULL, NULL, NULL);
    run_expect(&answer.run, 3);
    run_free(&answer.run);
}

static void a_rauc_that_is_busy_or_ends_is_reported(void **state)
{
    const char *path = bundle_in(*state);
    const struct fake_rauc_script busy = {.busy = true}, dies = {.end = FAKE_RAUC_DIES};
    struct answer answer = update(&busy, path, NULL);

    assert_string_equal(answer.asked, "");
    expect_refusal(&answer, 4,
                   "another update is being installed; isotherm update shows how far it is");
    answer = update(&dies, path, NULL);
    run_expect(&answer.run, 4);
    assert_non_null(strstr(answer.run.err, "isotherm: RAUC has ended in the middle of the update "
                                           "(journalctl --unit=rauc): "));
    run_free(&answer.run);
    answer = update(&busy, "--status", NULL);
    run_expect(&answer.run, 0);
    assert_non_null(strstr(answer.run.out, "\nRAUC        installing, 40 %\n"));
    run_free(&answer.run);
}

/* RAUC goes on when the person presses Ctrl-C. The progress, which appears after two seconds, shows
 * that the installation has begun. */
static void an_interrupt_leaves_rauc_alone(void **state)
{
    const struct fake_rauc_script goes_on = {.end = FAKE_RAUC_GOES_ON};
    const char *argv[] = {isotherm, "--bus", bus.address, "update", bundle_in(*state), NULL};
    struct fake_rauc rauc;
    struct run run;

    fake_rauc_start(&rauc, bus.address, &goes_on);
    run_start(&run, argv);
    run_until(&run, "installing the update: 40 of 100");
    kill(run.pid, SIGINT);
    run_finish(&run);
    assert_non_null(strstr(fake_rauc_stop(&rauc), "InstallBundle"));
    run_expect(&run, 130);
    assert_non_null(strstr(run.err, "isotherm: RAUC goes on with the update; isotherm update shows "
                                    "how far it is\n"));
    run_free(&run);
}

/* The policy of the bus refuses this client. */
static void a_user_without_the_right_is_told_so(void **state)
{
    const char *path = scratch_path(*state, "policy.conf");

    scratch_write_text(path, "<busconfig><policy context=\"mandatory\">"
                             "<deny send_destination=\"de.pengutronix.rauc\"/></policy>"
                             "</busconfig>");
    private_bus_kill(&bus);
    private_bus_include(&bus, path);
    assert_true(private_bus_revive(&bus));
    struct answer answer = update(&sound, NULL, NULL);
    assert_string_equal(answer.asked, "");
    expect_refusal(&answer, 1,
                   "not permitted: only root and members of the group isotherm may update the "
                   "appliance");
}

/* ---- what is shown ---- */

static char *text_of(const struct cli_update_view *view)
{
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);

    assert_non_null(out);
    cli_update_print(view, out);
    assert_int_equal(fclose(out), 0);
    return text;
}

static void version_and_slots_are_shown(void **state)
{
    const char *path = scratch_path(*state, "os-release");
    const struct cli_installer_state idle = {.operation = "idle"};
    struct cli_update_view view = {
        .state = &idle,
        .slots = {.n = 2,
                  .slots = {{.name = "a", .version = "1.0.0", .good = true},
                            {.name = "b", .running = true, .good = true, .next = true}}}};

    scratch_write_text(path, "PRETTY_NAME=\"Debian GNU/Linux 12 (bookworm)\"\nVERSION_ID='12'\n"
                             "\nIMAGE_ID=isotherm-pc-usb\nIMAGE_VERSION=\"2.0.0\"");
    cli_os_release_read(path, &view.running);
    assert_string_equal(view.running.name, "Debian GNU/Linux 12 (bookworm)");
    char *text = text_of(&view);
    assert_string_equal(text, "version     2.0.0 (isotherm-pc-usb)\n"
                              "slot        b, good, in use, starts next\n"
                              "other slot  a, version 1.0.0, good\n");
    free(text);

    json_t *document = cli_update_json(&view);
    const json_t *slots = json_object_get(document, "slots");
    assert_int_equal(json_array_size(slots), 2);
    const json_t *running = json_array_get(slots, 1);
    assert_string_equal(json_string_value(json_object_get(running, "version")), "2.0.0");
    assert_true(json_is_true(json_object_get(running, "running")));
    assert_true(json_is_false(json_object_get(json_array_get(slots, 0), "next")));
    assert_null(json_object_get(document, "proven")); /* it was not asked */
    json_decref(document);
}

/* RAUC calls the slot good in each case. */
static void a_version_on_trial_is_shown(void **state)
{
    const struct cli_installer_state idle = {.operation = "idle"};
    const char *const words[] = {"yes", "no", "", "maybe"};
    (void)state;
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        const struct cli_update_view view = {
            .running = {.image = "isotherm-pc-usb", .version = "2.0.0"},
            .state = &idle,
            .slots = {.n = 1, .slots = {{.name = "b", .running = true, .good = true}}},
            .trial = words[i]};
        char *text = text_of(&view);
        json_t *document = cli_update_json(&view);
        const json_t *proven = json_object_get(document, "proven");
        assert_string_equal(text, i == 0 ? "version     2.0.0 (isotherm-pc-usb), on trial\n"
                                           "slot        b, good, in use\n"
                                         : "version     2.0.0 (isotherm-pc-usb)\n"
                                           "slot        b, good, in use\n");
        assert_int_equal(json_typeof(proven), i == 0 ? JSON_FALSE : i == 1 ? JSON_TRUE : JSON_NULL);
        free(text);
        json_decref(document);
    }
}

/* The program itself, on a machine where nobody has said it. */
static void a_program_that_does_not_know_says_null(void **state)
{
    struct answer answer = update(&sound, "--status", "--json");
    json_t *document = json_loads(answer.run.out, 0, NULL);
    (void)state;
    assert_true(json_is_null(json_object_get(document, "proven")));
    json_decref(document);
    run_free(&answer.run);
}

static void the_slots_of_rauc_are_shown(void **state)
{
    const struct fake_rauc_script flashed = {.spare_is_bad = true};
    struct answer answer = update(&flashed, "--status", NULL);

    (void)state;
    run_expect(&answer.run, 0);
    assert_non_null(strstr(answer.run.out, "\nslot        a, good, in use, starts next\n"
                                           "other slot  b, version not known, bad\n"));
    run_free(&answer.run);
}

int main(void)
{
#define IN_SCRATCH(test) cmocka_unit_test_setup_teardown(test, scratch_setup, scratch_teardown)
    const struct CMUnitTest tests[] = {
        IN_SCRATCH(an_update_is_installed),
        IN_SCRATCH(refused_bundles_are_named_with_the_reason),
        IN_SCRATCH(a_rauc_that_does_not_answer_is_no_foreign_key),
        IN_SCRATCH(a_rauc_that_was_overtaken_is_busy),
        IN_SCRATCH(a_refusal_as_json),
        IN_SCRATCH(files_that_are_none_are_not_given_to_rauc),
        IN_SCRATCH(a_machine_without_rauc_is_no_image),
        IN_SCRATCH(a_rauc_that_is_busy_or_ends_is_reported),
        IN_SCRATCH(an_interrupt_leaves_rauc_alone),
        IN_SCRATCH(version_and_slots_are_shown),
        cmocka_unit_test(a_version_on_trial_is_shown),
        cmocka_unit_test(a_program_that_does_not_know_says_null),
        cmocka_unit_test(the_slots_of_rauc_are_shown),
        IN_SCRATCH(a_user_without_the_right_is_told_so), /* the last one: it changes the bus */
    };

    if (!private_bus_start(&bus)) {
        return TEST_SKIPPED;
    }
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    private_bus_stop(&bus);
    return failed;
}
