/* The program isotherm-link: joining with a one-time address, the service, its certificate, and
 * leaving. Hub and broker have TLS; the daemon is a process on a bus. */
#include <errno.h>
#include <jansson.h>
#include <signal.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "firmware/fleet/program/renew.h"
#include "tests/firmware/fleet/link/bus_service.h"
#include "tests/firmware/fleet/link/link_rig.h"
#include "tests/firmware/fleet/program/link_figures.h"
#include "tests/firmware/fleet/program/link_leftover.h"
#include "tests/firmware/rigs/cmocka_headers.h"
#include "tests/support/programs/private_bus.h"
#include "tests/support/programs/run.h"
#include "tests/support/scratch.h"

#define PROGRAM ISOTHERM_BINARY_DIR "/firmware/fleet/program/isotherm-link"

static struct private_bus bus;

/* The hub's part of joining. */
struct office {
    struct link_rig *rig;
    void (*fetch)(void *context, const char *path, const void *body, size_t size,
                  struct fetch_answer *out);
    pid_t daemon;
    char state[160];
    char csr[4096]; /* of the last request */
    unsigned joins, renewals;
    bool sends_other_certificate;
};

static void answer_json(struct fetch_answer *out, unsigned status, json_t *object)
{
    assert_non_null(object);
    out->bytes = json_dumps(object, JSON_COMPACT);
    out->size = strlen(out->bytes);
    out->status = status;
    json_decref(object);
}

static void certify(struct office *office, const char *csr, char certificate[4096])
{
    char id[ISO_FLEET_ID_TEXT_SIZE], unused[4096];

    (void)iso_fleet_id_text(&office->rig->daemon.door, id);
    if (office->sends_other_certificate) {
        authority_client(&office->rig->authority, id, unused, certificate);
    } else {
        authority_sign(&office->rig->authority, csr, id, certificate);
    }
}

static void answer_join(struct office *office, const json_t *body, struct fetch_answer *out)
{
    char certificate[4096], id[ISO_FLEET_ID_TEXT_SIZE], address[129];
    const struct fake_daemon *door = &office->rig->daemon;

    if (strcmp(json_string_value(json_object_get(body, "code")), "GOODCODE") != 0) {
        answer_json(out, 403,
                    json_pack("{s:s, s:s}", "code", "code-refused", "detail", "no such code\033["));
        return;
    }
    (void)sodium_bin2hex(address, 65, door->signer.public, 32);
    (void)sodium_bin2hex(address + 64, 65, door->receiver.public, 32);
    assert_string_equal(json_string_value(json_object_get(body, "address")), address);
    certify(office, json_string_value(json_object_get(body, "csr")), certificate);
    office->joins++;
    answer_json(out, 200,
                json_pack("{s:s, s:s, s:s, s:s, s:{s:s, s:i}}", "door",
                          iso_fleet_id_text(&door->door, id), "membership",
                          fake_hub_membership(&office->rig->hub, &office->rig->daemon),
                          "certificate", certificate, "ca", office->rig->authority.pem, "broker",
                          "host", "127.0.0.1", "port", (int)office->rig->broker.port));
}

static void answer(void *context, const char *path, const void *bytes, size_t size,
                   struct fetch_answer *out)
{
    struct office *office = context;
    char certificate[4096];

    if (strcmp(path, "/fleet/v1/fetch") == 0) {
        office->fetch(&office->rig->hub, path, bytes, size, out);
        return;
    }
    json_t *body = json_loadb(bytes, size, 0, NULL);
    assert_non_null(body);
    (void)snprintf(office->csr, sizeof office->csr, "%s",
                   json_string_value(json_object_get(body, "csr")));
    if (strcmp(path, "/fleet/v1/join") == 0) {
        answer_join(office, body, out);
    } else {
        assert_string_equal(path, "/fleet/v1/renew");
        office->renewals++;
        certify(office, office->csr, certificate);
        answer_json(
            out, 200,
            json_pack("{s:s, s:s}", "certificate", certificate, "ca", office->rig->authority.pem));
    }
    json_decref(body);
}

static int setup(void **state)
{
    static struct office office;
    void *rig = NULL;

    assert_int_equal(link_rig_setup_secure(&rig), 0);
    office = (struct office){.rig = rig};
    office.fetch = office.rig->hub.server.answer;
    office.rig->hub.server.answer = answer;
    office.rig->hub.server.context = &office;
    (void)snprintf(office.state, sizeof office.state, "%s",
                   scratch_path(office.rig->broker.directory, "state"));
    scratch_mkdir(office.state);
    assert_int_equal(setenv("RUNTIME_DIRECTORY", office.state, 1), 0);
    office.daemon = bus_service_start(bus.address, &office.rig->daemon, false);
    *state = &office;
    return 0;
}

