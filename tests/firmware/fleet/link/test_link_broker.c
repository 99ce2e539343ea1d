/* The link and a broker that is killed: it comes back, catches up, and loses no event. */
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/firmware/fleet/link/link_rig.h"
#include "tests/firmware/rigs/cmocka_headers.h"
#include "tests/support/programs/private_bus.h"

static struct hub_zone *begin(struct link_rig *rig)
{
    struct hub_zone *zone = fake_hub_zone(&rig->hub, 0);

    link_rig_start(rig);
    link_rig_until_level(rig);
    link_rig_until(rig, link_rig_report(rig).phase == LINK_ONLINE);
    return zone;
}

static void lose_broker(struct link_rig *rig)
{
    mosquitto_rig_kill(&rig->broker);
    link_rig_until(rig,
                   !rig->hub.is_connected && link_door_report(rig->door).phase == LINK_OFFLINE);
}

static void find_broker(struct link_rig *rig)
{
    mosquitto_rig_revive(&rig->broker);
    link_rig_until(rig, rig->hub.subscriptions == 1);
}

static void after_a_loss_of_the_broker_the_door_catches_up(void **state)
{
    struct link_rig *rig = *state;
    struct hub_zone *zone = begin(rig);

    for (int round = 1; round <= 3; round++) {
        lose_broker(rig);
        for (int i = 0; i < 5; i++) {
            fake_hub_change(&rig->hub, zone);
        }
        find_broker(rig);
        link_rig_until_level(rig);
        assert_int_equal(rig->daemon.applied, 5 * round);
        assert_true(link_rig_report(rig).connections > (uint64_t)round);
    }
}

/* The hub starts the broker later than the door. */
static void a_broker_that_comes_late_is_found(void **state)
{
    struct link_rig *rig = *state;

    mosquitto_rig_kill(&rig->broker);
    (void)fake_hub_zone(&rig->hub, 0);
    link_rig_start(rig);
    link_rig_run(rig, 500);
    assert_int_equal(link_rig_report(rig).phase, LINK_OFFLINE);
    assert_non_null(strstr(rig->notes, "Connection refused"));
    find_broker(rig);
    link_rig_until_level(rig);
}

/* ---- events ---- */

static void expect_each_once_or_more(const struct link_rig *rig, uint64_t last)
{
    assert_int_equal(rig->hub.highest_event, last);
    assert_int_equal(rig->hub.acked, last);
    for (uint64_t n = 1; n <= last; n++) {
        assert_true(rig->hub.stored[n] >= 1);
    }
}

static void events_arrive_in_batches(void **state)
{
    struct link_rig *rig = *state;

    rig->daemon.last_event = 1000;
    (void)begin(rig);
    link_rig_until(rig, rig->daemon.acked == 1000);
    expect_each_once_or_more(rig, 1000);
    assert_int_equal(link_rig_report(rig).events_sent, 1000); /* and each once only */
    rig->daemon.last_event = 1003;
    link_door_work(rig->door, "events");
    link_rig_until(rig, rig->daemon.acked == 1003);
    expect_each_once_or_more(rig, 1003);
    assert_int_equal(link_rig_report(rig).events_sent, 1003);
}

/* Two batches are under way at most. */
static void without_acknowledgements_the_window_closes(void **state)
{
    struct link_rig *rig = *state;

    rig->daemon.last_event = 1000;
    rig->hub.loses_acks = true;
    (void)begin(rig);
    link_rig_until(rig, rig->hub.highest_event == 128);
    link_rig_run(rig, 2500);
    assert_int_equal(rig->hub.highest_event, 128);
    /* After ten seconds they are sent again, from the first one. */
    rig->hub.loses_acks = false;
    link_rig_until(rig, rig->daemon.acked == 1000);
    expect_each_once_or_more(rig, 1000);
    assert_int_equal(rig->hub.stored[1], 2);
    assert_int_equal(rig->hub.stored[1000], 1);
}

/* Broker kills at random moments, and acknowledgements that are lost: in the end the hub has every
 * number, and the daemon knows it. */
static void no_event_is_lost_over_kills_of_the_broker(void **state)
{
    struct link_rig *rig = *state;

    (void)begin(rig);
    for (int round = 1; round <= 6; round++) {
        rig->daemon.last_event = (uint64_t)round * 300;
        rig->hub.loses_acks = round % 2;
        link_door_work(rig->door, "events");
        link_rig_run(rig, 2 + 7 * round);
        lose_broker(rig);
        find_broker(rig);
    }
    rig->hub.loses_acks = false;
    link_rig_until(rig, rig->daemon.acked == 1800);
    expect_each_once_or_more(rig, 1800);
}

