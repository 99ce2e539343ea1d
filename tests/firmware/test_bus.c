/* The service on a private bus: every method, error and signal of the contract. Service and clients
 * are in one process; the loop goes round until the answer is there. */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <systemd/sd-bus.h>

#include "tests/firmware/cmocka_headers.h"

#include "core/contract.h"
#include "firmware/bus.h"
#include "tests/enroll/private_bus.h"
#include "tests/firmware/rig.h"

enum { ROUNDS_MAX = 20000 };

static struct private_bus private;
static bool there_is_a_bus;

struct fixture {
    struct rig *rig;
    sd_event *event;
    struct iso_bus *service;
    sd_bus *client[2];
    char told[2][1024]; /* signals: "EnrollStatus enroll-completed; ..." */
};

/* ---- set-up ---- */

static int group_setup(void **state)
{
    (void)state;
    there_is_a_bus = private_bus_start(&private);
    return 0;
}

static int group_teardown(void **state)
{
    (void)state;
    if (there_is_a_bus) {
        private_bus_stop(&private);
    }
    return 0;
}

static int on_signal(sd_bus_message *signal, void *context, sd_bus_error *error)
{
    char *told = context;
    const size_t used = strlen(told);
    const char *word = "";
    (void)error;
    (void)sd_bus_message_read(signal, "s", &word);
    (void)snprintf(told + used, 1024 - used, "%s%s %s", used ? "; " : "",
                   sd_bus_message_get_member(signal), word);
    return 0;
}

static sd_bus *connect_client(char *told)
{
    sd_bus *bus = NULL;
    assert_true(sd_bus_new(&bus) >= 0);
    assert_true(sd_bus_set_address(bus, private.address) >= 0);
    assert_true(sd_bus_set_bus_client(bus, 1) >= 0);
    assert_true(sd_bus_start(bus) >= 0);
    assert_true(sd_bus_match_signal(bus, NULL, ISO_CONTRACT_NAME, ISO_CONTRACT_PATH,
                                    ISO_CONTRACT_INTERFACE, NULL, on_signal, told) >= 0);
    return bus;
}

static void on_message(void *context, int priority, const char *text)
{
    (void)context;
    (void)priority;
    (void)text;
}

static int setup(void **state)
{
    static struct fixture fixture;
    struct iso_fault fault = {""};
    void *rig = NULL;
    *state = NULL;
    if (!there_is_a_bus) {
        return 0;
    }
    memset(&fixture, 0, sizeof fixture);
    assert_int_equal(rig_setup(&rig), 0);
    fixture.rig = rig;
    assert_true(sd_event_new(&fixture.event) >= 0);
    if (iso_bus_open(private.address, &fixture.service, &fault)) {
        fail_msg("%s", fault.text);
    }
    /* The rig's appliance reports to the rig; this one to the bus. */
    iso_appliance_free(fixture.rig->appliance);
    fixture.rig->parts.events = iso_bus_events(fixture.service, on_message);
    assert_int_equal(iso_appliance_new(&fixture.rig->parts, &fixture.rig->appliance), 0);
    rig_start(fixture.rig);
    if (iso_bus_serve(fixture.service, fixture.rig->appliance, &fixture.rig->parts, fixture.event,
                      &fault)) {
        fail_msg("%s", fault.text);
    }
    for (int i = 0; i < 2; i++) {
        fixture.client[i] = connect_client(fixture.told[i]);
    }
    *state = &fixture;
    return 0;
}

static int teardown(void **state)
{
    struct fixture *fixture = *state;
    if (!fixture) {
        return 0;
    }
    void *rig = fixture->rig;
    iso_bus_close(fixture->service);
    for (int i = 0; i < 2; i++) {
        sd_bus_flush_close_unref(fixture->client[i]);
    }
    sd_event_unref(fixture->event);
    return rig_teardown(&rig);
}

/* Skips the test where there is no dbus-daemon. */
static struct fixture *need(void **state)
{
    if (!*state) {
        print_message("no dbus-daemon\n");
        skip();
    }
    return *state;
}

/* ---- calls ---- */

/* One round of the service and both clients. */
static void go_round(struct fixture *fixture)
{
    assert_true(sd_event_run(fixture->event, 200) >= 0);
    for (int i = 0; i < 2; i++) {
        if (fixture->client[i]) {
            while (sd_bus_process(fixture->client[i], NULL) > 0) {
            }
        }
    }
}

