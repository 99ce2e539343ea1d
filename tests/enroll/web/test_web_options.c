/* The options of isotherm-web, and the socket on which it listens. */
#include <errno.h>
#include <getopt.h>
#include <netinet/in.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "enroll/web/listener.h"
#include "enroll/web/options.h"
#include "tests/enroll/web/rigs/web_rig.h"

static int read_line(const char *line, struct web_options *out)
{
    static char text[256];
    char *words[16] = {"isotherm-web"}, *rest = text;
    int n = 1;

    (void)snprintf(text, sizeof text, "%s", line);
    for (char *word; (word = strsep(&rest, " "));) {
        if (*word) {
            words[n++] = word;
        }
    }
    optind = 0; /* getopt begins anew */
    return web_options_read(n, words, out);
}

static void each_option_is_read(void **state)
{
    struct web_options options;
    (void)state;

    assert_int_equal(read_line("", &options), 0);
    assert_int_equal(options.command, WEB_COMMAND_SERVE);
    assert_string_equal(options.bus, "system");
    assert_string_equal(options.listen, "127.0.0.1:8443");
    assert_string_equal(options.state, "/var/lib/isotherm-web");
    assert_int_equal(
        read_line("--bus session --listen [::1]:1 --state s --pages p fingerprint", &options), 0);
    assert_int_equal(options.command, WEB_COMMAND_FINGERPRINT);
    assert_string_equal(options.bus, "session");
    assert_string_equal(options.listen, "[::1]:1");
    assert_string_equal(options.state, "s");
    assert_string_equal(options.pages, "p");
    assert_false(options.first_code);
    assert_int_equal(read_line("--first-code --updates u", &options), 0);
    assert_true(options.first_code);
    assert_string_equal(options.updates, "u");
    assert_int_equal(read_line("setup-code", &options), 0);
    assert_int_equal(options.command, WEB_COMMAND_SETUP_CODE);
    assert_int_equal(read_line("--version", &options), 1);
    assert_int_equal(read_line("--help", &options), 1);
}

static void wrong_command_lines_are_refused(void **state)
{
    static const char *const lines[] = {"--bad", "--state", "serve", "fingerprint setup-code"};
    struct web_options options;
    (void)state;

    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
        assert_int_equal(read_line(lines[i], &options), -EINVAL);
    }
}

static void an_address_is_listened_on(void **state)
{
    struct iso_fault fault = {.text = ""};
    struct sockaddr_in address = {.sin_family = AF_UNSPEC};
    socklen_t size = sizeof address;
    char text[32];
    int port, fd, again;
    (void)state;

    /* A port that is free now. */
    assert_int_equal(close(web_rig_listen(&port)), 0);
    (void)snprintf(text, sizeof text, "127.0.0.1:%d", port);
    assert_int_equal(web_listener_open(text, &fd, &fault), 0);
    assert_int_equal(getsockname(fd, (struct sockaddr *)&address, &size), 0);
    assert_int_equal(ntohs(address.sin_port), port);
    assert_int_equal(ntohl(address.sin_addr.s_addr), INADDR_LOOPBACK);
    assert_int_equal(web_listener_open(text, &again, &fault), -EADDRINUSE);
    assert_int_equal(close(fd), 0);
}

static void a_text_that_is_no_address_is_refused(void **state)
{
    static const char *const texts[] = {"",
                                        "8443",
                                        ":8443",
                                        "127.0.0.1",
                                        "127.0.0.1:",
                                        "127.0.0.1:0",
                                        "127.0.0.1:65536",
                                        "127.0.0.1:99999999999999999999999",
                                        "127.0.0.1:+1",
                                        "127.0.0:8443",
                                        "door.example:8443",
                                        "::1:8443",
                                        "[::1:8443",
                                        "[]:8443",
                                        "[127.0.0.1]:8443",
                                        "[0000:0000:0000:0000:0000:0000:0000:0000:0000:0000]:8443"};
    struct iso_fault fault;
    int fd = -1;
    (void)state;

    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        fault.text[0] = '\0';
        if (web_listener_open(texts[i], &fd, &fault) != -EINVAL) {
            fail_msg("'%s' is accepted", texts[i]);
        }
        assert_non_null(strstr(fault.text, texts[i]));
        assert_int_equal(fd, -1);
    }
}

/* The service manager passes descriptors from 3 on, and says so in the environment. */
static void a_socket_of_the_service_manager_is_taken(void **state)
{
    struct iso_fault fault = {.text = ""};
    const int kept = dup(3), listening = web_rig_listen(&(int){0});
    char pid[24];
    int fd = -1;
    (void)state;

    (void)snprintf(pid, sizeof pid, "%d", (int)getpid());
    assert_int_equal(dup2(listening, 3), 3);
    assert_int_equal(setenv("LISTEN_PID", pid, 1), 0);
    assert_int_equal(setenv("LISTEN_FDS", "1", 1), 0);
    assert_int_equal(web_listener_open("127.0.0.1:1", &fd, &fault), 0);
    assert_int_equal(fd, 3);
    /* The environment is used up, so that children do not take the socket, too. */
    assert_null(getenv("LISTEN_FDS"));

    const int other = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    assert_int_equal(dup2(other, 3), 3);
    assert_int_equal(setenv("LISTEN_PID", pid, 1), 0);
    assert_int_equal(setenv("LISTEN_FDS", "1", 1), 0);
    assert_int_equal(web_listener_open("127.0.0.1:1", &fd, &fault), -EINVAL);
    if (kept >= 0) {
        assert_int_equal(dup2(kept, 3), 3);
        (void)close(kept);
    } else {
        (void)close(3);
    }
    (void)close(other);
    if (listening != 3) {
        (void)close(listening);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_option_is_read),
        cmocka_unit_test(wrong_command_lines_are_refused),
        cmocka_unit_test(an_address_is_listened_on),
        cmocka_unit_test(a_text_that_is_no_address_is_refused),
        cmocka_unit_test(a_socket_of_the_service_manager_is_taken),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
