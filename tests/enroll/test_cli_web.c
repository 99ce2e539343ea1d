/* `isotherm web`: what it prints of a scripted isotherm-web, and its faults. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <fcntl.h>
#include <jansson.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "enroll/cli/commands/commands.h"
#include "enroll/cli/machine/web_address.h"
#include "tests/support/scratch.h"

static const char print[] = "0A:1B:2C:3D:4E:5F:60:71:82:93:A4:B5:C6:D7:E8:F9:"
                            "01:12:23:34:45:56:67:78:89:9A:AB:BC:CD:DE:EF:F0";

/* A server that answers both questions and notes which ones it was asked. */
static const char server[] = "#!/bin/sh\n"
                             "echo \"$*\" >>\"$0.asked\"\n"
                             "case $1 in\n"
                             "setup-code) echo ABCDE-FGHJK-MNPQR-STVWX ;;\n"
                             "fingerprint) echo 0A:1B:2C:3D:4E:5F:60:71:82:93:A4:B5:C6:D7:E8:F9:"
                             "01:12:23:34:45:56:67:78:89:9A:AB:BC:CD:DE:EF:F0 ;;\n"
                             "*) exit 2 ;;\n"
                             "esac\n";
static const char systemd[] =
    "#!/bin/sh\n"
    "[ \"$*\" = 'show --property Listen --value isotherm-web.socket' ] &&\n"
    "printf '192.0.2.7:443 (Stream)\\n[2001:db8::5]:8444 (Stream)\\n'\n";

static const char *write_program(const char *path, const char *text)
{
    scratch_write_text(path, text);
    assert_int_equal(chmod(path, 0700), 0);
    return path;
}

struct answer {
    enum cli_exit exit;
    struct cli_fault fault;
    char *out; /* to be freed */
};

/* Runs the command with standard output in a file. */
static struct answer run(const char *scratch, const struct cli_web_places *places, const char *word,
                         bool json)
{
    const struct cli_arguments arguments = {.verb = CLI_WEB, .word = word, .json = json};
    const char *path = scratch_path(scratch, "stdout");
    struct answer answer = {.fault = {.text = ""}};
    const int kept = dup(STDOUT_FILENO), file = open(path, O_RDWR | O_CREAT | O_TRUNC, 0600);

    assert_true(kept >= 0 && file >= 0);
    (void)fflush(stdout);
    assert_true(dup2(file, STDOUT_FILENO) >= 0);
    answer.exit = cli_web(places, &arguments, &answer.fault);
    (void)fflush(stdout);
    assert_true(dup2(kept, STDOUT_FILENO) >= 0);
    close(file);
    close(kept);
    answer.out = scratch_read_text(path);
    return answer;
}

static void setup_prints_addresses_fingerprint_and_code(void **state)
{
    const struct cli_web_places places = {
        .program = write_program(scratch_path(*state, "isotherm-web"), server),
        .systemctl = write_program(scratch_path(*state, "systemctl"), systemd)};
    struct answer answer = run(*state, &places, "setup", false);

    assert_int_equal(answer.exit, CLI_EXIT_OK);
    assert_non_null(strstr(answer.out, "\n  https://192.0.2.7:443/\n"
                                       "  https://[2001:db8::5]:8444/\n"));
    assert_non_null(strstr(answer.out, print));
    assert_non_null(strstr(answer.out, "\n  ABCDE-FGHJK-MNPQR-STVWX\n"));
    free(answer.out);

    char *asked = scratch_read_text(scratch_path(*state, "isotherm-web.asked"));
    assert_string_equal(asked, "fingerprint\nsetup-code\n");
    free(asked);
}

static void setup_as_json(void **state)
{
    const struct cli_web_places places = {
        .program = write_program(scratch_path(*state, "isotherm-web"), server),
        .systemctl = write_program(scratch_path(*state, "systemctl"), systemd)};
    struct answer answer = run(*state, &places, "setup", true);
    json_t *document = json_loads(answer.out, 0, NULL);
    const json_t *urls = json_object_get(document, "addresses");

    assert_int_equal(answer.exit, CLI_EXIT_OK);
    assert_string_equal(json_string_value(json_object_get(document, "code")),
                        "ABCDE-FGHJK-MNPQR-STVWX");
    assert_string_equal(json_string_value(json_object_get(document, "fingerprint")), print);
    assert_int_equal(json_array_size(urls), 2);
    assert_string_equal(json_string_value(json_array_get(urls, 0)), "https://192.0.2.7:443/");
    json_decref(document);
    free(answer.out);
}