struct answer {
    bool there;
    char error[96], text[128];
    sd_bus_message *reply;
};

static int on_answer(sd_bus_message *reply, void *context, sd_bus_error *unused)
{
    struct answer *answer = context;
    const sd_bus_error *error = sd_bus_message_get_error(reply);
    (void)unused;
    answer->there = true;
    if (error) {
        (void)snprintf(answer->error, sizeof answer->error, "%s", error->name);
        (void)snprintf(answer->text, sizeof answer->text, "%s", error->message);
    }
    answer->reply = sd_bus_message_ref(reply);
    return 0;
}

/* Sends a call of a client and waits for the answer; valid until the next. */
static struct answer *send_call(struct fixture *fixture, int client, sd_bus_message *message)
{
    static struct answer answer;
    sd_bus_message_unref(answer.reply);
    answer = (struct answer){.there = false};
    assert_true(sd_bus_call_async(fixture->client[client], NULL, message, on_answer, &answer, 0) >=
                0);
    sd_bus_message_unref(message);
    for (int i = 0; i < ROUNDS_MAX && !answer.there; i++) {
        go_round(fixture);
    }
    assert_true(answer.there);
    return &answer;
}

static sd_bus_message *new_call(struct fixture *fixture, int client, const char *method)
{
    sd_bus_message *message = NULL;
    assert_true(sd_bus_message_new_method_call(fixture->client[client], &message, ISO_CONTRACT_NAME,
                                               ISO_CONTRACT_PATH, ISO_CONTRACT_INTERFACE,
                                               method) >= 0);
    return message;
}

/* A method without arguments, or with one string. "" or the error's last word. */
static const char *call(struct fixture *fixture, int client, const char *method,
                        const char *argument)
{
    sd_bus_message *message = new_call(fixture, client, method);
    if (argument) {
        assert_true(sd_bus_message_append(message, "s", argument) >= 0);
    }
    const struct answer *answer = send_call(fixture, client, message);
    const char *dot = strrchr(answer->error, '.');
    return dot ? dot + 1 : answer->error;
}

/* EnrollStart with one option. */
static const char *call_enroll(struct fixture *fixture, const char *person, const char *option,
                               const char *type, int64_t value)
{
    sd_bus_message *message = new_call(fixture, 0, ISO_CONTRACT_ENROLL_START);
    int r = sd_bus_message_append(message, "s", person);
    if (!option) {
        r = sd_bus_message_append(message, "a{sv}", 0);
    } else if (*type == 'b') {
        r = sd_bus_message_append(message, "a{sv}", 1, option, type, (int)value);
    } else {
        r = sd_bus_message_append(message, "a{sv}", 1, option, type, value);
    }
    assert_true(r >= 0);
    const struct answer *answer = send_call(fixture, 0, message);
    const char *dot = strrchr(answer->error, '.');
    return dot ? dot + 1 : answer->error;
}

/* Lets the appliance run, and what it says arrive. */
static void run(struct fixture *fixture, int64_t ms)
{
    rig_run(fixture->rig, ms);
    assert_string_equal(call(fixture, 0, ISO_CONTRACT_GET_STATUS, NULL), ""); /* behind them all */
    assert_string_equal(call(fixture, 1, ISO_CONTRACT_GET_STATUS, NULL), "");
}

static const char *news(struct fixture *fixture, int client)
{
    static char text[1024];
    strcpy(text, fixture->told[client]);
    fixture->told[client][0] = '\0';
    return text;
}

/* ---- claim ---- */

static void one_client_has_the_claim(void **state)
{
    struct fixture *f = need(state);
    assert_string_equal(call(f, 0, ISO_CONTRACT_RELEASE, NULL), "ClaimDevice");
    assert_string_equal(call(f, 0, ISO_CONTRACT_CLAIM, NULL), "");
    assert_string_equal(call(f, 0, ISO_CONTRACT_CLAIM, NULL), "AlreadyInUse");
    assert_string_equal(call(f, 1, ISO_CONTRACT_CLAIM, NULL), "AlreadyInUse");
    assert_string_equal(call(f, 1, ISO_CONTRACT_RELEASE, NULL), "AlreadyInUse");
    assert_string_equal(call(f, 1, ISO_CONTRACT_IDENTIFY_START, NULL), "AlreadyInUse");
    assert_string_equal(call(f, 0, ISO_CONTRACT_RELEASE, NULL), "");
    assert_string_equal(call(f, 1, ISO_CONTRACT_CLAIM, NULL), "");
}