static int teardown(void **state)
{
    struct office *office = *state;
    void *rig = office->rig;

    bus_service_stop(office->daemon);
    return link_rig_teardown(&rig);
}

static void begin(struct office *office, struct run *run, const char *command, const char *address)
{
    const char *const argv[] = {PROGRAM,     "--state",     office->state, "--bus", bus.address,
                                "--updates", office->state, command,       address, NULL};

    run_start(run, argv);
}

static bool has_ended(const struct run *run)
{
    siginfo_t info = {.si_pid = 0};

    assert_int_equal(waitid(P_PID, (id_t)run->pid, &info, WEXITED | WNOHANG | WNOWAIT), 0);
    return info.si_pid != 0;
}

/* Runs a command while the hub answers; the caller frees the run. */
static void command(struct office *office, struct run *run, const char *word, const char *address)
{
    begin(office, run, word, address);
    link_rig_until(office->rig, has_ended(run));
    run_finish(run);
}

static const char *address_of(const struct office *office, const char *code, int change)
{
    static char address[512];
    char ca[65];
    unsigned char digest[32];

    memcpy(digest, office->rig->authority.digest, sizeof digest);
    digest[31] = (unsigned char)(digest[31] + change);
    (void)sodium_bin2hex(ca, sizeof ca, digest, sizeof digest);
    (void)snprintf(address, sizeof address, "isotherm://127.0.0.1:%u/?ca=%s&code=%s",
                   office->rig->hub.server.port, ca, code);
    return address;
}

static bool has(const struct office *office, const char *name)
{
    return scratch_exists(scratch_path(office->state, name));
}

/* The daemon is asked at once; it may need a moment to be on the bus. */
static void join(struct office *office)
{
    struct run run;
    bool has_joined = false;

    for (int i = 0; i < 50 && !has_joined; i++) {
        command(office, &run, "join", address_of(office, "GOODCODE", 0));
        has_joined = run.exit == 0;
        if (!has_joined && !strstr(run.err, "GetAddress")) {
            fail_msg("%s", run.err);
        }
        run_free(&run);
        link_rig_run(office->rig, has_joined ? 0 : 50);
    }
    assert_true(has_joined);
}

/* The service renews its file every five seconds. */
static void the_figures_are_those_of_the_door(struct office *office)
{
    bool is_connected = false;
    struct run run;

    for (int i = 0; i < 100 && !is_connected; i++) {
        command(office, &run, "status", "--metrics");
        run_expect(&run, 0);
        is_connected = link_figures_say_connected(run.out);
        if (!is_connected) {
            run_free(&run);
            link_rig_run(office->rig, 100);
        }
    }
    assert_true(is_connected);
    link_figures_are_online(run.out);
    run_free(&run);
    /* Without the service the door is not connected, and its counts are not told. */
    assert_int_equal(setenv("RUNTIME_DIRECTORY", "/nowhere", 1), 0);
    command(office, &run, "status", "--metrics");
    run_expect(&run, 0);
    link_figures_are_alone(run.out);
    run_free(&run);
}

static void a_door_joins_and_leaves(void **state)
{
    struct office *office = *state;
    struct link_rig *rig = office->rig;
    struct run run, service;
    struct stat file;

    (void)fake_hub_zone(&rig->hub, 10);
    link_leftover_make(office->state); /* a factory reset has deleted link.json */
    begin(office, &service, "run", NULL);
    link_rig_until(rig, !link_leftover_is_there(office->state));
    join(office);
    assert_int_equal(office->joins, 1);
    assert_int_equal(stat(scratch_path(office->state, "door.key"), &file), 0);
    assert_int_equal(file.st_mode & 0777, 0600);
    /* The service, which runs since before, finds the files and connects with the certificate. */
    link_rig_until(rig, rig->hub.last_question.sequence == 10);
    assert_string_equal(rig->hub.online, "1");
    command(office, &run, "status", NULL);
    run_expect(&run, 0);
    assert_non_null(strstr(run.out, "Works"));
    assert_non_null(strstr(run.out, "change 10"));
    assert_non_null(strstr(run.out, "certificate  until"));
    run_free(&run);
    the_figures_are_those_of_the_door(office);
    command(office, &run, "join", address_of(office, "GOODCODE", 0));
    run_expect(&run, 1);
    assert_non_null(strstr(run.err, "leave it first"));
    run_free(&run);
    link_leftover_make(office->state);
    command(office, &run, "leave", NULL);
    run_expect(&run, 0);
    run_free(&run);
    assert_false(link_leftover_is_there(office->state) || has(office, "link.json") ||
                 has(office, "door.key") || has(office, "door.crt"));
    link_rig_until(rig, strcmp(rig->hub.online, "0") == 0);
    assert_int_equal(kill(service.pid, SIGTERM), 0);
    run_finish(&service);
    run_expect(&service, 0);
    run_free(&service);
    command(office, &run, "status", NULL);
    run_expect(&run, 3);
    run_free(&run);
}