static void fingerprint_is_one_line(void **state)
{
    char line[sizeof print + 1];
    const struct cli_web_places places = {
        .program = write_program(scratch_path(*state, "isotherm-web"), server), .systemctl = ""};
    struct answer answer = run(*state, &places, "fingerprint", false);

    (void)snprintf(line, sizeof line, "%s\n", print);
    assert_int_equal(answer.exit, CLI_EXIT_OK);
    assert_string_equal(answer.out, line);
    free(answer.out);
    answer = run(*state, &places, "fingerprint", true);
    json_t *document = json_loads(answer.out, 0, NULL);
    assert_string_equal(json_string_value(json_object_get(document, "fingerprint")), print);
    json_decref(document);
    free(answer.out);
}

/* They are no secret, and no server is asked. */
static void addresses_are_lines_for_everybody(void **state)
{
    const struct cli_web_places places = {
        .program = write_program(scratch_path(*state, "isotherm-web"), server),
        .systemctl = write_program(scratch_path(*state, "systemctl"), systemd),
        .root = geteuid() != 0};
    struct answer answer = run(*state, &places, "address", false);

    assert_int_equal(answer.exit, CLI_EXIT_OK);
    assert_string_equal(answer.out, "https://192.0.2.7:443/\nhttps://[2001:db8::5]:8444/\n");
    free(answer.out);
    answer = run(*state, &places, "address", true);
    json_t *document = json_loads(answer.out, 0, NULL);
    const json_t *urls = json_object_get(document, "addresses");
    assert_int_equal(json_array_size(urls), 2);
    assert_string_equal(json_string_value(json_array_get(urls, 1)), "https://[2001:db8::5]:8444/");
    json_decref(document);
    free(answer.out);
    assert_false(scratch_exists(scratch_path(*state, "isotherm-web.asked")));
}

static void expect_fault(struct answer answer, enum cli_exit exit, const char *code,
                         const char *text)
{
    assert_int_equal(answer.exit, exit);
    assert_string_equal(answer.fault.code, code);
    assert_string_equal(answer.fault.text, text);
    assert_string_equal(answer.out, "");
    free(answer.out);
}

static void a_server_that_is_missing_or_fails_is_named(void **state)
{
    char text[300];
    struct cli_web_places places = {.program = scratch_path(*state, "isotherm-web"),
                                    .systemctl = ""};
    (void)snprintf(text, sizeof text,
                   "the web server is not installed: there is no %s (package isotherm-web)",
                   places.program);
    expect_fault(run(*state, &places, "setup", false), CLI_EXIT_NOT_FOUND, "no-program", text);
    (void)write_program(places.program, "#!/bin/sh\n"
                                        "echo 'isotherm-web: it has no certificate yet' >&2\n"
                                        "echo 'and more' >&2\nexit 4\n");
    expect_fault(run(*state, &places, "setup", false), CLI_EXIT_FAULT, "web-fault",
                 "isotherm-web fingerprint: it has no certificate yet");
    (void)write_program(places.program, "#!/bin/sh\nexit 0\n");
    expect_fault(run(*state, &places, "fingerprint", false), CLI_EXIT_FAULT, "web-fault",
                 "isotherm-web fingerprint: it gives no answer");
    expect_fault(run(*state, &places, "password", false), CLI_EXIT_USAGE, "usage",
                 "web takes 'setup', 'address' or 'fingerprint', not 'password'");
}

