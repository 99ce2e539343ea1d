/* The service on a private bus: every method, error and signal of the contract. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/contract/contract.h"
#include "tests/firmware/rigs/bus_rig.h"

/* EnrollStart with one option. */
static const char *call_enroll(struct bus_rig *fixture, const char *person, const char *option,
                               const char *type, int64_t value)
{
    sd_bus_message *message = bus_rig_new_call(fixture, 0, ISO_CONTRACT_ENROLL_START);
    int r = sd_bus_message_append(message, "s", person);
    if (!option) {
        r = sd_bus_message_append(message, "a{sv}", 0);
    } else if (*type == 'b') {
        r = sd_bus_message_append(message, "a{sv}", 1, option, type, (int)value);
    } else {
        r = sd_bus_message_append(message, "a{sv}", 1, option, type, value);
    }
    assert_true(r >= 0);
    const struct bus_answer *answer = bus_rig_send(fixture, 0, message);
    const char *dot = strrchr(answer->error, '.');
    return dot ? dot + 1 : answer->error;
}

/* ---- claim ---- */

static void one_client_has_the_claim(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_RELEASE, NULL), "ClaimDevice");
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_CLAIM, NULL), "");
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_CLAIM, NULL), "AlreadyInUse");
    assert_string_equal(bus_rig_call(f, 1, ISO_CONTRACT_CLAIM, NULL), "AlreadyInUse");
    assert_string_equal(bus_rig_call(f, 1, ISO_CONTRACT_RELEASE, NULL), "AlreadyInUse");
    assert_string_equal(bus_rig_call(f, 1, ISO_CONTRACT_IDENTIFY_START, NULL), "AlreadyInUse");
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_RELEASE, NULL), "");
    assert_string_equal(bus_rig_call(f, 1, ISO_CONTRACT_CLAIM, NULL), "");
}

static void a_client_that_leaves_loses_the_claim(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_CLAIM, NULL), "");
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_IDENTIFY_START, NULL), "");
    sd_bus_flush_close_unref(f->client[0]);
    f->client[0] = NULL;
    for (int i = 0; i < BUS_RIG_ROUNDS; i++) {
        if (iso_appliance_status(f->rig->appliance).mode == ISO_APPLIANCE_WATCH) {
            break;
        }
        bus_rig_go_round(f);
    }
    assert_string_equal(bus_rig_call(f, 1, ISO_CONTRACT_CLAIM, NULL), "");
    f->client[0] = bus_rig_connect(f->told[0]);
}

static void an_idle_claim_runs_out(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_CLAIM, NULL), "");
    bus_rig_run(f, 61000);
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_IDENTIFY_START, NULL), "ClaimDevice");
    assert_string_equal(bus_rig_call(f, 1, ISO_CONTRACT_CLAIM, NULL), "");
}

static void actions_want_a_claim(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    rig_enrol(f->rig, "anna", 50);
    assert_string_equal(call_enroll(f, "bob", NULL, NULL, 0), "ClaimDevice");
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_VERIFY_START, "anna"), "ClaimDevice");
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_IDENTIFY_START, NULL), "ClaimDevice");
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_ENROLL_STOP, NULL), "ClaimDevice");
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_CLAIM, NULL), "");
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_ENROLL_STOP, NULL), "NoActionInProgress");
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_VERIFY_STOP, NULL), "NoActionInProgress");
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_IDENTIFY_STOP, NULL), "NoActionInProgress");
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_IDENTIFY_START, NULL), "");
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_IDENTIFY_START, NULL), "ActionInProgress");
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_IDENTIFY_STOP, NULL), "");
}

/* ---- enrolling ---- */

