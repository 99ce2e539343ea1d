/* The link over TLS: it trusts the authority of its hub alone, and shows its certificate. */
#include <errno.h>
#include <netinet/in.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "tests/firmware/fleet/link/link_rig.h"
#include "tests/firmware/rigs/cmocka_headers.h"
#include "tests/support/programs/private_bus.h"
#include "tests/support/scratch.h"

/* The broker takes the certificate, and a snapshot comes over HTTPS. The reply lies in a file. */
static void everything_works_over_tls(void **state)
{
    struct link_rig *rig = *state;
    struct hub_zone *zone = fake_hub_zone(&rig->hub, 20);

    link_rig_start(rig);
    link_rig_until_level(rig);
    assert_int_equal(rig->daemon.snapshot_people, 20);
    fake_hub_change(&rig->hub, zone);
    fake_hub_publish(&rig->hub, zone, 21);
    link_rig_until_level(rig);
    assert_int_equal(rig->daemon.applied, 1);
    mosquitto_rig_kill(&rig->broker);
    link_rig_until(rig, !rig->hub.is_connected);
    fake_hub_change(&rig->hub, zone);
    mosquitto_rig_revive(&rig->broker);
    link_rig_until(rig, rig->hub.subscriptions == 1);
    link_rig_until_level(rig);
    assert_int_equal(rig->daemon.applied, 2);
}

/* A refused connection fails at once, and not after the time in which a broker must answer. */
static void a_broker_that_is_down_is_tried_again_soon(void **state)
{
    struct link_rig *rig = *state;

    mosquitto_rig_kill(&rig->broker);
    (void)fake_hub_zone(&rig->hub, 0);
    link_rig_start(rig);
    link_rig_run(rig, 2000);
    assert_non_null(strstr(rig->notes, "Connection refused"));
    mosquitto_rig_revive(&rig->broker);
    const int64_t since_ms = link_rig_now_ms();
    link_rig_until(rig, link_rig_report(rig).connections == 1);
    assert_true(link_rig_now_ms() - since_ms < 8000);
    link_rig_until_level(rig);
}

enum { TLS_HANDSHAKE = 22 /* RFC 8446, section 5.1: the type of its records */ };

static int listen_with(const int fd, int most)
{
    assert_int_equal(listen(fd, most), 0);
    return fd;
}

/* A socket of a program that accepts no connection. `most` of them wait; the kernel lets those
 * that come then try again, after about a second. */
static int busy_listener(int most, struct sockaddr_in *out)
{
    const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    socklen_t size = sizeof *out;
    *out = (struct sockaddr_in){.sin_family = AF_INET, .sin_addr = {htonl(INADDR_LOOPBACK)}};

    assert_true(fd >= 0);
    assert_int_equal(bind(fd, (const struct sockaddr *)out, sizeof *out), 0);
    assert_int_equal(getsockname(fd, (struct sockaddr *)out, &size), 0);
    return listen_with(fd, most);
}

/* While a broker is busy with other doors, TCP and then TLS take long. The link begins TLS as soon
 * as TCP is there, as in every network outside of one machine, and sleeps until it goes on; a loop
 * that a writable socket wakes makes many thousand rounds here. */
static void the_link_sleeps_while_the_broker_is_busy(void **state)
{
    struct link_rig *rig = *state;
    struct sockaddr_in address;
    uint64_t before, after;
    uint8_t byte = 0;
    const int listener = busy_listener(0, &address);
    const int first = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);

    assert_int_equal(connect(first, (const struct sockaddr *)&address, sizeof address), 0);
    rig->broker.port = ntohs(address.sin_port);
    link_rig_start(rig);
    link_rig_run(rig, 300); /* TCP does not connect */
    (void)listen_with(listener, 16);
    link_rig_run(rig, 1500); /* TCP has connected, and TLS waits */
    (void)close(accept(listener, NULL, NULL));
    const int second = accept(listener, NULL, NULL);
    assert_int_equal(recv(second, &byte, 1, MSG_DONTWAIT), 1);
    assert_int_equal(byte, TLS_HANDSHAKE);
    assert_int_equal(sd_event_get_iteration(rig->event, &before), 0);
    link_rig_run(rig, 1000);
    assert_int_equal(sd_event_get_iteration(rig->event, &after), 0);
    assert_in_range(after - before, 0, 400);
    assert_int_equal(link_rig_report(rig).phase, LINK_OFFLINE);
    (void)close(second);
    (void)close(first);
    (void)close(listener);
}

/* Writes a client and an authority of a stranger. */
static void write_stranger(struct link_rig *rig)
{
    struct authority stranger;
    char key[4096], certificate[4096];

    authority_make(&stranger);
    authority_client(&stranger, "door", key, certificate);
    scratch_write_text(scratch_path(rig->broker.directory, "stranger-ca.pem"), stranger.pem);
    scratch_write_text(scratch_path(rig->broker.directory, "stranger.pem"), certificate);
    scratch_write_text(scratch_path(rig->broker.directory, "stranger-key.pem"), key);
    authority_free(&stranger);
}

