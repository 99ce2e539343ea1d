/* The web server: plain routes, which take bytes of any type and may answer with many. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/enroll/web/rigs/web_rig.h"
#include "tests/support/scratch.h"

enum { MUCH = 1 << 20, CUT_AT = 100000, LARGE = 100000 };

static struct web_rig rig;
static int asked, ended;
static bool is_cut;

static void echo(void *context, struct web_exchange *exchange)
{
    size_t size;
    const char *bytes = web_exchange_bytes(exchange, &size);
    char *text = malloc(size + 1);

    (void)context;
    asked++;
    memcpy(text, bytes ? bytes : "", size);
    web_exchange_text(exchange, 200, text, size);
}

static char byte_at(uint64_t at)
{
    return (char)('a' + at % 23);
}

static ssize_t read_much(void *context, uint64_t at, void *out, size_t most)
{
    const size_t n = most < 1000 ? most : 1000; /* less than is wanted */

    assert_ptr_equal(context, &rig);
    if (is_cut && at >= CUT_AT) {
        return -EIO;
    }
    for (size_t i = 0; i < n; i++) {
        ((char *)out)[i] = byte_at(at + i);
    }
    return (ssize_t)(at + n <= MUCH ? n : MUCH - at);
}

static void end(void *context)
{
    assert_ptr_equal(context, &rig);
    ended++;
}

static void much(void *context, struct web_exchange *exchange)
{
    const struct web_source source = {MUCH, read_much, end, &rig};

    (void)context;
    web_exchange_source(exchange, "application/octet-stream", &source);
}

/* Answers what it was asked: the method, the rest of the path, a parameter, a header, and how long
 * the body is. */
static void below(void *context, struct web_exchange *exchange)
{
    const char *a = web_exchange_query(exchange, "a");
    const char *known = web_exchange_request_header(exchange, "If-Match");
    char *text = NULL;
    size_t size;

    (void)context;
    (void)web_exchange_bytes(exchange, &size);
    assert_true(asprintf(&text, "%s %s %s %s %zu", web_exchange_method(exchange),
                         web_exchange_part(exchange), a ? a : "-", known ? known : "-", size) > 0);
    web_exchange_typed(exchange, 418, "text/tea", text, strlen(text));
}

static const struct web_route routes[] = {{NULL, NULL, WEB_ROLE_NONE, NULL}};
static const struct web_plain_route plain[] = {
    {.path = "/fleet/v1/echo", .type = "application/octet-stream", .handle = echo},
    {.path = "/fleet/v1/much", .type = "application/octet-stream", .handle = much},
    {.path = "/below/", .handle = below, .methods = "GET, PATCH", .body_most = LARGE},
    {.path = NULL},
};

static int setup(void **state)
{
    assert_int_equal(scratch_setup(state), 0);
    web_rig_plain = plain;
    asked = ended = 0;
    is_cut = false;
    web_rig_start(&rig, *state, routes, NULL);
    return 0;
}

static int teardown(void **state)
{
    web_rig_stop(&rig);
    return scratch_teardown(state);
}

#define BYTES "Content-Type: application/octet-stream\r\n"

static void bytes_arrive_as_they_are(void **state)
{
    struct https client;
    struct https_answer answer;
    (void)state;

    web_rig_connect(&rig, &client);
    https_ask(&client, "POST", "/fleet/v1/echo", BYTES, "{no JSON \xff\x01", &answer);
    assert_int_equal(answer.status, 200);
    assert_string_equal(answer.body, "{no JSON \xff\x01");
    web_rig_check_headers(&answer);
    https_answer_free(&answer);
    https_ask(&client, "POST", "/fleet/v1/echo", BYTES, "", &answer);
    assert_int_equal(answer.status, 200);
    assert_int_equal(answer.size, 0);
    https_answer_free(&answer);
    assert_int_equal(asked, 2);
    https_close(&client);
}