static void enrols(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_CLAIM, NULL), "");
    assert_string_equal(call_enroll(f, "anna", ISO_CONTRACT_VALID_UNTIL, "x", 1795260000), "");
    rig_show_unusable(f->rig, ISO_CAPTURE_TOO_CLOSE, 3);
    bus_rig_run(f, 110);
    rig_show(f->rig, 50, 3);
    bus_rig_run(f, 200);
    assert_string_equal(bus_rig_news(f, 0), "EnrollStatus enroll-retry-too-close; "
                                            "EnrollStatus enroll-stage-passed; "
                                            "EnrollStatus enroll-stage-passed; "
                                            "EnrollStatus enroll-stage-passed; "
                                            "EnrollStatus enroll-completed");
    assert_string_equal(bus_rig_news(f, 1), ""); /* nobody else is told */
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_ENROLL_STOP, NULL), "");
    assert_int_equal(iso_gallery_find(f->rig->gallery, "anna")->valid_until_s, 1795260000);

    assert_string_equal(call_enroll(f, "bob", ISO_CONTRACT_ALLOW_DUPLICATE, "b", 1), "");
    rig_show(f->rig, 50, 3);
    bus_rig_run(f, 200);
    assert_non_null(strstr(bus_rig_news(f, 0), "enroll-completed"));
}

static void refuses_enrolments(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_CLAIM, NULL), "");
    assert_string_equal(call_enroll(f, "", NULL, NULL, 0), "InvalidName");
    assert_string_equal(call_enroll(f, "a\tb", NULL, NULL, 0), "InvalidName");
    assert_string_equal(call_enroll(f, "bob", "colour", "x", 3), "InvalidArgument");
    assert_string_equal(call_enroll(f, "bob", ISO_CONTRACT_VALID_FROM, "b", 1), "InvalidArgument");
    assert_string_equal(call_enroll(f, "bob", ISO_CONTRACT_VALID_UNTIL, "x", -5),
                        "InvalidArgument");
    rig_enrol(f->rig, "anna", 50);
    rig_enrol(f->rig, "eve", 70);
    rig_enrol(f->rig, "zac", 90);
    assert_string_equal(call_enroll(f, "bob", NULL, NULL, 0), "GalleryFull");
    f->rig->sensor.wait_error = f->rig->sensor.open_error = -ENODEV;
    bus_rig_run(f, 100);
    assert_string_equal(call_enroll(f, "anna", NULL, NULL, 0), "DeviceFault");
    f->rig->sensor.wait_error = f->rig->sensor.open_error = 0;
}

/* ---- verifying and identifying ---- */

static void verifies_and_identifies(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    rig_enrol(f->rig, "anna", 50);
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_CLAIM, NULL), "");
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_VERIFY_START, "zac"), "NoSuchPerson");
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_VERIFY_START, "anna"), "");
    rig_show(f->rig, 50, 2);
    bus_rig_run(f, 100);
    assert_string_equal(bus_rig_news(f, 0), "VerifyStatus verify-match");
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_VERIFY_STOP, NULL), "");
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_IDENTIFY_START, NULL), "");
    rig_show(f->rig, 70, 6);
    bus_rig_run(f, 300);
    assert_string_equal(bus_rig_news(f, 0), "IdentifyStatus identify-no-match");
    assert_string_equal(bus_rig_news(f, 1), "");
}

/* ---- the door ---- */

static void tells_everybody_of_visits(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    rig_enrol(f->rig, "anna", 50);
    rig_show(f->rig, 50, 2);
    bus_rig_run(f, 100);
    assert_string_equal(bus_rig_news(f, 0), "DoorChanged unlocked; Visit allow");
    assert_string_equal(bus_rig_news(f, 1), "DoorChanged unlocked; Visit allow");
    bus_rig_run(f, 5000);
    rig_show(f->rig, 70, 6);
    bus_rig_run(f, 300);
    assert_string_equal(bus_rig_news(f, 0), "DoorChanged locked; Visit deny");
}

/* ---- gallery, status, log ---- */