static void a_broker_of_another_authority_is_not_trusted(void **state)
{
    struct link_rig *rig = *state;

    (void)fake_hub_zone(&rig->hub, 0);
    write_stranger(rig);
    link_rig_start_with(rig, "stranger-ca.pem", "door.pem", "door-key.pem");
    link_rig_run(rig, 1500);
    assert_int_equal(link_rig_report(rig).phase, LINK_OFFLINE);
    assert_int_equal(link_rig_report(rig).connections, 0);
    assert_true(rig->notes[0]);
}

static void a_certificate_of_another_authority_is_refused(void **state)
{
    struct link_rig *rig = *state;

    (void)fake_hub_zone(&rig->hub, 0);
    write_stranger(rig);
    link_rig_start_with(rig, "ca.pem", "stranger.pem", "stranger-key.pem");
    link_rig_run(rig, 1500);
    assert_int_equal(link_rig_report(rig).connections, 0);
}

static void a_missing_certificate_is_said(void **state)
{
    struct link_rig *rig = *state;

    (void)fake_hub_zone(&rig->hub, 0);
    link_rig_start_with(rig, "ca.pem", "nothing.pem", "nothing-key.pem");
    link_rig_run(rig, 500);
    assert_int_equal(link_rig_report(rig).phase, LINK_OFFLINE);
    assert_true(rig->notes[0]);
}

/* ---- HTTPS alone ---- */

struct post {
    int error, status;
    uint64_t size;
    bool is_done;
};

static void on_reply(void *context, const struct link_http_reply *reply)
{
    struct post *post = context;

    *post = (struct post){
        .error = reply->error, .status = reply->status, .size = reply->size, .is_done = true};
    if (reply->fd >= 0) {
        (void)close(reply->fd);
    }
}

static void answer_kilobyte(void *context, const char *path, const void *body, size_t size,
                            struct fetch_answer *out)
{
    (void)context;
    (void)path;
    (void)body;
    (void)size;
    *out = (struct fetch_answer){.status = 200, .bytes = calloc(1, 1000), .size = 1000};
}

static struct post post(struct link_rig *rig, const char *ca, uint64_t most_bytes, uint32_t time_s)
{
    struct post result = {.is_done = false};
    struct link_http_request *request = NULL;
    struct iso_fault fault = {.text = ""};
    const struct link_http_setup setup = {.url = rig->hub.server.url,
                                          .ca_file = scratch_path(rig->broker.directory, ca),
                                          .type = "text/plain",
                                          .body = "x",
                                          .size = 1,
                                          .most_bytes = most_bytes,
                                          .time_s = time_s};

    assert_int_equal(link_http_post(rig->http, &setup, on_reply, &result, &request, &fault), 0);
    link_rig_until(rig, result.is_done);
    return result;
}

static void https_trusts_one_authority(void **state)
{
    struct link_rig *rig = *state;

    write_stranger(rig);
    rig->hub.server.answer = answer_kilobyte;
    struct post result = post(rig, "ca.pem", 4096, 10);
    assert_int_equal(result.error, 0);
    assert_int_equal(result.status, 200);
    assert_int_equal(result.size, 1000);
    const unsigned before = rig->hub.server.requests;
    result = post(rig, "stranger-ca.pem", 4096, 10);
    assert_int_equal(result.error, -EKEYREJECTED);
    assert_int_equal(rig->hub.server.requests, before);
}

static void replies_are_bounded(void **state)
{
    struct link_rig *rig = *state;

    rig->hub.server.answer = answer_kilobyte;
    assert_int_equal(post(rig, "ca.pem", 1000, 10).error, 0);
    assert_int_equal(post(rig, "ca.pem", 999, 10).error, -EFBIG);
    rig->hub.server.holds = true;
    assert_int_equal(post(rig, "ca.pem", 1000, 1).error, -ETIMEDOUT);
}

#define RIG_TEST(name) \
    cmocka_unit_test_setup_teardown(name, link_rig_setup_secure, link_rig_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        RIG_TEST(everything_works_over_tls),
        RIG_TEST(a_broker_that_is_down_is_tried_again_soon),
        RIG_TEST(the_link_sleeps_while_the_broker_is_busy),
        RIG_TEST(a_broker_of_another_authority_is_not_trusted),
        RIG_TEST(a_certificate_of_another_authority_is_refused),
        RIG_TEST(a_missing_certificate_is_said),
        RIG_TEST(https_trusts_one_authority),
        RIG_TEST(replies_are_bounded),
    };

    return mosquitto_rig_is_there() ? cmocka_run_group_tests(tests, NULL, NULL) : TEST_SKIPPED;
}
