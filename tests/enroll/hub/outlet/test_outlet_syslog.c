/* Outlets of syslog, with sockets and a TLS server of the test in place of a collector. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <arpa/inet.h>
#include <errno.h>
#include <gnutls/gnutls.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "tests/enroll/hub/outlet/outlet_rig.h"
#include "tests/enroll/hub/outlet/receiver.h"

enum { WAIT_MS = 15000, MESSAGE_SIZE = 2048 };

static const char log_file[] = "/tmp/isotherm-test-syslog.log";
static const char local_path[] = "/tmp/isotherm-test-syslog.socket";

static void add(struct store_rig *rig, const char *address, const char *ca)
{
    struct iso_fault fault = {.text = ""};
    char out[HUB_OUTLET_SECRET_SIZE];
    const struct hub_outlet_options options = {.name = "siem",
                                               .address = address,
                                               .kind = HUB_OUTLET_SYSLOG,
                                               .ca = ca,
                                               .from_beginning = true};
    store_rig_fine(hub_outlet_add(&rig->store, &options, out, &fault), &fault);
    assert_string_equal(out, "");
}

/* A socket of 127.0.0.1; its port. */
static int open_socket(int type, uint16_t *port)
{
    struct sockaddr_in name = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    socklen_t size = sizeof name;
    const int fd = socket(AF_INET, type | SOCK_CLOEXEC, 0);
    assert_true(fd >= 0);
    assert_int_equal(bind(fd, (struct sockaddr *)&name, sizeof name), 0);
    assert_int_equal(getsockname(fd, (struct sockaddr *)&name, &size), 0);
    *port = ntohs(name.sin_port);
    if (type == SOCK_STREAM) {
        assert_int_equal(listen(fd, 4), 0);
    }
    return fd;
}

static void wait_readable(int fd)
{
    struct pollfd poll_fd = {.fd = fd, .events = POLLIN};
    assert_int_equal(poll(&poll_fd, 1, WAIT_MS), 1);
}

static int accept_one(int listening)
{
    const struct timeval timeout = {.tv_sec = WAIT_MS / 1000};
    wait_readable(listening);
    const int fd = accept4(listening, NULL, NULL, SOCK_CLOEXEC);
    assert_true(fd >= 0);
    assert_int_equal(setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &timeout, sizeof timeout), 0);
    return fd;
}

/* ---- a stream of counted messages ---- */

struct stream {
    int fd;
    gnutls_session_t tls; /* NULL: none */
};

static void read_exactly(const struct stream *stream, char *out, size_t size)
{
    for (size_t done = 0; done < size;) {
        const ssize_t n = stream->tls ? gnutls_record_recv(stream->tls, out + done, size - done)
                                      : recv(stream->fd, out + done, size - done, 0);
        assert_true(n > 0);
        done += (size_t)n;
    }
}

static void read_frame(const struct stream *stream, char out[MESSAGE_SIZE])
{
    char digits[8] = "";
    size_t n = 0;
    do {
        assert_true(n + 1 < sizeof digits);
        read_exactly(stream, digits + n, 1);
    } while (digits[n++] != ' ');
    const size_t size = strtoul(digits, NULL, 10);
    assert_in_range(size, 1, MESSAGE_SIZE - 1);
    read_exactly(stream, out, size);
    out[size] = '\0';
}

/* The number in the structured data of a message in the form of RFC 5424. */
static uint64_t number_of(const char *message)
{
    const char *at = strstr(message, "number=\"");
    assert_ptr_equal(strstr(message, "<8"), message);
    assert_non_null(strstr(message, ">1 2026-11-21T08:30:15.250Z Gate isotherm - visit "
                                    "[isotherm@32473 door=\""));
    assert_non_null(at);
    return strtoull(at + strlen("number=\""), NULL, 10);
}

static void expect(const struct stream *stream, uint64_t from, uint64_t to)
{
    char message[MESSAGE_SIZE];
    for (uint64_t i = from; i <= to; i++) {
        read_frame(stream, message);
        assert_int_equal(number_of(message), i);
    }
}

static void tcp_messages_are_counted_and_sent_again_after_a_break(void **state)
{
    struct store_rig *rig = *state;
    uint16_t port;
    char address[64];
    const struct iso_fleet_id door = outlet_rig_door(rig, "Gate");
    const int listening = open_socket(SOCK_STREAM, &port);
    (void)snprintf(address, sizeof address, "tcp://127.0.0.1:%u", port);
    outlet_rig_events(rig, &door, 1, 250, "visit");
    add(rig, address, NULL);
    const pid_t pid = outlet_rig_run(rig, log_file);
    struct stream stream = {.fd = accept_one(listening)};
    expect(&stream, 1, 250);
    outlet_rig_wait_idle(rig, "siem", 10);
    /* The same connection serves the next batch. */
    outlet_rig_events(rig, &door, 251, 260, "visit");
    expect(&stream, 251, 260);
    outlet_rig_wait_idle(rig, "siem", 10);
    /* A connection that the receiver closes is noticed before anything is sent into it. */
    (void)close(stream.fd);
    outlet_rig_events(rig, &door, 261, 270, "visit");
    stream.fd = accept_one(listening);
    expect(&stream, 261, 270);
    outlet_rig_wait_idle(rig, "siem", 10);
    outlet_rig_end(pid);
    (void)close(stream.fd);
    (void)close(listening);
    assert_int_equal(outlet_rig_outlet(rig, "siem").delivered, 270);
}

