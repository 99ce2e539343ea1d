/* The events of a door go through the running hub to a receiver, also when the leader dies. */
#include <arpa/inet.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "enroll/hub/outlet/hub_outlet.h"
#include "tests/enroll/hub/rigs/served_door.h"

enum { WAIT_MS = 20000, MESSAGE_SIZE = 2048 };

/* A collector of syslog over UDP. */
static int open_collector(uint16_t *port)
{
    struct sockaddr_in name = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    socklen_t size = sizeof name;
    const int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    assert_true(fd >= 0);
    assert_int_equal(bind(fd, (struct sockaddr *)&name, sizeof name), 0);
    assert_int_equal(getsockname(fd, (struct sockaddr *)&name, &size), 0);
    *port = ntohs(name.sin_port);
    return fd;
}

static void add_outlet(uint16_t port)
{
    struct iso_fault fault = {.text = ""};
    char address[64], secret[HUB_OUTLET_SECRET_SIZE];
    const struct hub_outlet_options options = {
        .name = "siem", .address = address, .kind = HUB_OUTLET_SYSLOG};
    (void)snprintf(address, sizeof address, "udp://127.0.0.1:%u", port);
    served_ok(hub_outlet_add(&rig.store, &options, secret, &fault), &fault);
}

static void send_event(uint64_t number)
{
    char line[160], out[ISO_FLEET_TOPIC_SIZE];
    struct iso_fleet_events events = {
        .door = door.membership.door, .first = number, .last = number};
    struct iso_fleet_bytes bytes = {.size = 0};
    const int length = snprintf(line, sizeof line,
                                "{\"sequence\":%llu,\"time\":\"2026-11-21T08:30:15.250Z\","
                                "\"event\":\"visit\"}\n",
                                (unsigned long long)number);
    assert_int_equal(iso_fleet_make_events(&events, line, (size_t)length,
                                           door.membership.hub_receives, &door.signs, &bytes),
                     0);
    broker_client_publish(&door.client, iso_fleet_topic_out(&door.membership.door, out),
                          bytes.bytes, bytes.size, false);
    iso_fleet_bytes_free(&bytes);
}

/* Waits for the event with this number; one before it may come once more. */
static void expect_event(int fd, uint64_t number)
{
    char message[MESSAGE_SIZE];
    unsigned long long got = 0;
    while (got < number) {
        struct pollfd poll_fd = {.fd = fd, .events = POLLIN};
        assert_int_equal(poll(&poll_fd, 1, WAIT_MS), 1);
        const ssize_t n = recv(fd, message, sizeof message - 1, 0);
        assert_true(n > 0);
        message[n] = '\0';
        const char *at = strstr(message, "number=\"");
        assert_non_null(at);
        assert_int_equal(sscanf(at, "number=\"%llu\"", &got), 1);
        assert_true(got <= number);
    }
}

static void events_reach_the_receiver_over_the_death_of_the_leader(void **state)
{
    struct iso_fleet_lease lease;
    uint16_t port = 0;
    const int fd = open_collector(&port);
    (void)state;

    served_door_begin();
    hub_rig_serve(&rig, 1);
    served_door_connect(&lease);
    add_outlet(port);
    const int leader = hub_rig_leader(&rig);
    const double begun = served_now_s();
    send_event(1);
    expect_event(fd, 1);
    send_event(2);
    expect_event(fd, 2);
    print_message("the first event came after %.2f s\n", served_now_s() - begun);
    const double killed = served_now_s();
    hub_rig_kill(&rig, leader);
    send_event(3);
    expect_event(fd, 3);
    print_message("the event after the death of the leader came after %.2f s\n",
                  served_now_s() - killed);
    (void)close(fd);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        SERVED_TEST(events_reach_the_receiver_over_the_death_of_the_leader),
    };
    return cmocka_run_group_tests(tests, NULL, hub_rig_end);
}
