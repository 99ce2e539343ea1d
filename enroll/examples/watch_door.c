/* Watches a door over the bus. Prints the state of the appliance, the enrolled people, and then one
 * line for each visit.
 *
 *     watch_door [ADDRESS [COUNT]]
 *
 * ADDRESS is the address of a message bus; without it, or with "", the system bus is used. The
 * program ends after COUNT visits. The policy of the bus decides who may call the daemon: on an
 * appliance these are root and the members of the group isotherm.
 *
 *     cc -O2 watch_door.c $(pkg-config --cflags --libs libsystemd) -o watch_door
 */
#include <errno.h>
#include <inttypes.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <systemd/sd-bus.h>

static const char service[] = "org.isotherm.Isotherm";
static const char object[] = "/org/isotherm/Door0";
static const char interface[] = "org.isotherm.Door";

/* Connects to the system bus, or to the bus at an address. */
static int connect_to(const char *address, sd_bus **out)
{
    if (!address || !*address) {
        return sd_bus_open_system(out);
    }
    int error = sd_bus_new(out);
    error = error < 0 ? error : sd_bus_set_address(*out, address);
    error = error < 0 ? error : sd_bus_set_bus_client(*out, true);
    return error < 0 ? error : sd_bus_start(*out);
}

/* Calls a method without arguments. The caller releases the reply. */
static int call(sd_bus *bus, const char *method, sd_bus_message **reply)
{
    sd_bus_error why = SD_BUS_ERROR_NULL;
    const int error = sd_bus_call_method(bus, service, object, interface, method, &why, reply, "");
    if (error < 0) {
        fprintf(stderr, "%s: %s\n", method, why.message ? why.message : strerror(-error));
    }
    sd_bus_error_free(&why);
    return error;
}

/* Reads one value of the state, and prints it if its key is one of the wanted ones. */
static int print_value(sd_bus_message *reply, const char *key)
{
    static const char *const wanted[] = {"version", "sensor-state", "door-state", "people"};
    const char *type = NULL;
    bool is_wanted = false;
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++) {
        is_wanted = is_wanted || strcmp(key, wanted[i]) == 0;
    }
    int error = sd_bus_message_peek_type(reply, NULL, &type);
    if (error < 0 || !is_wanted) {
        return error < 0 ? error : sd_bus_message_skip(reply, "v");
    }
    if (strcmp(type, "s") == 0) {
        const char *text = NULL;
        error = sd_bus_message_read(reply, "v", "s", &text);
        printf("%s: %s\n", key, error < 0 ? "?" : text);
    } else if (strcmp(type, "u") == 0) {
        uint32_t number = 0;
        error = sd_bus_message_read(reply, "v", "u", &number);
        printf("%s: %" PRIu32 "\n", key, number);
    } else {
        error = sd_bus_message_skip(reply, "v");
    }
    return error;
}

/* GetStatus() -> a{sv}: a dictionary with values of different types. */
static int print_state(sd_bus *bus)
{
    sd_bus_message *reply = NULL;
    int error = call(bus, "GetStatus", &reply);
    error = error < 0 ? error : sd_bus_message_enter_container(reply, 'a', "{sv}");
    while (error >= 0 && (error = sd_bus_message_enter_container(reply, 'e', "sv")) > 0) {
        const char *key = NULL;
        error = sd_bus_message_read(reply, "s", &key);
        error = error < 0 ? error : print_value(reply, key);
        error = error < 0 ? error : sd_bus_message_exit_container(reply);
    }
    sd_bus_message_unref(reply);
    return error;
}

/* ListPeople() -> a(sxxxu): name, enrolled, valid from, valid until (seconds since 1970; 0: no
 * limit), templates. */
static int print_people(sd_bus *bus)
{
    sd_bus_message *reply = NULL;
    const char *name = NULL;
    int64_t enrolled = 0, from = 0, until = 0;
    uint32_t templates = 0;
    int error = call(bus, "ListPeople", &reply);
    error = error < 0 ? error : sd_bus_message_enter_container(reply, 'a', "(sxxxu)");
    while (error >= 0 && (error = sd_bus_message_read(reply, "(sxxxu)", &name, &enrolled, &from,
                                                      &until, &templates)) > 0) {
        printf("enrolled: %s, %" PRIu32 " template(s)\n", name, templates);
    }
    sd_bus_message_unref(reply);
    return error;
}

/* Visit(s verdict, s person, d score, d threshold, u frames, x latency_us, s reason, s door,
 * s door_fault): a decision of the door. Counts down the visits that are still expected. */
static int on_visit(sd_bus_message *signal, void *context, sd_bus_error *why)
{
    (void)why;
    long *left = context;
    const char *verdict = NULL, *person = NULL, *reason = NULL, *door = NULL, *fault = NULL;
    double score = 0.0, threshold = 0.0;
    uint32_t frames = 0;
    int64_t latency_us = 0;
    const int error = sd_bus_message_read(signal, "ssdduxsss", &verdict, &person, &score,
                                          &threshold, &frames, &latency_us, &reason, &door, &fault);
    if (error < 0) {
        return error;
    }
    printf("visit: %s %s, score %.1f of %.1f, %s%s%s\n", verdict, *person ? person : "(unknown)",
           score, threshold, reason, *door ? ", door " : "", door);
    (void)fflush(stdout);
    --*left;
    return 0;
}

static int watch(sd_bus *bus, long count)
{
    long left = count;
    int error = sd_bus_match_signal(bus, NULL, service, object, interface, "Visit", on_visit,
                                    &left);
    if (error >= 0) {
        puts("watching");
        (void)fflush(stdout);
    }
    while (error >= 0 && left != 0) {
        error = sd_bus_process(bus, NULL); /* this calls on_visit */
        error = error == 0 ? sd_bus_wait(bus, UINT64_MAX) : error;
    }
    return error;
}

int main(int argc, char **argv)
{
    const long count = argc > 2 ? strtol(argv[2], NULL, 10) : -1; /* -1: without an end */
    sd_bus *bus = NULL;
    int error = connect_to(argc > 1 ? argv[1] : NULL, &bus);
    error = error < 0 ? error : print_state(bus);
    error = error < 0 ? error : print_people(bus);
    error = error < 0 ? error : watch(bus, count);
    if (error < 0) {
        fprintf(stderr, "%s: %s\n", argv[0], strerror(-error));
    }
    sd_bus_flush_close_unref(bus);
    return error < 0 ? 1 : 0;
}