static void lists_and_deletes(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    const char *name = NULL;
    int64_t enrolled = 0, from = 1, until = 1;
    uint32_t templates = 0;
    rig_enrol(f->rig, "anna", 50);
    rig_enrol(f->rig, "bob", 70);
    rig_enrol(f->rig, "bob", 72);
    struct bus_answer *answer = bus_rig_send(f, 1,
                                             bus_rig_new_call(f, 1, ISO_CONTRACT_LIST_PEOPLE));
    assert_true(sd_bus_message_enter_container(answer->reply, 'a', "(sxxxu)") > 0);
    assert_true(sd_bus_message_read(answer->reply, "(sxxxu)", &name, &enrolled, &from, &until,
                                    &templates) > 0);
    assert_string_equal(name, "anna");
    assert_int_equal(enrolled, 1);
    assert_int_equal(from, 0);
    assert_int_equal(until, 0);
    assert_int_equal(templates, 1);
    assert_true(sd_bus_message_read(answer->reply, "(sxxxu)", &name, &enrolled, &from, &until,
                                    &templates) > 0);
    assert_string_equal(name, "bob");
    assert_int_equal(templates, 2);
    assert_string_equal(bus_rig_call(f, 1, ISO_CONTRACT_DELETE_PERSON, "bob"), "");
    assert_string_equal(bus_rig_call(f, 1, ISO_CONTRACT_DELETE_PERSON, "bob"), "NoSuchPerson");
    assert_null(iso_gallery_find(f->rig->gallery, "bob"));
    rig_fill_disk();
    assert_string_equal(bus_rig_call(f, 1, ISO_CONTRACT_DELETE_PERSON, "anna"), "Storage");
    rig_free_disk();
}

/* The value of a key of GetStatus, as text. */
static const char *status_of(struct bus_rig *f, const char *key)
{
    static char text[128];
    struct bus_answer *answer = bus_rig_send(f, 0, bus_rig_new_call(f, 0, ISO_CONTRACT_GET_STATUS));
    const char *name, *contents;
    char type;
    assert_true(sd_bus_message_enter_container(answer->reply, 'a', "{sv}") > 0);
    while (sd_bus_message_enter_container(answer->reply, 'e', "sv") > 0) {
        assert_true(sd_bus_message_read(answer->reply, "s", &name) > 0);
        assert_true(sd_bus_message_peek_type(answer->reply, &type, &contents) > 0);
        if (strcmp(name, key) == 0) {
            const char *s;
            uint32_t u;
            uint64_t t = 0; /* a boolean fills half of it */
            double d;
            switch (*contents) {
            case 's':
                assert_true(sd_bus_message_read(answer->reply, "v", "s", &s) > 0);
                (void)snprintf(text, sizeof text, "s %s", s);
                return text;
            case 'u':
                assert_true(sd_bus_message_read(answer->reply, "v", "u", &u) > 0);
                (void)snprintf(text, sizeof text, "u %u", u);
                return text;
            case 'd':
                assert_true(sd_bus_message_read(answer->reply, "v", "d", &d) > 0);
                (void)snprintf(text, sizeof text, "d %g", d);
                return text;
            default:
                assert_true(sd_bus_message_read(answer->reply, "v", contents, &t) > 0);
                (void)snprintf(text, sizeof text, "%c %llu", *contents, (unsigned long long)t);
                return text;
            }
        }
        assert_true(sd_bus_message_skip(answer->reply, "v") > 0);
        assert_true(sd_bus_message_exit_container(answer->reply) > 0);
    }
    return "missing";
}

static void tells_its_state(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    rig_enrol(f->rig, "anna", 50);
    rig_enrol(f->rig, "anna", 51);
    rig_show(f->rig, 50, 2);
    bus_rig_run(f, 250);
    static const char *const wanted[][2] = {
        {"version", "s " ISOTHERM_VERSION},
        {"sensor", "s replay"},
        {"sensor-model", "s puppet9"},
        {"sensor-state", "s started"},
        {"sensor-fault", "s "},
        {"sensor-devices", "s "},
        {"sensor-calibration", "s "},
        {"door-lines", "s "},
        {"door", "s null"},
        {"door-state", "s unlocked"},
        {"mode", "s watch"},
        {"people", "u 1"},
        {"templates", "u 2"},
        {"templates-usable", "u 2"},
        {"capacity", "u 1000"},
        {"frames", "t 2"},
        {"last-outcome", "s allow anna"},
        {"image-check", "s flag"},
        {"model", "s 00000abc"},
        {"algorithm", "s 00000051"},
        {"threshold", "d 6"},
        {"uptime-ms", "x 250"},
        {"visits-allowed", "t 1"},
        {"visits-denied", "t 0"},
        {"visits-attack", "t 0"},
        {"attack-frames", "t 0"},
        {"capture", "s ok"},
        {"distance-mm", "d 700"},
        {"right-mm", "d 0"},
        {"yaw-deg", "d 0"},
        {"coverage", "d 0.9"},
        {"residual-mm", "d 1.5"},
        {"landmark-sigma-mm", "d 2.5"},
        {"speed-mm-s", "d 0"},
    };
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++) {
        assert_string_equal(status_of(f, wanted[i][0]), wanted[i][1]);
    }
    assert_memory_equal(status_of(f, "log-sequence"), "t ", 2);
}

