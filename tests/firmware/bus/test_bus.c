/* The service on a private bus: every method, error and signal of the contract. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/contract/contract.h"
#include "tests/firmware/rigs/bus_rig.h"

/* Calls EnrollStart with one option (NULL: none). Returns the last word of the error's name; "" on
 * success. */
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

/* Only who asks for poses gets the signals about them. */
static void poses_are_an_option(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_CLAIM, NULL), "");
    assert_string_equal(call_enroll(f, "anna", ISO_CONTRACT_POSES, "x", 1), "InvalidArgument");
    assert_string_equal(call_enroll(f, "anna", ISO_CONTRACT_POSES, "b", 1), "");
    bus_rig_run(f, 50);
    assert_string_equal(bus_rig_news(f, 0), "EnrollStep frontal");
    assert_string_equal(bus_rig_news(f, 1), "");
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_ENROLL_STOP, NULL), "");
    assert_string_equal(call_enroll(f, "anna", ISO_CONTRACT_POSES, "b", 0), "");
    bus_rig_run(f, 50);
    assert_string_equal(bus_rig_news(f, 0), "");
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

static void actions_need_a_claim(void **state)
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
    assert_string_equal(bus_rig_news(f, 1), ""); /* the other client gets no signal */
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

static void sends_visits_to_all_clients(void **state)
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
    rig_run(f->rig, 1000); /* and the appliance continues */
    struct iso_fault fault = {.text = ""};
    assert_true(iso_bus_mend(f->service, &fault) < 0);
    assert_true(iso_bus_is_gone(f->service));
}

static void returns_to_a_bus_that_was_restarted(void **state)
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

static void a_client_that_calls_without_end_is_refused(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    int answered = 0;
    for (int i = 0; i < 100; i++) {
        const char *error = bus_rig_call(f, 0, ISO_CONTRACT_LIST_PEOPLE, NULL);
        answered += !*error;
        assert_true(!*error || strcmp(error, "TooManyCalls") == 0);
    }
    assert_in_range(answered, 30, 60);
    assert_string_equal(bus_rig_call(f, 1, ISO_CONTRACT_LIST_PEOPLE, NULL),
                        ""); /* another client */
    rig_run(f->rig, 1000);
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_LIST_PEOPLE, NULL), "");
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, bus_rig_setup, bus_rig_teardown)
    const struct CMUnitTest tests[] = {
        TEST(poses_are_an_option),
        TEST(one_client_has_the_claim),
        TEST(a_client_that_leaves_loses_the_claim),
        TEST(an_idle_claim_runs_out),
        TEST(actions_need_a_claim),
        TEST(enrols),
        TEST(refuses_enrolments),
        TEST(verifies_and_identifies),
        TEST(sends_visits_to_all_clients),
        TEST(lists_and_deletes),
        TEST(reads_the_log),
        TEST(one_service_has_the_name),
        cmocka_unit_test(says_that_there_is_no_bus),
        TEST(a_client_that_calls_without_end_is_refused),
        TEST(returns_to_a_bus_that_was_restarted),
        TEST(notices_the_end_of_the_bus),
    };
    return cmocka_run_group_tests(tests, bus_rig_group_setup, bus_rig_group_teardown);
}
