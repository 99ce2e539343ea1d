/* How long the event loop of the hub stands still while accounts list and change a fleet of 10,000
 * people and 1,000 doors. The requests come from another process. */
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/enroll/hub/rigs/api_rig.h"

enum { ROUNDS = 4, BEAT_US = 1000 };

/* The limit is generous: the machine may be busy. What it guards against is a call of the database
 * within the loop, which takes seconds here. */
static const double LONGEST_MS = 400;

static const char fleet[] =
    "INSERT INTO zone (id, name, digest, base_digest, key, lease_s) "
    "SELECT gen_random_uuid(), 'zone ' || i, sha256(''), sha256(''), 'k', 86400 "
    "FROM generate_series(1, 20) i; "
    "INSERT INTO door (id, name, added_s, joined_s, reported_s, online, signs, receives, "
    "algorithm, "
    "health) "
    "SELECT gen_random_uuid(), 'door ' || i, 1, 1, 1, true, sha256(i::text::bytea), "
    "sha256(i::text::bytea), 3, '{\"door-state\":\"locked\",\"sensor-state\":\"started\",\"fault\":"
    "\"\",\"people\":10000}' FROM generate_series(1, 1000) i; "
    "INSERT INTO door_zone (door, zone, position) SELECT d.id, z.id, 0 FROM door d JOIN zone z "
    "ON z.name = 'zone ' || (1 + length(d.name) * 7 % 20); "
    "INSERT INTO person (id, name, folded, revision) SELECT gen_random_uuid(), 'person ' || i, "
    "'person ' || i, i FROM generate_series(1, 10000) i; "
    "INSERT INTO person_zone (person, zone) SELECT p.id, z.id FROM person p, zone z WHERE z.name "
    "IN "
    "('zone 1', 'zone 2'); "
    "INSERT INTO template (person, number, algorithm, sealed) SELECT id, 1, 3, 's' FROM person; "
    "INSERT INTO event (door, number, time, record) SELECT d.id, i, '2026-11-21T08:30:15.250Z', "
    "'{\"event\":\"visit\",\"person\":\"person 1\"}' FROM door d, generate_series(1, 100) i; "
    "ANALYZE";

static const char *const looks[] = {"/doors",
                                    "/people?max=1000",
                                    "/people?search=n%209",
                                    "/people?unseen=1&max=1000",
                                    "/events?max=1000",
                                    "/lockdown",
                                    "/zones",
                                    "/status"};

static double now_ms(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return 1e3 * (double)now.tv_sec + 1e-6 * (double)now.tv_nsec;
}

/* In the child: its own TLS, no event loop. Ends with 0 if each answer was 200. */
static void make_requests(const char *headers)
{
    struct https client;
    struct https_answer answer;
    char path[128];

    if (https_open(&client, NULL, api_rig.web.port, "NORMAL", false)) {
        _exit(1);
    }
    for (int round = 0; round < ROUNDS; round++) {
        for (size_t i = 0; i < sizeof looks / sizeof *looks; i++) {
            const double begun = now_ms();
            (void)snprintf(path, sizeof path, "/api/v1%s", looks[i]);
            https_ask(&client, "GET", path, headers, NULL, &answer);
            if (answer.status != 200) {
                _exit(2);
            }
            if (round == ROUNDS - 1) {
                printf("%-28s %6.0f ms, %zu bytes\n", looks[i], now_ms() - begun, answer.size);
            }
            https_answer_free(&answer);
        }
    }
    (void)fflush(stdout);
    _exit(0);
}

struct beat {
    double last, longest_ms;
};

static int on_beat(sd_event_source *source, uint64_t usec, void *context)
{
    struct beat *beat = context;
    const double now = now_ms();
    (void)usec;

    if (now - beat->last > beat->longest_ms) {
        beat->longest_ms = now - beat->last;
    }
    beat->last = now;
    return sd_event_source_set_time_relative(source, BEAT_US);
}

static void the_loop_goes_on_while_the_fleet_is_listed(void **state)
{
    struct beat beat = {.last = 0};
    struct iso_fault fault = {.text = ""};
    sd_event_source *source = NULL;
    int status = 0;
    (void)state;

    store_rig_fine(hub_db_script(api_rig.hub->store.db, fleet, &fault), &fault);
    const double begun = now_ms();
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        make_requests(api_rig.headers[WEB_ROLE_ADMINISTRATOR]);
    }
    assert_true(sd_event_add_time_relative(api_rig.web.event, &source, CLOCK_MONOTONIC, BEAT_US, 1,
                                           on_beat, &beat) >= 0);
    assert_true(sd_event_source_set_enabled(source, SD_EVENT_ON) >= 0);
    beat.last = now_ms();
    while (waitpid(child, &status, WNOHANG) == 0) {
        assert_true(sd_event_run(api_rig.web.event, 10000) >= 0);
    }
    sd_event_source_disable_unref(source);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 0);
    print_message("%d requests in %.0f ms; the loop stood still for %.1f ms at most\n",
                  ROUNDS * (int)(sizeof looks / sizeof *looks), now_ms() - begun, beat.longest_ms);
    assert_true(beat.longest_ms < LONGEST_MS);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(the_loop_goes_on_while_the_fleet_is_listed, api_rig_setup,
                                        api_rig_teardown),
    };
    return cmocka_run_group_tests(tests, store_rig_start, store_rig_stop);
}