/* While all is well they are there, and empty. */
static void tells_the_codes_of_its_faults(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    static const char *const keys[] = {
        "sensor-fault-code",   "sensor-health-code", "sensor-calibration-code",
        "sensor-devices-code", "door-fault-code",    "storage-fault-code",
        "clock-fault-code",    "stale-fault-code",   "counter-fault-code"};
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++) {
        assert_string_equal(status_of(f, keys[i]), "s ");
    }
}

static void carries_faults_that_are_no_utf8(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    f->rig->sensor.open_error = f->rig->sensor.wait_error = -ENODEV;
    f->rig->sensor.text = "/srv/\xff\xfe: gone";
    bus_rig_run(f, 100);
    f->rig->sensor.open_error = f->rig->sensor.wait_error = 0;
    assert_string_equal(status_of(f, "sensor-fault"), "s /srv/?\?: gone");
    assert_string_equal(status_of(f, "sensor-fault-code"), "s sensor-gone");
}

static void reads_the_log(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    sd_bus_message *message = bus_rig_new_call(f, 0, ISO_CONTRACT_READ_LOG);
    const char *line = NULL;
    int n = 0;
    assert_true(sd_bus_message_append(message, "tu", (uint64_t)2, (uint32_t)2) >= 0);
    struct bus_answer *answer = bus_rig_send(f, 0, message);
    assert_true(sd_bus_message_enter_container(answer->reply, 'a', "s") > 0);
    while (sd_bus_message_read(answer->reply, "s", &line) > 0) {
        char begin[32];
        (void)snprintf(begin, sizeof begin, "{\"sequence\":%d,", 2 + n);
        assert_memory_equal(line, begin, strlen(begin));
        n++;
    }
    assert_int_equal(n, 2);
}

/* ---- the connection ---- */

static void one_service_has_the_name(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    struct iso_bus *second = NULL;
    struct iso_fault fault = {.text = ""};
    assert_int_equal(iso_bus_open(bus_rig_address(), &second, NULL), 0);
    assert_int_equal(iso_bus_serve(second, f->rig->appliance, &f->rig->borrowed, f->event, &fault),
                     -EEXIST);
    assert_string_equal(fault.text,
                        "bus: the name org.isotherm.Isotherm: another isothermd has it");
    iso_bus_close(second);
}

static void says_that_there_is_no_bus(void **state)
{
    struct iso_bus *bus = NULL;
    struct iso_fault fault = {.text = ""};
    (void)state;
    assert_int_equal(iso_bus_open("unix:path=/nonexistent/bus", &bus, &fault), -ENOENT);
    assert_string_equal(fault.text, "bus 'unix:path=/nonexistent/bus': No such file or directory");
    assert_true(iso_bus_open("nonsense", &bus, &fault) < 0);
    iso_bus_close(NULL);
}

static void notices_the_end_of_the_bus(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    assert_false(iso_bus_is_gone(f->service));
    bus_rig_end_bus();
    for (int i = 0; i < BUS_RIG_ROUNDS && !iso_bus_is_gone(f->service); i++) {
        assert_true(sd_event_run(f->event, 200) >= 0);
    }
    assert_true(iso_bus_is_gone(f->service));
    rig_run(f->rig, 1000); /* and the appliance does not mind */
    struct iso_fault fault = {.text = ""};
    assert_true(iso_bus_mend(f->service, &fault) < 0);
    assert_true(iso_bus_is_gone(f->service));
}