/* A hub whose database was restored has fewer events than it has acknowledged: its next answer says
 * so, and the door sends them again. */
static void events_that_the_hub_lost_are_sent_again(void **state)
{
    struct link_rig *rig = *state;

    rig->daemon.last_event = 100;
    (void)begin(rig);
    link_rig_until(rig, rig->daemon.acked == 100);
    memset(rig->hub.stored, 0, sizeof rig->hub.stored);
    for (int n = 1; n <= 40; n++) {
        rig->hub.stored[n] = 1;
    }
    rig->hub.acked = 40;
    rig->hub.told = 40;
    rig->hub.highest_event = 40;
    link_door_work(rig->door, "places");
    link_rig_until(rig, rig->hub.acked == 100);
    assert_int_equal(rig->hub.stored[40], 1);
    assert_int_equal(rig->hub.stored[41], 1);
}

/* ---- the will ---- */

static void nothing(void *context)
{
    (void)context;
}

static void nothing_lost(void *context, const char *why)
{
    (void)context;
    (void)why;
}

static void nothing_published(void *context, int id)
{
    (void)context;
    (void)id;
}

/* Another process, which is connected as the door until it is killed. */
static pid_t start_process(const struct link_rig *rig)
{
    const struct link_broker broker = {
        .host = "127.0.0.1", .port = rig->broker.port, .backoff_base_ms = 10, .backoff_cap_ms = 10};
    const struct link_mqtt_calls calls = {
        .connected = nothing, .lost = nothing_lost, .published = nothing_published};
    char topic[ISO_FLEET_TOPIC_SIZE];
    struct link_mqtt *mqtt = NULL;
    struct iso_fault fault;
    sd_event *event = NULL;
    const pid_t pid = fork();

    assert_true(pid >= 0);
    if (pid == 0) {
        (void)prctl(PR_SET_PDEATHSIG, SIGKILL);
        if (sd_event_new(&event) < 0 ||
            link_mqtt_new(event, &broker, "door", iso_fleet_topic_online(&rig->daemon.door, topic),
                          &calls, &mqtt, &fault) < 0) {
            _exit(1);
        }
        (void)sd_event_loop(event);
        _exit(1);
    }
    return pid;
}

static void the_will_of_a_killed_process_is_published(void **state)
{
    struct link_rig *rig = *state;
    int status = 0;
    const pid_t pid = start_process(rig);

    link_rig_until(rig, strcmp(rig->hub.online, "1") == 0);
    assert_int_equal(kill(pid, SIGKILL), 0);
    assert_int_equal(waitpid(pid, &status, 0), pid);
    link_rig_until(rig, strcmp(rig->hub.online, "0") == 0);
}

static void a_link_that_ends_says_so(void **state)
{
    struct link_rig *rig = *state;

    (void)begin(rig);
    link_rig_until(rig, strcmp(rig->hub.online, "1") == 0);
    link_door_free(rig->door);
    rig->door = NULL;
    link_rig_until(rig, strcmp(rig->hub.online, "0") == 0);
}

static void a_new_certificate_makes_a_new_connection(void **state)
{
    struct link_rig *rig = *state;
    struct hub_zone *zone = begin(rig);

    link_door_renew(rig->door);
    link_rig_until(rig, link_rig_report(rig).connections == 2);
    fake_hub_change(&rig->hub, zone);
    link_rig_until_level(rig);
}

#define RIG_TEST(name) cmocka_unit_test_setup_teardown(name, link_rig_setup, link_rig_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        RIG_TEST(after_a_loss_of_the_broker_the_door_catches_up),
        RIG_TEST(a_broker_that_comes_late_is_found),
        RIG_TEST(events_arrive_in_batches),
        RIG_TEST(without_acknowledgements_the_window_closes),
        RIG_TEST(no_event_is_lost_over_kills_of_the_broker),
        RIG_TEST(events_that_the_hub_lost_are_sent_again),
        RIG_TEST(the_will_of_a_killed_process_is_published),
        RIG_TEST(a_link_that_ends_says_so),
        RIG_TEST(a_new_certificate_makes_a_new_connection),
    };

    return mosquitto_rig_is_there() ? cmocka_run_group_tests(tests, NULL, NULL) : TEST_SKIPPED;
}
