/* The methods VerifySelf and VerifyLogin: who may begin a login, what the caller learns, and when
 * the camera is free again. Root is needed: the file of the users must belong to root. */
#include <errno.h>
#include <libgen.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/contract/contract.h"
#include "tests/firmware/rigs/bus_rig.h"
#include "tests/support/scratch.h"

enum { NOBODY_UID = 65534, ANNA_FACE = 50, STRANGER_FACE = 80 };

/* The last VerifyStatus that client 0 got. */
static struct {
    char result[64], person[64];
    int done;
    double score, threshold;
} last;

static int on_status(sd_bus_message *signal, void *context, sd_bus_error *error)
{
    const char *result = "", *person = "";
    (void)context;
    (void)error;
    assert_true(sd_bus_message_read(signal, "sbsdd", &result, &last.done, &person, &last.score,
                                    &last.threshold) >= 0);
    (void)snprintf(last.result, sizeof last.result, "%s", result);
    (void)snprintf(last.person, sizeof last.person, "%s", person);
    return 0;
}

static void write_users(struct bus_rig *f, const char *text)
{
    const char *path = scratch_path(f->rig->directory, "pam-users");
    scratch_write_text(path, text);
    assert_int_equal(chmod(path, 0640), 0);
    (void)snprintf(f->rig->config.login.users, sizeof f->rig->config.login.users, "%s", path);
}

/* A desk machine, on which root is anna. */
static struct bus_rig *need_desk(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    if (geteuid() != 0) {
        print_message("skipped: needs root\n");
        skip();
    }
    memset(&last, 0, sizeof last);
    rig_enrol(f->rig, "anna", ANNA_FACE);
    f->rig->config.login.desk = true;
    write_users(f, "root anna\nnobody anna\n");
    assert_true(sd_bus_match_signal(f->client[0], NULL, NULL, ISO_CONTRACT_PATH,
                                    ISO_CONTRACT_INTERFACE, ISO_CONTRACT_VERIFY_STATUS, on_status,
                                    NULL) >= 0);
    return f;
}

static const char *verify_self(struct bus_rig *f, int client)
{
    return bus_rig_call(f, client, ISO_CONTRACT_VERIFY_SELF, NULL);
}

static const char *verify_login(struct bus_rig *f, int client, const char *person)
{
    return bus_rig_call(f, client, ISO_CONTRACT_VERIFY_LOGIN, person);
}

/* Connects client 1 anew, as the user nobody. */
static void connect_as_nobody(struct bus_rig *f)
{
    char path[256];
    (void)snprintf(path, sizeof path, "%s", strchr(bus_rig_address(), '=') + 1);
    assert_int_equal(chmod(dirname(path), 0755), 0);
    sd_bus_flush_close_unref(f->client[1]);
    assert_int_equal(seteuid(NOBODY_UID), 0);
    f->client[1] = bus_rig_connect(f->told[1]);
    assert_int_equal(seteuid(0), 0);
}

/* Whether the camera is free: another client can have it. */
static void expect_free(struct bus_rig *f)
{
    assert_string_equal(bus_rig_call(f, 1, ISO_CONTRACT_CLAIM, NULL), "");
    assert_string_equal(bus_rig_call(f, 1, ISO_CONTRACT_RELEASE, NULL), "");
}

/* ---- what the caller learns ---- */

static void the_caller_learns_the_verdict_alone(void **state)
{
    struct bus_rig *f = need_desk(state);
    assert_string_equal(verify_self(f, 0), "");
    rig_show(f->rig, ANNA_FACE, 2);
    bus_rig_run(f, 200);
    assert_string_equal(last.result, "verify-match");
    assert_int_equal(last.done, 1);
    assert_string_equal(last.person, "");
    assert_true(isnan(last.score));
    assert_true(fabs(last.threshold) < 1e-9);
    assert_false(rig_relay(f->rig));
    expect_free(f);
}

static void a_stranger_and_nobody_do_not_match(void **state)
{
    struct bus_rig *f = need_desk(state);
    assert_string_equal(verify_login(f, 0, "anna"), "");
    rig_show(f->rig, STRANGER_FACE, 6);
    bus_rig_run(f, 400);
    assert_string_equal(last.result, "verify-no-match");
    assert_true(isnan(last.score));
    expect_free(f);
    f->rig->config.login.longest_ms = 3000;
    assert_string_equal(verify_login(f, 0, "anna"), "");
    bus_rig_run(f, 2900);
    assert_string_equal(bus_rig_call(f, 1, ISO_CONTRACT_CLAIM, NULL), "AlreadyInUse");
    bus_rig_run(f, 200);
    assert_string_equal(last.result, "verify-timed-out");
    expect_free(f);
}

static void a_login_is_on_record_with_its_user(void **state)
{
    struct bus_rig *f = need_desk(state);
    const char *line;
    assert_string_equal(verify_self(f, 0), "");
    line = rig_record(f->rig, "act");
    assert_non_null(strstr(line, "\"person\":\"anna\""));
    assert_non_null(strstr(line, "\"note\":\"login, asked by user 0\""));
}