static void comes_back_to_a_bus_that_does(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    struct iso_fault fault = {.text = ""};
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_CLAIM, NULL), "");
    bus_rig_restart_bus(f);
    for (int i = 0; i < BUS_RIG_ROUNDS && !iso_bus_is_gone(f->service); i++) {
        assert_true(sd_event_run(f->event, 200) >= 0);
    }
    assert_false(iso_bus_is_serving(f->service) && !iso_bus_is_gone(f->service));
    assert_int_equal(iso_bus_mend(f->service, &fault), 0);
    assert_int_equal(iso_appliance_status(f->rig->appliance).mode, ISO_APPLIANCE_WATCH);
    for (int i = 0; i < BUS_RIG_ROUNDS && !iso_bus_is_serving(f->service); i++) {
        assert_true(sd_event_run(f->event, 200) >= 0);
    }
    assert_true(iso_bus_is_serving(f->service));
    bus_rig_connect_clients(f);
    assert_string_equal(bus_rig_call(f, 1, ISO_CONTRACT_CLAIM, NULL), "");
}

static void who_calls_without_end_is_refused(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    int answered = 0;
    for (int i = 0; i < 100; i++) {
        const char *error = bus_rig_call(f, 0, ISO_CONTRACT_LIST_PEOPLE, NULL);
        answered += !*error;
        assert_true(!*error || strcmp(error, "TooManyCalls") == 0);
    }
    assert_in_range(answered, 30, 60);
    assert_string_equal(bus_rig_call(f, 1, ISO_CONTRACT_LIST_PEOPLE, NULL), ""); /* somebody else */
    rig_run(f->rig, 1000);
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_LIST_PEOPLE, NULL), "");
}

static void an_administrator_shuts_the_door(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    rig_enrol(f->rig, "anna", 50);
    sd_bus_message *call = bus_rig_new_call(f, 0, ISO_CONTRACT_SET_LOCKDOWN);
    assert_true(sd_bus_message_append(call, "b", 1) >= 0);
    assert_string_equal(bus_rig_send(f, 0, call)->error, "");
    assert_string_equal(status_of(f, "lockdown"), "b 1");
    assert_string_equal(status_of(f, "lockout-ms"), "x 0");
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_CLAIM, NULL), "");
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_VERIFY_START, "anna"), "LockedOut");
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_CLEAR_LOCKOUT, NULL), "");
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_VERIFY_START, "anna"), "LockedOut");
    call = bus_rig_new_call(f, 0, ISO_CONTRACT_SET_LOCKDOWN);
    assert_true(sd_bus_message_append(call, "b", 0) >= 0);
    assert_string_equal(bus_rig_send(f, 0, call)->error, "");
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_VERIFY_START, "anna"), "");
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, bus_rig_setup, bus_rig_teardown)
    const struct CMUnitTest tests[] = {
        TEST(one_client_has_the_claim),
        TEST(a_client_that_leaves_loses_the_claim),
        TEST(an_idle_claim_runs_out),
        TEST(actions_want_a_claim),
        TEST(enrols),
        TEST(refuses_enrolments),
        TEST(verifies_and_identifies),
        TEST(tells_everybody_of_visits),
        TEST(lists_and_deletes),
        TEST(tells_its_state),
        TEST(tells_the_codes_of_its_faults),
        TEST(carries_faults_that_are_no_utf8),
        TEST(reads_the_log),
        TEST(one_service_has_the_name),
        cmocka_unit_test(says_that_there_is_no_bus),
        TEST(an_administrator_shuts_the_door),
        TEST(who_calls_without_end_is_refused),
        TEST(comes_back_to_a_bus_that_does),
        TEST(notices_the_end_of_the_bus),
    };
    return cmocka_run_group_tests(tests, bus_rig_group_setup, bus_rig_group_teardown);
}