static void a_client_that_leaves_loses_the_claim(void **state)
{
    struct fixture *f = need(state);
    assert_string_equal(call(f, 0, ISO_CONTRACT_CLAIM, NULL), "");
    assert_string_equal(call(f, 0, ISO_CONTRACT_IDENTIFY_START, NULL), "");
    sd_bus_flush_close_unref(f->client[0]);
    f->client[0] = NULL;
    for (int i = 0; i < ROUNDS_MAX; i++) {
        if (iso_appliance_status(f->rig->appliance).mode == ISO_APPLIANCE_WATCH) {
            break;
        }
        go_round(f);
    }
    assert_string_equal(call(f, 1, ISO_CONTRACT_CLAIM, NULL), "");
    f->client[0] = connect_client(f->told[0]);
}

static void an_idle_claim_runs_out(void **state)
{
    struct fixture *f = need(state);
    assert_string_equal(call(f, 0, ISO_CONTRACT_CLAIM, NULL), "");
    run(f, 61000);
    assert_string_equal(call(f, 0, ISO_CONTRACT_IDENTIFY_START, NULL), "ClaimDevice");
    assert_string_equal(call(f, 1, ISO_CONTRACT_CLAIM, NULL), "");
}

static void actions_want_a_claim(void **state)
{
    struct fixture *f = need(state);
    rig_enrol(f->rig, "anna", 50);
    assert_string_equal(call_enroll(f, "bob", NULL, NULL, 0), "ClaimDevice");
    assert_string_equal(call(f, 0, ISO_CONTRACT_VERIFY_START, "anna"), "ClaimDevice");
    assert_string_equal(call(f, 0, ISO_CONTRACT_IDENTIFY_START, NULL), "ClaimDevice");
    assert_string_equal(call(f, 0, ISO_CONTRACT_ENROLL_STOP, NULL), "ClaimDevice");
    assert_string_equal(call(f, 0, ISO_CONTRACT_CLAIM, NULL), "");
    assert_string_equal(call(f, 0, ISO_CONTRACT_ENROLL_STOP, NULL), "NoActionInProgress");
    assert_string_equal(call(f, 0, ISO_CONTRACT_VERIFY_STOP, NULL), "NoActionInProgress");
    assert_string_equal(call(f, 0, ISO_CONTRACT_IDENTIFY_STOP, NULL), "NoActionInProgress");
    assert_string_equal(call(f, 0, ISO_CONTRACT_IDENTIFY_START, NULL), "");
    assert_string_equal(call(f, 0, ISO_CONTRACT_IDENTIFY_START, NULL), "ActionInProgress");
    assert_string_equal(call(f, 0, ISO_CONTRACT_IDENTIFY_STOP, NULL), "");
}

/* ---- enrolling ---- */

static void enrols(void **state)
{
    struct fixture *f = need(state);
    assert_string_equal(call(f, 0, ISO_CONTRACT_CLAIM, NULL), "");
    assert_string_equal(call_enroll(f, "anna", ISO_CONTRACT_VALID_UNTIL, "x", 1795260000), "");
    rig_show_unusable(f->rig, ISO_CAPTURE_TOO_CLOSE, 3);
    run(f, 110);
    rig_show(f->rig, 50, 3);
    run(f, 200);
    assert_string_equal(news(f, 0), "EnrollStatus enroll-retry-too-close; "
                                    "EnrollStatus enroll-stage-passed; "
                                    "EnrollStatus enroll-stage-passed; "
                                    "EnrollStatus enroll-stage-passed; "
                                    "EnrollStatus enroll-completed");
    assert_string_equal(news(f, 1), ""); /* nobody else is told */
    assert_string_equal(call(f, 0, ISO_CONTRACT_ENROLL_STOP, NULL), "");
    assert_int_equal(iso_gallery_find(f->rig->gallery, "anna")->valid_until_s, 1795260000);

    assert_string_equal(call_enroll(f, "bob", ISO_CONTRACT_ALLOW_DUPLICATE, "b", 1), "");
    rig_show(f->rig, 50, 3);
    run(f, 200);
    assert_non_null(strstr(news(f, 0), "enroll-completed"));
}