static void only_root_may_ask(void **state)
{
    const struct cli_web_places places = {
        .program = write_program(scratch_path(*state, "isotherm-web"), server),
        .systemctl = "",
        .root = true};

    if (geteuid() == 0) {
        assert_int_equal(chmod(*state, 0755), 0);
        assert_int_equal(chmod(places.program, 0755), 0);
        scratch_write_text(scratch_path(*state, "stdout"), "");
        assert_int_equal(chmod(scratch_path(*state, "stdout"), 0666), 0);
        assert_int_equal(seteuid(65534), 0);
    }
    const struct answer answer = run(*state, &places, "setup", false);
    if (getuid() == 0) {
        assert_int_equal(seteuid(0), 0);
    }
    expect_fault(answer, CLI_EXIT_NO, "access-denied",
                 "web setup reads the state of the web server: only root may (sudo isotherm web "
                 "setup)");
    assert_false(scratch_exists(scratch_path(*state, "isotherm-web.asked")));
}

static void a_socket_on_every_address_has_those_of_the_machine(void **state)
{
    struct cli_web_addresses addresses = {.n = 0};
    char name[HOST_NAME_MAX + 1] = "", first[2 * HOST_NAME_MAX];
    static const char *const no_addresses[] = {"",
                                               "\n",
                                               "/run/isotherm-web.sock (Stream)",
                                               "8443",
                                               ":8443",
                                               "[::]:",
                                               "[::]:0 (Stream)",
                                               "[::]:65536 (Stream)",
                                               "[::]:84a (Stream)"};

    (void)state;
    (void)gethostname(name, sizeof name - 1);
    for (size_t i = 0; i < sizeof no_addresses / sizeof *no_addresses; i++) {
        cli_web_addresses_add(&addresses, no_addresses[i]);
        assert_int_equal(addresses.n, 0);
    }
    cli_web_addresses_add(&addresses, "[::]:8444 (Stream)\n");
    (void)snprintf(first, sizeof first, "https://%.100s:8444/", name);
    assert_string_equal(addresses.urls[0], first);
    for (size_t i = 1; i < addresses.n; i++) {
        assert_null(strstr(addresses.urls[i], "//127."));
        assert_null(strstr(addresses.urls[i], "//[::1]"));
        assert_null(strstr(addresses.urls[i], "//[fe80"));
    }
    for (int i = 0; i < CLI_WEB_ADDRESSES_MOST + 1; i++) {
        cli_web_addresses_add(&addresses, "192.0.2.1:1 (Stream)");
    }
    assert_int_equal(addresses.n, CLI_WEB_ADDRESSES_MOST);
}

static void without_systemd_the_port_is_that_of_the_unit(void **state)
{
    struct cli_web_addresses addresses;
    size_t size;
    char *unit = scratch_read(ISOTHERM_SOURCE_DIR "/board/generic/isotherm-web.socket", &size);
    char *text = strndup(unit, size), line[40];

    (void)snprintf(line, sizeof line, "\nListenStream=%d\n", CLI_WEB_PORT);
    assert_non_null(strstr(text, line));
    free(text);
    free(unit);
    cli_web_addresses_find(scratch_path(*state, "systemctl"), &addresses);
    assert_true(addresses.n >= 1);
    assert_string_equal(strrchr(addresses.urls[0], ':'), ":8443/");
    (void)write_program(scratch_path(*state, "systemctl"), "#!/bin/sh\nexit 0\n");
    cli_web_addresses_find(scratch_path(*state, "systemctl"), &addresses);
    assert_string_equal(strrchr(addresses.urls[0], ':'), ":8443/");
}

int main(void)
{
#define IN_SCRATCH(test) cmocka_unit_test_setup_teardown(test, scratch_setup, scratch_teardown)
    const struct CMUnitTest tests[] = {
        IN_SCRATCH(setup_prints_addresses_fingerprint_and_code),
        IN_SCRATCH(setup_as_json),
        IN_SCRATCH(fingerprint_is_one_line),
        IN_SCRATCH(addresses_are_lines_for_everybody),
        IN_SCRATCH(a_server_that_is_missing_or_fails_is_named),
        IN_SCRATCH(only_root_may_ask),
        IN_SCRATCH(a_socket_on_every_address_has_those_of_the_machine),
        IN_SCRATCH(without_systemd_the_port_is_that_of_the_unit),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