/* The receiver's window closes in the middle of a batch, and the receiver dies. */
static void what_a_receiver_has_not_acknowledged_is_sent_again(void **state)
{
    struct store_rig *rig = *state;
    const int small = 4096;
    uint16_t port;
    char address[64];
    const struct iso_fleet_id door = outlet_rig_door(rig, "Gate");
    const int listening = open_socket(SOCK_STREAM, &port);
    assert_int_equal(setsockopt(listening, SOL_SOCKET, SO_RCVBUF, &small, sizeof small), 0);
    (void)snprintf(address, sizeof address, "tcp://127.0.0.1:%u", port);
    outlet_rig_events(rig, &door, 1, 200, "visit");
    add(rig, address, NULL);
    const pid_t pid = outlet_rig_run(rig, log_file);
    struct stream stream = {.fd = accept_one(listening)};
    expect(&stream, 1, 3);
    (void)poll(NULL, 0, 1000);
    assert_int_equal(outlet_rig_outlet(rig, "siem").delivered, 0);
    (void)close(stream.fd);
    stream.fd = accept_one(listening);
    expect(&stream, 1, 200);
    outlet_rig_wait_idle(rig, "siem", 10);
    outlet_rig_end(pid);
    (void)close(stream.fd);
    (void)close(listening);
    assert_int_equal(outlet_rig_outlet(rig, "siem").delivered, 200);
}

/* ---- TLS ---- */

static struct receiver_pair pair, other;
static gnutls_certificate_credentials_t credentials;

static void make_credentials(void)
{
    const gnutls_datum_t key = {.data = (unsigned char *)pair.key,
                                .size = (unsigned)strlen(pair.key)};
    const gnutls_datum_t certificate = {.data = (unsigned char *)pair.certificate,
                                        .size = (unsigned)strlen(pair.certificate)};
    assert_int_equal(gnutls_certificate_allocate_credentials(&credentials), 0);
    assert_true(gnutls_certificate_set_x509_key_mem(credentials, &certificate, &key,
                                                    GNUTLS_X509_FMT_PEM) >= 0);
}

/* The server's side of a handshake; false: it fails. */
static bool shake_hands(struct stream *stream)
{
    int error;
    assert_int_equal(gnutls_init(&stream->tls, GNUTLS_SERVER), 0);
    assert_int_equal(gnutls_set_default_priority(stream->tls), 0);
    assert_int_equal(gnutls_credentials_set(stream->tls, GNUTLS_CRD_CERTIFICATE, credentials), 0);
    gnutls_transport_set_int(stream->tls, stream->fd);
    do {
        error = gnutls_handshake(stream->tls);
    } while (error < 0 && !gnutls_error_is_fatal(error));
    return error == 0;
}

static void end_tls(struct stream *stream)
{
    gnutls_deinit(stream->tls);
    (void)close(stream->fd);
}

static void tls_messages_arrive(void **state)
{
    struct store_rig *rig = *state;
    uint16_t port;
    char address[64];
    const struct iso_fleet_id door = outlet_rig_door(rig, "Gate");
    const int listening = open_socket(SOCK_STREAM, &port);
    receiver_pair_make(&pair);
    make_credentials();
    (void)snprintf(address, sizeof address, "tls://localhost:%u", port);
    outlet_rig_events(rig, &door, 1, 20, "visit");
    add(rig, address, pair.certificate);
    const pid_t pid = outlet_rig_run(rig, log_file);
    struct stream stream = {.fd = accept_one(listening)};
    assert_true(shake_hands(&stream));
    expect(&stream, 1, 20);
    outlet_rig_wait_idle(rig, "siem", 10);
    outlet_rig_events(rig, &door, 21, 25, "visit");
    expect(&stream, 21, 25);
    outlet_rig_wait_idle(rig, "siem", 10);
    outlet_rig_end(pid);
    end_tls(&stream);
    (void)close(listening);
    gnutls_certificate_free_credentials(credentials);
}

