/* The web server over TLS: pages, answers that come later, its begin and its end. */
#include <errno.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/enroll/web/rigs/web_rig.h"
#include "tests/support/scratch.h"

static struct web_rig rig;
static struct web_exchange *deferred;

static void now(void *context, struct web_exchange *exchange)
{
    (void)context;
    web_exchange_done(exchange);
}

static void later(void *context, struct web_exchange *exchange)
{
    (void)context;
    deferred = exchange;
}

static const struct web_route routes[] = {
    {"GET", "/now", WEB_ROLE_NONE, now},
    {"GET", "/later", WEB_ROLE_NONE, later},
    {NULL, NULL, WEB_ROLE_NONE, NULL},
};

static int setup(void **state)
{
    assert_int_equal(scratch_setup(state), 0);
    web_rig_start(&rig, *state, routes, &rig);
    deferred = NULL;
    return 0;
}

static int teardown(void **state)
{
    web_rig_stop(&rig);
    return scratch_teardown(state);
}

static void pages_have_types_and_etags(void **state)
{
    static const struct {
        const char *path, *type, *content;
    } pages[] = {
        {"/", "text/html; charset=utf-8", "<!doctype html><title>door</title>"},
        {"/index.html", "text/html; charset=utf-8", "<!doctype html><title>door</title>"},
        {"/app.webmanifest", "application/manifest+json", "{}"},
        {"/js/door.js?version=2", "text/javascript; charset=utf-8", "export const one = 1;"},
        {"/js/deep/far.js", "text/javascript; charset=utf-8", "export const two = 2;"},
        {"/js/a%20b.js", "text/javascript; charset=utf-8", "export const blank = 1;"},
    };
    struct https client;
    struct https_answer answer;
    char condition[128];
    (void)state;

    web_rig_connect(&rig, &client);
    for (size_t i = 0; i < sizeof pages / sizeof *pages; i++) {
        https_ask(&client, "GET", pages[i].path, "", NULL, &answer);
        assert_int_equal(answer.status, 200);
        assert_string_equal(https_header(&answer, "Content-Type"), pages[i].type);
        assert_string_equal(https_header(&answer, "Cache-Control"), "no-cache");
        assert_string_equal(answer.body, pages[i].content);
        web_rig_check_headers(&answer);
        (void)snprintf(condition, sizeof condition, "If-None-Match: \"other\", W/%s\r\n",
                       https_header(&answer, "ETag"));
        https_answer_free(&answer);
        https_ask(&client, "GET", pages[i].path, condition, NULL, &answer);
        assert_int_equal(answer.status, 304);
        assert_non_null(https_header(&answer, "ETag"));
        web_rig_check_headers(&answer);
        https_answer_free(&answer);
    }
    https_ask(&client, "GET", "/", "If-None-Match: \"0123\"\r\n", NULL, &answer);
    assert_int_equal(answer.status, 200);
    https_answer_free(&answer);
    https_close(&client);
}

static void nothing_else_of_the_folder_is_served(void **state)
{
    static const char *const paths[] = {"/secret.key",
                                        "/.hidden.js",
                                        "/js/deep",
                                        "/js",
                                        "/js/",
                                        "/../key.pem",
                                        "/js/../../key.pem",
                                        "/%2e%2e/key.pem",
                                        "/js%2fdoor.js%00",
                                        "/index.html%",
                                        "/%ff",
                                        "/api/v2/echo"};
    struct https client;
    (void)state;

    web_rig_connect(&rig, &client);
    for (size_t i = 0; i < sizeof paths / sizeof *paths; i++) {
        web_rig_expect(&client, "GET", paths[i], "", NULL, 404, "no-such-path");
    }
    web_rig_expect(&client, "POST", "/", WEB_RIG_ORIGIN WEB_RIG_JSON, "{}", 405, "no-such-method");
    https_close(&client);
}

static void head_has_the_headers_of_get(void **state)
{
    struct https client;
    struct https_answer answer;
    (void)state;

    web_rig_connect(&rig, &client);
    https_send(&client, "HEAD /js/door.js HTTP/1.1\r\nHost: door.test\r\n\r\n");
    https_read_head(&client, &answer);
    assert_int_equal(answer.status, 200);
    assert_string_equal(https_header(&answer, "Content-Length"), "21");
    web_rig_expect(&client, "GET", "/api/v1/now", "", NULL, 204, NULL);
    https_close(&client);
}

static void wait_for_deferred(struct https *client)
{
    for (int i = 0; !deferred; i++) {
        assert_true(i < 1000);
        https_pump(rig.event, client->fd);
    }
}