static void refuses_enrolments(void **state)
{
    struct fixture *f = need(state);
    assert_string_equal(call(f, 0, ISO_CONTRACT_CLAIM, NULL), "");
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
    run(f, 100);
    assert_string_equal(call_enroll(f, "anna", NULL, NULL, 0), "DeviceFault");
    f->rig->sensor.wait_error = f->rig->sensor.open_error = 0;
}

/* ---- verifying and identifying ---- */

static void verifies_and_identifies(void **state)
{
    struct fixture *f = need(state);
    rig_enrol(f->rig, "anna", 50);
    assert_string_equal(call(f, 0, ISO_CONTRACT_CLAIM, NULL), "");
    assert_string_equal(call(f, 0, ISO_CONTRACT_VERIFY_START, "zac"), "NoSuchPerson");
    assert_string_equal(call(f, 0, ISO_CONTRACT_VERIFY_START, "anna"), "");
    rig_show(f->rig, 50, 2);
    run(f, 100);
    assert_string_equal(news(f, 0), "VerifyStatus verify-match");
    assert_string_equal(call(f, 0, ISO_CONTRACT_VERIFY_STOP, NULL), "");
    assert_string_equal(call(f, 0, ISO_CONTRACT_IDENTIFY_START, NULL), "");
    rig_show(f->rig, 70, 6);
    run(f, 300);
    assert_string_equal(news(f, 0), "IdentifyStatus identify-no-match");
    assert_string_equal(news(f, 1), "");
}

/* ---- the door ---- */

static void tells_everybody_of_visits(void **state)
{
    struct fixture *f = need(state);
    rig_enrol(f->rig, "anna", 50);
    rig_show(f->rig, 50, 2);
    run(f, 100);
    assert_string_equal(news(f, 0), "DoorChanged unlocked; Visit allow");
    assert_string_equal(news(f, 1), "DoorChanged unlocked; Visit allow");
    run(f, 5000);
    rig_show(f->rig, 70, 6);
    run(f, 300);
    assert_string_equal(news(f, 0), "DoorChanged locked; Visit deny");
}

/* Every word of core/capture.h goes out as what it is. */
static void tells_everybody_every_hint(void **state)
{
    struct fixture *f = need(state);
    int n = 0;
    for (int i = 0; i < ISO_CAPTURES; i++) {
        const enum iso_capture capture = (enum iso_capture)i;
        if (capture == ISO_CAPTURE_OK || capture == ISO_CAPTURE_NO_FACE ||
            iso_capture_is_attack(capture)) {
            continue;
        }
        char wanted[64];
        rig_show_unusable(f->rig, capture, 3);
        run(f, 3000); /* and what was shown before does not count any more */
        (void)snprintf(wanted, sizeof wanted, "Hint %s", iso_capture_name(capture));
        assert_string_equal(news(f, 0), wanted);
        assert_string_equal(news(f, 1), wanted);
        n++;
    }
    assert_int_equal(n, 21);
    for (int i = ISO_CAPTURE_FLAT; i < ISO_CAPTURES; i++) {
        char wanted[64];
        rig_show_unusable(f->rig, (enum iso_capture)i, 2);
        run(f, 12000);
        assert_string_equal(news(f, 0), "Visit deny");
        (void)snprintf(wanted, sizeof wanted, "\"reason\":\"%s\",\"attack_frames\":2",
                       iso_capture_name((enum iso_capture)i));
        assert_non_null(strstr(rig_record(f->rig, "attack"), wanted));
    }
}

static int read_reason(sd_bus_message *signal, void *context, sd_bus_error *error)
{
    const char *verdict, *person, *reason;
    double score, threshold;
    uint32_t frames;
    int64_t latency_us;
    (void)error;
    assert_true(sd_bus_message_read(signal, "ssdduxs", &verdict, &person, &score, &threshold,
                                    &frames, &latency_us, &reason) > 0);
    (void)snprintf(context, 64, "%s %s %s %u", verdict, person, reason, frames);
    return 0;
}