static void a_tls_receiver_with_another_certificate_gets_nothing(void **state)
{
    struct store_rig *rig = *state;
    uint16_t port;
    char address[64], byte;
    const struct iso_fleet_id door = outlet_rig_door(rig, "Gate");
    const int listening = open_socket(SOCK_STREAM, &port);
    receiver_pair_make(&pair);
    receiver_pair_make(&other);
    make_credentials();
    (void)snprintf(address, sizeof address, "tls://localhost:%u", port);
    outlet_rig_events(rig, &door, 1, 20, "visit");
    add(rig, address, other.certificate);
    const pid_t pid = outlet_rig_run(rig, log_file);
    struct stream stream = {.fd = accept_one(listening)};
    /* In TLS 1.3 the server may finish before the client says no. */
    if (shake_hands(&stream)) {
        assert_true(gnutls_record_recv(stream.tls, &byte, 1) <= 0);
    }
    end_tls(&stream);
    (void)poll(NULL, 0, 500);
    outlet_rig_end(pid);
    (void)close(listening);
    gnutls_certificate_free_credentials(credentials);
    const struct hub_outlet outlet = outlet_rig_outlet(rig, "siem");
    assert_int_equal(outlet.delivered, 0);
    assert_true(outlet.failures > 0);
    assert_non_null(strstr(outlet.trouble, "certificate"));
}

/* ---- datagrams ---- */

static void udp_messages_are_one_datagram_each(void **state)
{
    struct store_rig *rig = *state;
    uint16_t port;
    char address[64], message[MESSAGE_SIZE];
    const struct iso_fleet_id door = outlet_rig_door(rig, "Gate");
    const int fd = open_socket(SOCK_DGRAM, &port);
    (void)snprintf(address, sizeof address, "udp://127.0.0.1:%u", port);
    outlet_rig_events(rig, &door, 1, 5, "visit");
    add(rig, address, NULL);
    const pid_t pid = outlet_rig_run(rig, log_file);
    for (uint64_t i = 1; i <= 5; i++) {
        wait_readable(fd);
        const ssize_t n = recv(fd, message, sizeof message - 1, 0);
        assert_true(n > 0);
        message[n] = '\0';
        assert_int_equal(number_of(message), i);
    }
    outlet_rig_wait_idle(rig, "siem", 10);
    outlet_rig_end(pid);
    (void)close(fd);
}

static int open_local(void)
{
    struct sockaddr_un name = {.sun_family = AF_UNIX};
    const int fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    (void)snprintf(name.sun_path, sizeof name.sun_path, "%s", local_path);
    assert_int_equal(bind(fd, (struct sockaddr *)&name, sizeof name), 0);
    return fd;
}

static void the_local_socket_may_come_later(void **state)
{
    struct store_rig *rig = *state;
    char address[64], message[MESSAGE_SIZE];
    const struct iso_fleet_id door = outlet_rig_door(rig, "Gate");
    (void)unlink(local_path);
    (void)snprintf(address, sizeof address, "local:%s", local_path);
    outlet_rig_events(rig, &door, 1, 2, "attack");
    add(rig, address, NULL);
    const pid_t pid = outlet_rig_run(rig, log_file);
    while (outlet_rig_outlet(rig, "siem").failures == 0) {
        (void)poll(NULL, 0, 10);
    }
    const int fd = open_local();
    for (int i = 1; i <= 2; i++) {
        char number[16];
        wait_readable(fd);
        const ssize_t n = recv(fd, message, sizeof message - 1, 0);
        assert_true(n > 0);
        message[n] = '\0';
        (void)snprintf(number, sizeof number, "number=\"%d\"", i);
        assert_ptr_equal(strstr(message, "<84>Nov 21 "), message);
        assert_non_null(strstr(message, " isotherm-hub: [isotherm@32473 door="));
        assert_non_null(strstr(message, number));
    }
    outlet_rig_wait_idle(rig, "siem", 10);
    outlet_rig_end(pid);
    (void)close(fd);
    (void)unlink(local_path);
    (void)unlink(log_file);
}

int main(int argc, char **argv)
{
    outlet_rig_main(argc, argv);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(tcp_messages_are_counted_and_sent_again_after_a_break,
                                        store_rig_setup, store_rig_teardown),
        cmocka_unit_test_setup_teardown(what_a_receiver_has_not_acknowledged_is_sent_again,
                                        store_rig_setup, store_rig_teardown),
        cmocka_unit_test_setup_teardown(tls_messages_arrive, store_rig_setup, store_rig_teardown),
        cmocka_unit_test_setup_teardown(a_tls_receiver_with_another_certificate_gets_nothing,
                                        store_rig_setup, store_rig_teardown),
        cmocka_unit_test_setup_teardown(udp_messages_are_one_datagram_each, store_rig_setup,
                                        store_rig_teardown),
        cmocka_unit_test_setup_teardown(the_local_socket_may_come_later, store_rig_setup,
                                        store_rig_teardown),
    };
    return cmocka_run_group_tests(tests, store_rig_start, store_rig_stop);
}