static void a_desk_at_rest_recognises_nobody(void **state)
{
    struct bus_rig *f = need_desk(state);
    rig_show(f->rig, ANNA_FACE, 6);
    bus_rig_run(f, 2000);
    rig_show(f->rig, STRANGER_FACE, 12);
    bus_rig_run(f, 2000);
    rig_show_unusable(f->rig, ISO_CAPTURE_FLAT, 12);
    bus_rig_run(f, 2000);
    assert_string_equal(bus_rig_call(f, 1, ISO_CONTRACT_AIM_START, NULL), "");
    rig_show(f->rig, STRANGER_FACE, 12);
    bus_rig_run(f, 2000);
    rig_show_unusable(f->rig, ISO_CAPTURE_FLAT, 12);
    bus_rig_run(f, 2000);
    assert_non_null(strstr(bus_rig_news(f, 1), "View"));
    const struct iso_appliance_status status = iso_appliance_status(f->rig->appliance);
    assert_int_equal(status.counts.allowed, 0);
    assert_int_equal(status.counts.denied, 0);
    assert_int_equal(status.counts.attack_frames, 0);
    assert_string_equal(rig_record(f->rig, "visit"), "");
    assert_false(rig_relay(f->rig));
}

/* ---- who may ---- */

static void only_root_says_which_person_it_is(void **state)
{
    struct bus_rig *f = need_desk(state);
    connect_as_nobody(f);
    assert_string_equal(verify_login(f, 1, "anna"), "AccessDenied");
    assert_string_equal(verify_self(f, 1), "");
    assert_non_null(strstr(rig_record(f->rig, "act"), "asked by user 65534"));
}

static void a_door_serves_no_logins(void **state)
{
    struct bus_rig *f = need_desk(state);
    f->rig->config.login.desk = false;
    assert_string_equal(verify_self(f, 0), "NoLogins");
    assert_string_equal(verify_login(f, 0, "anna"), "NoLogins");
    assert_int_equal(iso_appliance_verify_login(f->rig->appliance, "anna", NULL), -EOPNOTSUPP);
    assert_string_equal(rig_record(f->rig, "act"), "");
    rig_show(f->rig, ANNA_FACE, 2);
    bus_rig_run(f, 200);
    assert_true(rig_relay(f->rig)); /* the door was watched all the time */
}

static void who_is_not_in_the_file_cannot_log_in(void **state)
{
    struct bus_rig *f = need_desk(state);
    write_users(f, "nobody anna\n");
    assert_string_equal(verify_self(f, 0), "NoSuchPerson");
    bus_rig_run(f, 2100);
    write_users(f, "root zoe\n");
    assert_string_equal(verify_self(f, 0), "NoSuchPerson");
    bus_rig_run(f, 2100);
    write_users(f, "root anna\nbroken\n");
    assert_string_equal(verify_self(f, 0), "NoLogins");
    bus_rig_run(f, 2100);
    write_users(f, "root anna\n");
    assert_int_equal(chmod(f->rig->config.login.users, 0666), 0);
    assert_string_equal(verify_self(f, 0), "NoLogins");
    assert_string_equal(verify_login(f, 0, "a\nb"), "InvalidName");
    expect_free(f);
}

static void who_is_not_valid_now_cannot_log_in(void **state)
{
    struct bus_rig *f = need_desk(state);
    struct iso_fault fault = {.text = ""};
    const struct iso_validity past = {0, 1000};
    assert_int_equal(iso_gallery_set_validity(f->rig->gallery, "anna", &past, &fault), 0);
    assert_string_equal(verify_self(f, 0), "LockedOut");
    expect_free(f);
}

/* ---- how long ---- */

static void a_user_waits_before_the_next_turn(void **state)
{
    struct bus_rig *f = need_desk(state);
    connect_as_nobody(f);
    assert_string_equal(verify_self(f, 0), "");
    assert_string_equal(verify_self(f, 1), "AlreadyInUse");
    bus_rig_run(f, 3000); /* the wait begins at the end of the login */
    rig_show(f->rig, ANNA_FACE, 2);
    bus_rig_run(f, 200);
    assert_string_equal(verify_self(f, 0), "AlreadyInUse");
    assert_string_equal(verify_self(f, 1), "");
    sd_bus_flush_close_unref(f->client[1]); /* who leaves the bus ends the login */
    f->client[1] = bus_rig_connect(f->told[1]);
    bus_rig_run(f, 2100);
    assert_string_equal(verify_self(f, 0), "");
}

static void a_login_is_no_claim(void **state)
{
    static const char *const methods[] = {ISO_CONTRACT_RELEASE,      ISO_CONTRACT_IDENTIFY_START,
                                          ISO_CONTRACT_WATCH_RELIEF, ISO_CONTRACT_PICTURE,
                                          ISO_CONTRACT_VERIFY_STOP,  ISO_CONTRACT_IDENTIFY_STOP};
    struct bus_rig *f = need_desk(state);
    assert_string_equal(verify_login(f, 0, "anna"), "");
    for (size_t i = 0; i < sizeof methods / sizeof *methods; i++) {
        assert_string_equal(bus_rig_call(f, 0, methods[i], NULL), "ClaimDevice");
    }
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_VERIFY_START, "anna"), "ClaimDevice");
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_CLAIM, NULL), "AlreadyInUse");
    assert_string_equal(bus_rig_call(f, 1, ISO_CONTRACT_CLAIM, NULL), "AlreadyInUse");
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, bus_rig_setup, bus_rig_teardown)
    const struct CMUnitTest tests[] = {
        TEST(the_caller_learns_the_verdict_alone),  TEST(a_stranger_and_nobody_do_not_match),
        TEST(a_login_is_on_record_with_its_user),   TEST(a_desk_at_rest_recognises_nobody),
        TEST(only_root_says_which_person_it_is),    TEST(a_door_serves_no_logins),
        TEST(who_is_not_in_the_file_cannot_log_in), TEST(who_is_not_valid_now_cannot_log_in),
        TEST(a_user_waits_before_the_next_turn),    TEST(a_login_is_no_claim),
    };
    return cmocka_run_group_tests(tests, bus_rig_group_setup, bus_rig_group_teardown);
}