static void an_answer_may_come_later(void **state)
{
    struct https slow, quick;
    struct https_answer answer;
    (void)state;

    web_rig_connect(&rig, &slow);
    web_rig_connect(&rig, &quick);
    https_send(&slow, "GET /api/v1/later HTTP/1.1\r\nHost: door.test\r\n\r\n");
    wait_for_deferred(&slow);
    web_rig_expect(&quick, "GET", "/api/v1/now", "", NULL, 204, NULL);
    web_exchange_json(deferred, 202, json_pack("{s:b}", "late", 1));
    https_read(&slow, &answer);
    assert_int_equal(answer.status, 202);
    assert_string_equal(answer.body, "{\"late\":true}");
    https_answer_free(&answer);
    web_rig_expect(&slow, "GET", "/api/v1/now", "", NULL, 204, NULL);
    https_close(&slow);
    https_close(&quick);
}

static void an_answer_may_come_after_the_client_has_gone(void **state)
{
    struct https client;
    (void)state;

    web_rig_connect(&rig, &client);
    https_send(&client, "GET /api/v1/later HTTP/1.1\r\nHost: door.test\r\n\r\n");
    wait_for_deferred(&client);
    https_close(&client);
    for (int i = 0; i < 5; i++) {
        https_pump(rig.event, -1);
    }
    web_exchange_problem(deferred, 503, "no-daemon", "nobody reads this");
    web_rig_connect(&rig, &client);
    web_rig_expect(&client, "GET", "/api/v1/now", "", NULL, 204, NULL);
    https_close(&client);
}

static void the_server_ends_before_an_answer(void **state)
{
    struct https client;
    (void)state;

    web_rig_connect(&rig, &client);
    https_send(&client, "GET /api/v1/later HTTP/1.1\r\nHost: door.test\r\n\r\n");
    wait_for_deferred(&client);
    web_server_free(rig.server);
    rig.server = NULL;
    web_exchange_done(deferred);
    https_close(&client);
}

static void old_protocols_are_refused(void **state)
{
    static const char *const refused[] = {"NORMAL:-VERS-ALL:+VERS-TLS1.1",
                                          "NORMAL:-VERS-ALL:+VERS-TLS1.2:-KX-ALL:+RSA",
                                          "NORMAL:-VERS-ALL:+VERS-TLS1.2:-CIPHER-ALL:+AES-128-CBC"};
    struct https client;
    (void)state;

    for (size_t i = 0; i < sizeof refused / sizeof *refused; i++) {
        assert_true(https_open(&client, rig.event, rig.port, refused[i], false) < 0);
        https_close(&client);
    }
    assert_int_equal(
        https_open(&client, rig.event, rig.port, "NORMAL:-VERS-ALL:+VERS-TLS1.2", false), 0);
    https_close(&client);
}

static void a_server_that_cannot_start_says_why(void **state)
{
    struct iso_fault fault = {.text = ""};
    struct web_server *server = NULL;
    struct web_certificate broken = {.key = "no key", .chain = "no certificate"};
    int port;
    struct web_server_setup wrong = {.event = rig.event,
                                     .certificate = &rig.certificate,
                                     .pages = scratch_path(*state, "pages/js"),
                                     .sessions = &rig.sessions,
                                     .routes = routes};

    wrong.listen_fd = web_rig_listen(&port);
    assert_int_equal(web_server_new(&wrong, &server, &fault), -ENOENT);
    assert_non_null(strstr(fault.text, "index.html"));
    wrong.pages = scratch_path(*state, "no-folder");
    wrong.listen_fd = web_rig_listen(&port);
    assert_int_equal(web_server_new(&wrong, &server, &fault), -ENOENT);
    scratch_mkdir(scratch_path(*state, "pages/js/deep/deeper"));
    wrong.pages = scratch_path(*state, "pages");
    wrong.listen_fd = web_rig_listen(&port);
    assert_int_equal(web_server_new(&wrong, &server, &fault), -EINVAL);
    assert_non_null(strstr(fault.text, "pages/js/deep/deeper"));
    assert_int_equal(rmdir(scratch_path(*state, "pages/js/deep/deeper")), 0);
    wrong.certificate = &broken;
    wrong.listen_fd = web_rig_listen(&port);
    assert_int_equal(web_server_new(&wrong, &server, &fault), -EIO);
    assert_null(server);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, setup, teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(pages_have_types_and_etags),
        TEST(nothing_else_of_the_folder_is_served),
        TEST(head_has_the_headers_of_get),
        TEST(an_answer_may_come_later),
        TEST(an_answer_may_come_after_the_client_has_gone),
        TEST(the_server_ends_before_an_answer),
        TEST(old_protocols_are_refused),
        TEST(a_server_that_cannot_start_says_why),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