static void tells_why(void **state)
{
    struct fixture *f = need(state);
    char reason[64] = "";
    assert_true(sd_bus_match_signal(f->client[1], NULL, ISO_CONTRACT_NAME, ISO_CONTRACT_PATH,
                                    ISO_CONTRACT_INTERFACE, ISO_CONTRACT_VISIT, read_reason,
                                    reason) >= 0);
    rig_enrol(f->rig, "anna", 50);
    rig_show_unusable(f->rig, ISO_CAPTURE_WRONG_SIZE, 2);
    run(f, 10000);
    assert_string_equal(reason, "deny  attack 0");
    rig_show(f->rig, 50, 2);
    run(f, 100);
    assert_string_equal(reason, "allow anna match 2");
}

/* ---- aiming ---- */

static void tells_what_it_sees_while_somebody_listens(void **state)
{
    struct fixture *f = need(state);
    rig_show_at(f->rig, 50, 30, 10);
    run(f, 200);
    assert_string_equal(news(f, 0), "");
    assert_string_equal(call(f, 0, ISO_CONTRACT_AIM_STOP, NULL), "NoActionInProgress");
    assert_string_equal(call(f, 0, ISO_CONTRACT_AIM_START, NULL), "");
    assert_string_equal(call(f, 0, ISO_CONTRACT_AIM_START, NULL), ""); /* once more does no harm */
    rig_show_at(f->rig, 50, 30, 10);
    run(f, 200);
    assert_string_equal(news(f, 0), "View ");
    assert_string_equal(news(f, 1), ""); /* not to others */
    assert_string_equal(call(f, 1, ISO_CONTRACT_AIM_START, NULL), "");
    assert_string_equal(call(f, 0, ISO_CONTRACT_AIM_STOP, NULL), "");
    rig_show_at(f->rig, 50, 30, 10);
    run(f, 200);
    assert_null(strstr(news(f, 0), "View"));
    assert_non_null(strstr(news(f, 1), "View"));
    assert_string_equal(call(f, 1, ISO_CONTRACT_AIM_STOP, NULL), "");
    assert_string_equal(call(f, 0, ISO_CONTRACT_AIM_START, NULL), ""); /* begins again */
    rig_show_at(f->rig, 50, 30, 10);
    run(f, 200);
    assert_non_null(strstr(news(f, 0), "View"));
}

static void who_leaves_the_bus_does_not_listen(void **state)
{
    struct fixture *f = need(state);
    assert_string_equal(call(f, 0, ISO_CONTRACT_AIM_START, NULL), "");
    assert_true(iso_appliance_is_aimed(f->rig->appliance));
    sd_bus_flush_close_unref(f->client[0]);
    f->client[0] = NULL;
    for (int i = 0; i < ROUNDS_MAX && iso_appliance_is_aimed(f->rig->appliance); i++) {
        go_round(f);
    }
    assert_false(iso_appliance_is_aimed(f->rig->appliance));
    f->client[0] = connect_client(f->told[0]);
}

/* ---- gallery, status, log ---- */

static void lists_and_deletes(void **state)
{
    struct fixture *f = need(state);
    const char *name = NULL;
    int64_t enrolled = 0, from = 1, until = 1;
    uint32_t templates = 0;
    rig_enrol(f->rig, "anna", 50);
    rig_enrol(f->rig, "bob", 70);
    rig_enrol(f->rig, "bob", 72);
    struct answer *answer = send_call(f, 1, new_call(f, 1, ISO_CONTRACT_LIST_PEOPLE));
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
    assert_string_equal(call(f, 1, ISO_CONTRACT_DELETE_PERSON, "bob"), "");
    assert_string_equal(call(f, 1, ISO_CONTRACT_DELETE_PERSON, "bob"), "NoSuchPerson");
    assert_null(iso_gallery_find(f->rig->gallery, "bob"));
    rig_fill_disk();
    assert_string_equal(call(f, 1, ISO_CONTRACT_DELETE_PERSON, "anna"), "Internal");
    rig_free_disk();
}