static void expect_refusal(struct office *office, const char *address, int exit, const char *words)
{
    struct run run;

    command(office, &run, "join", address);
    run_expect(&run, exit);
    assert_non_null(strstr(run.err, words));
    assert_null(strchr(run.err, '\033'));
    run_free(&run);
    assert_false(has(office, "link.json") || has(office, "door.key") || has(office, "ca.crt"));
}

static void a_wrong_hub_or_code_is_refused(void **state)
{
    struct office *office = *state;

    link_rig_run(office->rig, 500); /* until the daemon is on the bus */
    expect_refusal(office, address_of(office, "GOODCODE", 1), 1, "its authority is another one");
    assert_int_equal(office->rig->hub.server.requests, 0); /* it did not even get the code */
    expect_refusal(office, address_of(office, "BADCODE", 0), 1, "no such code");
    expect_refusal(office, "isotherm://127.0.0.1:1/?ca=0&code=A", 2, "64 hexadecimal digits");
    office->sends_other_certificate = true;
    expect_refusal(office, address_of(office, "GOODCODE", 0), 4, "not for this door");
    office->sends_other_certificate = false;
    bus_service_stop(office->daemon);
    expect_refusal(office, address_of(office, "GOODCODE", 0), 4, "GetAddress");
    office->daemon = bus_service_start(bus.address, &office->rig->daemon, true);
    link_rig_run(office->rig, 500);
    expect_refusal(office, address_of(office, "GOODCODE", 0), 4, "the membership is not mine");
}

/* In a process of its own, because the hub answers in this one. */
static int renew_in_child(struct office *office)
{
    struct iso_fault fault = {.text = ""};
    struct link_home home;
    siginfo_t info = {.si_pid = 0};
    const pid_t pid = fork();

    assert_true(pid >= 0);
    if (pid == 0) {
        int r = link_home_read(office->state, &home, &fault);
        r = r < 0 ? r : link_renew(office->state, &home, &fault);
        _exit(r < 0 ? 1 : 0);
    }
    link_rig_until(office->rig,
                   waitid(P_PID, (id_t)pid, &info, WEXITED | WNOHANG) == 0 && info.si_pid == pid);
    return info.si_status;
}

static void a_certificate_is_renewed_with_the_same_key(void **state)
{
    struct office *office = *state;
    struct iso_fault fault;
    bool is_due = true;
    int64_t ends_s = 0;
    char before[4096];

    join(office);
    const char *path = scratch_path(office->state, "door.crt");
    assert_int_equal(link_renew_look(office->state, time(NULL), &is_due, &ends_s, &fault), 0);
    assert_false(is_due);
    /* It is good for ninety days. */
    assert_int_equal(
        link_renew_look(office->state, time(NULL) + 61 * 86400, &is_due, &ends_s, &fault), 0);
    assert_true(is_due);
    char *key = scratch_read_text(scratch_path(office->state, "door.key"));
    char *old = scratch_read_text(path);
    (void)snprintf(before, sizeof before, "%s", old);
    free(old);
    office->sends_other_certificate = true;
    assert_int_equal(renew_in_child(office), 1);
    old = scratch_read_text(path);
    assert_string_equal(old, before);
    free(old);
    office->sends_other_certificate = false;
    assert_int_equal(renew_in_child(office), 0);
    assert_int_equal(office->renewals, 2);
    char *now = scratch_read_text(path);
    assert_string_not_equal(now, before);
    char *key_now = scratch_read_text(scratch_path(office->state, "door.key"));
    assert_string_equal(key, key_now);
    free(now);
    free(key);
    free(key_now);
}

static void bad_command_lines_are_refused(void **state)
{
    static const char *const bad[][4] = {{NULL},
                                         {"jump", NULL},
                                         {"join", NULL},
                                         {"leave", "x", NULL},
                                         {"--nothing", "run", NULL},
                                         {"run", "--metrics", NULL}};

    (void)state;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        const char *argv[6] = {PROGRAM};
        struct run run;
        for (int k = 0; k < 4 && bad[i][k]; k++) {
            argv[k + 1] = bad[i][k];
        }
        run_start(&run, argv);
        run_finish(&run);
        run_expect(&run, 2);
        assert_true(run.err[0]);
        run_free(&run);
    }
}

#define OFFICE_TEST(name) cmocka_unit_test_setup_teardown(name, setup, teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        OFFICE_TEST(a_door_joins_and_leaves),
        OFFICE_TEST(a_wrong_hub_or_code_is_refused),
        OFFICE_TEST(a_certificate_is_renewed_with_the_same_key),
        cmocka_unit_test(bad_command_lines_are_refused),
    };

    if (!mosquitto_rig_is_there() || !private_bus_start(&bus)) {
        return TEST_SKIPPED;
    }
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    private_bus_stop(&bus);
    return failed;
}
