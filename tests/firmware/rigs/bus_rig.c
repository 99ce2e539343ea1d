#include "tests/firmware/rigs/bus_rig.h"

#include <stdio.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/contract/contract.h"
#include "tests/support/programs/private_bus.h"

static struct private_bus private;
static bool there_is_a_bus;

/* ---- set-up ---- */

int bus_rig_group_setup(void **state)
{
    (void)state;
    there_is_a_bus = private_bus_start(&private);
    return 0;
}

int bus_rig_group_teardown(void **state)
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

sd_bus *bus_rig_connect(char *told)
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

void bus_rig_connect_clients(struct bus_rig *fixture)
{
    for (int i = 0; i < 2; i++) {
        sd_bus_flush_close_unref(fixture->client[i]);
        fixture->client[i] = bus_rig_connect(fixture->told[i]);
    }
}

static void on_message(void *context, int priority, const char *text)
{
    (void)context;
    (void)priority;
    (void)text;
}

int bus_rig_setup(void **state)
{
    static struct bus_rig fixture;
    struct iso_fault fault = {.text = ""};
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
    /* The appliance of the rig reports to the rig. This appliance reports to the bus. */
    iso_appliance_free(fixture.rig->appliance);
    fixture.rig->borrowed.events = iso_bus_events(fixture.service, on_message);
    assert_int_equal(iso_appliance_new(&fixture.rig->borrowed, &fixture.rig->appliance), 0);
    rig_start(fixture.rig);
    if (iso_bus_serve(fixture.service, fixture.rig->appliance, &fixture.rig->borrowed,
                      fixture.event, &fault)) {
        fail_msg("%s", fault.text);
    }
    bus_rig_connect_clients(&fixture);
    *state = &fixture;
    return 0;
}

int bus_rig_teardown(void **state)
{
    struct bus_rig *fixture = *state;
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

/* Skips the test if there is no dbus-daemon. */
struct bus_rig *bus_rig_need(void **state)
{
    if (!*state) {
        print_message("no dbus-daemon\n");
        skip();
    }
    return *state;
}

/* ---- calls ---- */

/* Runs the service and both clients once. */
void bus_rig_go_round(struct bus_rig *fixture)
{
    assert_true(sd_event_run(fixture->event, 200) >= 0);
    for (int i = 0; i < 2; i++) {
        if (fixture->client[i]) {
            while (sd_bus_process(fixture->client[i], NULL) > 0) {
            }
        }
    }
}

static int on_answer(sd_bus_message *reply, void *context, sd_bus_error *unused)
{
    struct bus_answer *answer = context;
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

/* Sends a call of a client and waits for the answer. The answer is valid until the next call. */
struct bus_answer *bus_rig_send(struct bus_rig *fixture, int client, sd_bus_message *message)
{
    static struct bus_answer answer;
    sd_bus_message_unref(answer.reply);
    answer = (struct bus_answer){.there = false};
    assert_true(sd_bus_call_async(fixture->client[client], NULL, message, on_answer, &answer, 0) >=
                0);
    sd_bus_message_unref(message);
    for (int i = 0; i < BUS_RIG_ROUNDS && !answer.there; i++) {
        bus_rig_go_round(fixture);
    }
    assert_true(answer.there);
    return &answer;
}

sd_bus_message *bus_rig_new_call(struct bus_rig *fixture, int client, const char *method)
{
    sd_bus_message *message = NULL;
    assert_true(sd_bus_message_new_method_call(fixture->client[client], &message, ISO_CONTRACT_NAME,
                                               ISO_CONTRACT_PATH, ISO_CONTRACT_INTERFACE,
                                               method) >= 0);
    return message;
}

/* Calls a method without arguments, or with one string. Returns "" or the last word of the error's
 * name. */
const char *bus_rig_call(struct bus_rig *fixture, int client, const char *method,
                         const char *argument)
{
    sd_bus_message *message = bus_rig_new_call(fixture, client, method);
    if (argument) {
        assert_true(sd_bus_message_append(message, "s", argument) >= 0);
    }
    const struct bus_answer *answer = bus_rig_send(fixture, client, message);
    const char *dot = strrchr(answer->error, '.');
    return dot ? dot + 1 : answer->error;
}

/* Runs the appliance for this time, then delivers its signals. */
void bus_rig_run(struct bus_rig *fixture, int64_t ms)
{
    rig_run(fixture->rig, ms);
    assert_string_equal(bus_rig_call(fixture, 0, ISO_CONTRACT_GET_STATUS, NULL),
                        ""); /* this call follows all signals */
    assert_string_equal(bus_rig_call(fixture, 1, ISO_CONTRACT_GET_STATUS, NULL), "");
}

const char *bus_rig_news(struct bus_rig *fixture, int client)
{
    static char text[1024];
    strcpy(text, fixture->told[client]);
    fixture->told[client][0] = '\0';
    return text;
}

void bus_rig_restart_bus(struct bus_rig *fixture)
{
    private_bus_kill(&private);
    assert_true(private_bus_revive(&private));
    for (int i = 0; i < 2; i++) {
        fixture->client[i] = sd_bus_flush_close_unref(fixture->client[i]);
    }
}

void bus_rig_end_bus(void)
{
    private_bus_stop(&private);
    there_is_a_bus = false;
}

const char *bus_rig_address(void)
{
    return private.address;
}