/* The value of a key of GetStatus, as text. */
static const char *status_of(struct fixture *f, const char *key)
{
    static char text[128];
    struct answer *answer = send_call(f, 0, new_call(f, 0, ISO_CONTRACT_GET_STATUS));
    const char *name, *contents;
    char type;
    assert_true(sd_bus_message_enter_container(answer->reply, 'a', "{sv}") > 0);
    while (sd_bus_message_enter_container(answer->reply, 'e', "sv") > 0) {
        assert_true(sd_bus_message_read(answer->reply, "s", &name) > 0);
        assert_true(sd_bus_message_peek_type(answer->reply, &type, &contents) > 0);
        if (strcmp(name, key) == 0) {
            const char *s;
            uint32_t u;
            uint64_t t;
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
    struct fixture *f = need(state);
    rig_enrol(f->rig, "anna", 50);
    rig_enrol(f->rig, "anna", 51);
    rig_show(f->rig, 50, 2);
    run(f, 250);
    static const char *const wanted[][2] = {
        {"version", "s " ISOTHERM_VERSION},
        {"sensor", "s replay"},
        {"sensor-model", "s puppet9"},
        {"sensor-state", "s started"},
        {"sensor-fault", "s "},
        {"door", "s null"},
        {"door-state", "s unlocked"},
        {"mode", "s watch"},
        {"people", "u 1"},
        {"templates", "u 2"},
        {"templates-usable", "u 2"},
        {"capacity", "u 1000"},
        {"frames", "t 2"},
        {"last-outcome", "s allow anna"},
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

static void carries_faults_that_are_no_utf8(void **state)
{
    struct fixture *f = need(state);
    f->rig->sensor.open_error = f->rig->sensor.wait_error = -ENODEV;
    f->rig->sensor.text = "/srv/\xff\xfe: gone";
    run(f, 100);
    f->rig->sensor.open_error = f->rig->sensor.wait_error = 0;
    assert_string_equal(status_of(f, "sensor-fault"), "s /srv/?\?: gone");
}

static void reads_the_log(void **state)
{
    struct fixture *f = need(state);
    sd_bus_message *message = new_call(f, 0, ISO_CONTRACT_READ_LOG);
    const char *line = NULL;
    int n = 0;
    assert_true(sd_bus_message_append(message, "tu", (uint64_t)2, (uint32_t)2) >= 0);
    struct answer *answer = send_call(f, 0, message);
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
    struct fixture *f = need(state);
    struct iso_bus *second = NULL;
    struct iso_fault fault = {""};
    assert_int_equal(iso_bus_open(private.address, &second, NULL), 0);
    assert_int_equal(iso_bus_serve(second, f->rig->appliance, &f->rig->parts, f->event, &fault),
                     -EEXIST);
    assert_string_equal(fault.text,
                        "bus: the name org.isotherm.Isotherm: another isothermd has it");
    iso_bus_close(second);
}

static void says_that_there_is_no_bus(void **state)
{
    struct iso_bus *bus = NULL;
    struct iso_fault fault = {""};
    (void)state;
    assert_int_equal(iso_bus_open("unix:path=/nonexistent/bus", &bus, &fault), -ENOENT);
    assert_string_equal(fault.text, "bus 'unix:path=/nonexistent/bus': No such file or directory");
    assert_true(iso_bus_open("nonsense", &bus, &fault) < 0);
    iso_bus_close(NULL);
}

static void notices_the_end_of_the_bus(void **state)
{
    struct fixture *f = need(state);
    assert_false(iso_bus_is_gone(f->service));
    private_bus_stop(&private);
    there_is_a_bus = false;
    for (int i = 0; i < ROUNDS_MAX && !iso_bus_is_gone(f->service); i++) {
        assert_true(sd_event_run(f->event, 200) >= 0);
    }
    assert_true(iso_bus_is_gone(f->service));
    rig_run(f->rig, 1000); /* and the appliance does not mind */
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, setup, teardown)
    const struct CMUnitTest tests[] = {
        TEST(one_client_has_the_claim),
        TEST(a_client_that_leaves_loses_the_claim),
        TEST(an_idle_claim_runs_out),
        TEST(actions_want_a_claim),
        TEST(enrols),
        TEST(refuses_enrolments),
        TEST(verifies_and_identifies),
        TEST(tells_everybody_of_visits),
        TEST(tells_everybody_every_hint),
        TEST(tells_why),
        TEST(tells_what_it_sees_while_somebody_listens),
        TEST(who_leaves_the_bus_does_not_listen),
        TEST(lists_and_deletes),
        TEST(tells_its_state),
        TEST(carries_faults_that_are_no_utf8),
        TEST(reads_the_log),
        TEST(one_service_has_the_name),
        cmocka_unit_test(says_that_there_is_no_bus),
        TEST(notices_the_end_of_the_bus),
    };
    return cmocka_run_group_tests(tests, group_setup, group_teardown);
}