static void other_requests_are_refused(void **state)
{
    struct https client;
    (void)state;

    web_rig_connect(&rig, &client);
    web_rig_expect(&client, "GET", "/fleet/v1/echo", "", NULL, 405, "no-such-method");
    web_rig_expect(&client, "POST", "/fleet/v1/echo", WEB_RIG_JSON, "{}", 415, "other-type");
    web_rig_expect(&client, "POST", "/fleet/v1/echo", "", "x", 415, "other-type");
    web_rig_expect(&client, "POST", "/fleet/v1/echo", "Content-Type: application/octet-streams\r\n",
                   "x", 415, "other-type");
    web_rig_expect(&client, "POST", "/fleet/v1/other", BYTES, "x", 404, "no-such-path");
    web_rig_expect(&client, "POST", "/fleet/v1/echo/", BYTES, "x", 404, "no-such-path");
    char *large = malloc(WEB_BODY_MOST_BYTES + 2);
    memset(large, 'x', WEB_BODY_MOST_BYTES + 1);
    large[WEB_BODY_MOST_BYTES + 1] = '\0';
    web_rig_expect(&client, "POST", "/fleet/v1/echo", BYTES, large, 413, "too-large");
    free(large);
    assert_int_equal(asked, 0);
    https_close(&client);
}

static void paths_below_a_route_are_its_own(void **state)
{
    struct https client;
    struct https_answer answer;
    char *large = malloc(LARGE + 2);
    (void)state;

    web_rig_connect(&rig, &client);
    https_ask(&client, "GET", "/below/a%20b/c?a=1%3D2", "If-Match: 7\r\n", NULL, &answer);
    assert_int_equal(answer.status, 418);
    assert_string_equal(answer.body, "GET a b/c 1=2 7 0");
    assert_string_equal(https_header(&answer, "Content-Type"), "text/tea");
    web_rig_check_headers(&answer);
    https_answer_free(&answer);
    memset(large, 'x', LARGE + 1);
    large[LARGE] = '\0';
    https_ask(&client, "PATCH", "/below/x", "", large, &answer);
    assert_string_equal(answer.body, "PATCH x - - 100000");
    https_answer_free(&answer);
    large[LARGE] = 'x';
    large[LARGE + 1] = '\0';
    web_rig_expect(&client, "PATCH", "/below/x", "", large, 413, "too-large");
    https_close(&client);
    web_rig_connect(&rig, &client);
    web_rig_expect(&client, "POST", "/below/x", "", "x", 405, "no-such-method");
    web_rig_expect(&client, "PAT", "/below/x", "", "x", 405, "no-such-method");
    web_rig_expect(&client, "GET", "/below/%zz", "", NULL, 404, "no-such-path");
    web_rig_expect(&client, "GET", "/below/x?a=1&a=2", "", NULL, 400, "invalid-parameter");
    web_rig_expect(&client, "GET", "/below/", "", NULL, 404, "no-such-path");
    https_close(&client);
    free(large);
}

static void a_long_answer_arrives_whole(void **state)
{
    struct https client;
    struct https_answer answer;
    (void)state;

    web_rig_connect(&rig, &client);
    https_ask(&client, "POST", "/fleet/v1/much", BYTES, "x", &answer);
    assert_int_equal(answer.status, 200);
    assert_int_equal(answer.size, MUCH);
    assert_string_equal(https_header(&answer, "Content-Type"), "application/octet-stream");
    for (size_t i = 0; i < MUCH; i++) {
        if (answer.body[i] != byte_at(i)) {
            fail_msg("byte %zu differs", i);
        }
    }
    https_answer_free(&answer);
    https_close(&client);
    for (int i = 0; i < 100 && ended == 0; i++) {
        https_pump(rig.event, -1);
    }
    assert_int_equal(ended, 1);
}

static void an_answer_that_cannot_go_on_is_cut_off(void **state)
{
    struct https client;
    struct https_answer answer;
    (void)state;

    is_cut = true;
    web_rig_connect(&rig, &client);
    https_send(&client,
               "POST /fleet/v1/much HTTP/1.1\r\nHost: door.test\r\nContent-Length: 1\r\n" BYTES
               "\r\nx");
    https_read_head(&client, &answer);
    assert_int_equal(answer.status, 200);
    assert_string_equal(https_header(&answer, "Content-Length"), "1048576");
    https_answer_free(&answer);
    for (int i = 0; i < 500 && !client.ended; i++) {
        https_pump(rig.event, client.fd);
        https_receive(&client);
    }
    assert_true(client.ended);
    assert_true(client.n < MUCH);
    assert_int_equal(ended, 1);
    https_close(&client);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(bytes_arrive_as_they_are, setup, teardown),
        cmocka_unit_test_setup_teardown(other_requests_are_refused, setup, teardown),
        cmocka_unit_test_setup_teardown(paths_below_a_route_are_its_own, setup, teardown),
        cmocka_unit_test_setup_teardown(a_long_answer_arrives_whole, setup, teardown),
        cmocka_unit_test_setup_teardown(an_answer_that_cannot_go_on_is_cut_off, setup, teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
