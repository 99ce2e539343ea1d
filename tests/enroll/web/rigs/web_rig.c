#include "tests/enroll/web/rigs/web_rig.h"

#include <jansson.h>
#include <netinet/in.h>
#include <signal.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>

#include "tests/firmware/rigs/cmocka_headers.h"
#include "tests/support/scratch.h"

int64_t (*web_rig_clock)(void);
const struct web_plain_route *web_rig_plain;
const struct web_intake *web_rig_intakes;

int web_rig_listen(int *port)
{
    struct sockaddr_in address = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    socklen_t size = sizeof address;
    const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);

    assert_true(fd >= 0);
    assert_int_equal(bind(fd, (const struct sockaddr *)&address, size), 0);
    assert_int_equal(listen(fd, 64), 0);
    assert_int_equal(getsockname(fd, (struct sockaddr *)&address, &size), 0);
    *port = ntohs(address.sin_port);
    return fd;
}

static void write_pages(const char *folder)
{
    scratch_mkdir(folder);
    scratch_write_text(scratch_path(folder, "index.html"), "<!doctype html><title>door</title>");
    scratch_write_text(scratch_path(folder, "app.webmanifest"), "{}");
    scratch_write_text(scratch_path(folder, "secret.key"), "not for browsers");
    scratch_write_text(scratch_path(folder, ".hidden.js"), "0");
    scratch_mkdir(scratch_path(folder, "js"));
    scratch_write_text(scratch_path(folder, "js/door.js"), "export const one = 1;");
    scratch_write_text(scratch_path(folder, "js/a b.js"), "export const blank = 1;");
    scratch_mkdir(scratch_path(folder, "js/deep"));
    scratch_write_text(scratch_path(folder, "js/deep/far.js"), "export const two = 2;");
}

void web_rig_start(struct web_rig *rig, const char *folder, const struct web_route *routes,
                   void *context)
{
    const char *pages = scratch_path(folder, "pages");
    struct iso_fault fault = {.text = ""};

    assert_true(sodium_init() >= 0);
    (void)signal(SIGPIPE, SIG_IGN);
    *rig = (struct web_rig){0};
    write_pages(pages);
    assert_int_equal(sd_event_new(&rig->event), 0);
    assert_int_equal(web_certificate_open(folder, &rig->certificate, &fault), 0);
    const struct web_server_setup setup = {.event = rig->event,
                                           .listen_fd = web_rig_listen(&rig->port),
                                           .certificate = &rig->certificate,
                                           .pages = pages,
                                           .plain = web_rig_plain,
                                           .intakes = web_rig_intakes,
                                           .sessions = &rig->sessions,
                                           .routes = routes,
                                           .context = context,
                                           .now_ns = web_rig_clock};
    if (web_server_new(&setup, &rig->server, &fault)) {
        fail_msg("%s", fault.text);
    }
}

void web_rig_stop(struct web_rig *rig)
{
    web_server_free(rig->server);
    web_certificate_free(&rig->certificate);
    sd_event_unref(rig->event);
}

const char *web_rig_login(struct web_rig *rig, const char *name, enum web_role role, uint64_t *id)
{
    static char headers[512];
    struct web_account account = {.role = role};
    char token[WEB_SESSION_TOKEN_SIZE];
    struct timespec now;

    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    (void)snprintf(account.name, sizeof account.name, "%s", name);
    const uint64_t session = web_session_begin(
        &rig->sessions, &account, (int64_t)now.tv_sec * 1000000000 + now.tv_nsec, token);
    if (id) {
        *id = session;
    }
    (void)snprintf(headers, sizeof headers,
                   WEB_RIG_ORIGIN WEB_RIG_JSON "Cookie: " WEB_SESSION_COOKIE "=%s\r\n", token);
    return headers;
}

void web_rig_connect(struct web_rig *rig, struct https *client)
{
    assert_int_equal(https_open(client, rig->event, rig->port, "NORMAL", false), 0);
}

void web_rig_expect(struct https *client, const char *method, const char *path, const char *headers,
                    const char *body, int status, const char *code)
{
    struct https_answer answer;

    https_ask(client, method, path, headers, body, &answer);
    if (answer.status != status) {
        fail_msg("%s %s: %d instead of %d: %s", method, path, answer.status, status, answer.body);
    }
    if (code) {
        json_t *problem = json_loads(answer.body, 0, NULL);
        const char *found = json_string_value(json_object_get(problem, "code"));
        assert_string_equal(https_header(&answer, "Content-Type"), "application/problem+json");
        assert_non_null(found);
        assert_string_equal(found, code);
        assert_int_equal(json_integer_value(json_object_get(problem, "status")), status);
        assert_true(json_string_length(json_object_get(problem, "detail")) > 0);
        assert_string_equal(json_string_value(json_object_get(problem, "type")), "about:blank");
        json_decref(problem);
    }
    https_answer_free(&answer);
}

long web_rig_resident_kb(void)
{
    FILE *file = fopen("/proc/self/status", "re");
    char line[256];
    long kb = -1;

    assert_non_null(file);
    while (fgets(line, sizeof line, file)) {
        (void)sscanf(line, "VmRSS: %ld kB", &kb);
    }
    (void)fclose(file);
    return kb;
}

void web_rig_check_headers(const struct https_answer *answer)
{
    static const char *const names[] = {
        "Content-Security-Policy",    "X-Content-Type-Options",       "Referrer-Policy",
        "Cross-Origin-Opener-Policy", "Cross-Origin-Resource-Policy", "Cache-Control",
        "Strict-Transport-Security"};

    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        if (!https_header(answer, names[i])) {
            fail_msg("%s is missing in:\n%s", names[i], answer->head);
        }
    }
    assert_non_null(strstr(https_header(answer, "Content-Security-Policy"), "default-src 'none'"));
    assert_null(strstr(https_header(answer, "Content-Security-Policy"), "unsafe"));
}
