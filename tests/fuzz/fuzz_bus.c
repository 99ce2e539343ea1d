/* Calls on the message bus: the service of a whole appliance. The input decides what its clients
 * send: any method, with arguments of right or wrong types, from several names, while frames arrive
 * and time passes. The door must stay locked, and each call must be answered. */
#include <poll.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <systemd/sd-bus.h>
#include <unistd.h>

#include "firmware/bus/bus.h"
#include "firmware/contract/contract.h"
#include "tests/firmware/rigs/rig.h"
#include "tests/fuzz/fuzz.h"

enum { INPUTS_A_RIG = 2000, VALUES_MAX = 64 };

/* ---- the rest of the input ---- */

struct input {
    const uint8_t *data;
    size_t size;
};

static uint64_t take(struct input *input, size_t bytes)
{
    uint64_t value = 0;
    for (size_t i = 0; i < bytes && input->size > 0; i++) {
        value = value << 8 | *input->data++;
        input->size--;
    }
    return value;
}

/* Takes a known text, or up to 255 ASCII characters: D-Bus refuses texts that are not UTF-8. */
static const char *take_text(struct input *input)
{
    static const char *const known[] = {
        "anna",      "bob",       ISO_CONTRACT_ALLOW_DUPLICATE, ISO_CONTRACT_VALID_FROM,
        "decision",  "threshold", ISO_CONTRACT_VALID_UNTIL,     ISO_CONTRACT_EXPIRED,
        "-100",      "door",      ISO_CONTRACT_CONSENT,         "ANNA",
        "unlock_ms", "9000"};
    static char text[256];
    const size_t length = take(input, 1);
    if (length % 2 == 0) {
        return known[length / 2 % (sizeof known / sizeof *known)];
    }
    for (size_t i = 0; i < length; i++) {
        text[i] = (char)(1 + take(input, 1) % 127);
    }
    text[length] = '\0';
    return text;
}

/* ---- the bus ---- */

static struct rig *rig;
static sd_event *event;
static struct iso_bus *service;
static sd_bus *bus; /* the bus's end of the connection */
static int listener = -1;
static char address[64];
static pthread_mutex_t bus_lock = PTHREAD_MUTEX_INITIALIZER;
static pthread_t bus_thread;
static bool bus_ends;
static unsigned asked, answered;

static int reply_u(sd_bus_message *call, uint32_t value)
{
    return sd_bus_reply_method_return(call, "u", value);
}

/* Answers the calls to the bus itself, and counts the service's answers. */
static int on_message(sd_bus_message *message, void *context, sd_bus_error *error)
{
    uint8_t type = 0;
    (void)context;
    (void)error;
    (void)sd_bus_message_get_type(message, &type);
    if (type == SD_BUS_MESSAGE_METHOD_RETURN || type == SD_BUS_MESSAGE_METHOD_ERROR) {
        (void)__atomic_add_fetch(&answered, 1, __ATOMIC_ACQ_REL);
        return 1;
    }
    if (type != SD_BUS_MESSAGE_METHOD_CALL) {
        return 1;
    }
    if (sd_bus_message_is_method_call(message, NULL, "Hello")) {
        return sd_bus_reply_method_return(message, "s", ":1.1");
    }
    if (sd_bus_message_is_method_call(message, NULL, "RequestName")) {
        return reply_u(message, 1);
    }
    if (sd_bus_message_is_method_call(message, NULL, "GetNameOwner")) {
        return sd_bus_reply_method_return(message, "s", ":1.9");
    }
    return sd_bus_reply_method_return(message, NULL);
}

/* The bus has a thread of its own: the service waits for some of its answers. */
static void *play_bus(void *context)
{
    (void)context;
    const int fd = accept(listener, NULL, NULL);
    sd_id128_t id;
    fuzz_check(fd >= 0 && sd_id128_randomize(&id) >= 0, "a connection");
    (void)pthread_mutex_lock(&bus_lock);
    fuzz_check(sd_bus_new(&bus) >= 0 && sd_bus_set_fd(bus, fd, fd) >= 0 &&
                   sd_bus_set_server(bus, 1, id) >= 0 && sd_bus_set_anonymous(bus, 1) >= 0 &&
                   sd_bus_set_trusted(bus, 1) >= 0 &&
                   sd_bus_add_filter(bus, NULL, on_message, NULL) >= 0 && sd_bus_start(bus) >= 0,
               "a bus");
    (void)pthread_mutex_unlock(&bus_lock);
    while (!__atomic_load_n(&bus_ends, __ATOMIC_ACQUIRE)) {
        struct pollfd readable = {.fd = fd, .events = POLLIN};
        (void)poll(&readable, 1, 1);
        (void)pthread_mutex_lock(&bus_lock);
        while (sd_bus_process(bus, NULL) > 0) {
        }
        (void)pthread_mutex_unlock(&bus_lock);
    }
    return NULL;
}

static bool all_answered(void)
{
    return __atomic_load_n(&answered, __ATOMIC_ACQUIRE) == asked;
}

/* Runs the service until it has handled all messages, but at least once. */
static void go_round(void)
{
    for (int i = 0; i < 5000; i++) {
        if (sd_event_run(event, all_answered() ? 0 : 1000) <= 0 && all_answered()) {
            break;
        }
    }
    fuzz_check(!iso_bus_is_gone(service), "the service stays on the bus");
}

static void on_line(void *context, int priority, const char *text)
{
    (void)context;
    (void)priority;
    (void)text;
}

static void listen_somewhere(void)
{
    struct sockaddr_un name = {.sun_family = AF_UNIX};
    const int length = snprintf(name.sun_path + 1, sizeof name.sun_path - 1, "isotherm-fuzz-%d",
                                (int)getpid());
    listener = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    (void)snprintf(address, sizeof address, "unix:abstract=%s", name.sun_path + 1);
    fuzz_check(listener >= 0 &&
                   bind(listener, (const struct sockaddr *)&name,
                        (socklen_t)(offsetof(struct sockaddr_un, sun_path) + 1 + (size_t)length)) ==
                       0 &&
                   listen(listener, 4) == 0,
               "a socket");
}

static void tear_down_at_exit(void);

static void set_up(void)
{
    struct iso_fault fault = {.text = ""};
    void *state = NULL;
    if (listener < 0) {
        listen_somewhere();
        fuzz_check(atexit(tear_down_at_exit) == 0, "an exit handler");
    }
    fuzz_check(rig_setup(&state) == 0 && sd_event_new(&event) >= 0, "a rig");
    rig = state;
    bus_ends = false;
    fuzz_check(pthread_create(&bus_thread, NULL, play_bus, NULL) == 0, "a thread");
    fuzz_check(iso_bus_open(address, &service, &fault) == 0, fault.text);
    iso_appliance_free(rig->appliance);
    rig->borrowed.events = iso_bus_events(service, on_line);
    fuzz_check(iso_appliance_new(&rig->borrowed, &rig->appliance) == 0, "an appliance");
    rig_start(rig);
    fuzz_check(iso_bus_serve(service, rig->appliance, &rig->borrowed, event, &fault) == 0,
               fault.text);
}

static void tear_down(void)
{
    void *state = rig;
    iso_bus_close(service);
    __atomic_store_n(&bus_ends, true, __ATOMIC_RELEASE);
    fuzz_check(pthread_join(bus_thread, NULL) == 0, "the end of the thread");
    sd_bus_flush_close_unref(bus);
    sd_event_unref(event);
    fuzz_check(rig_teardown(&state) == 0, "the end of the rig");
    rig = NULL;
    bus = NULL;
}

/* The leak sanitizer does not search the memory of keys for pointers: everything must be freed. */
static void tear_down_at_exit(void)
{
    if (rig) {
        tear_down();
    }
}

/* ---- clients ---- */

static int append_value(sd_bus_message *message, struct input *input, char type);

static int append_options(sd_bus_message *message, struct input *input)
{
    static const char types[] = "bxsdutby";
    int r = sd_bus_message_open_container(message, 'a', "{sv}");
    for (uint64_t n = take(input, 1) % 5; r >= 0 && n > 0; n--) {
        const char type[2] = {types[take(input, 1) % (sizeof types - 1)], '\0'};
        r = sd_bus_message_open_container(message, 'e', "sv");
        r = r < 0 ? r : sd_bus_message_append(message, "s", take_text(input));
        r = r < 0 ? r : sd_bus_message_open_container(message, 'v', type);
        r = r < 0 ? r : append_value(message, input, type[0]);
        r = r < 0 ? r : sd_bus_message_close_container(message);
        r = r < 0 ? r : sd_bus_message_close_container(message);
    }
    return r < 0 ? r : sd_bus_message_close_container(message);
}

static int append_value(sd_bus_message *message, struct input *input, char type)
{
    union {
        uint64_t whole;
        double real;
    } value;
    switch (type) {
    case 's':
        return sd_bus_message_append(message, "s", take_text(input));
    case 'a':
        return append_options(message, input);
    case 'b':
        return sd_bus_message_append(message, "b", (int)(take(input, 1) & 1));
    case 'u':
        return sd_bus_message_append(message, "u", (uint32_t)take(input, 4));
    case 'y':
        return sd_bus_message_append(message, "y", (int)take(input, 1));
    case 'd':
        value.whole = take(input, 8);
        return sd_bus_message_append(message, "d", value.real);
    default:
        value.whole = take(input, 8);
        return sd_bus_message_append(message, type == 't' ? "t" : "x", value.whole);
    }
}

static const struct {
    const char *name, *types;
} methods[] = {{ISO_CONTRACT_CLAIM, ""},
               {ISO_CONTRACT_RELEASE, ""},
               {ISO_CONTRACT_ENROLL_START, "sa"},
               {ISO_CONTRACT_ENROLL_STOP, ""},
               {ISO_CONTRACT_VERIFY_START, "s"},
               {ISO_CONTRACT_VERIFY_STOP, ""},
               {ISO_CONTRACT_IDENTIFY_START, ""},
               {ISO_CONTRACT_IDENTIFY_STOP, ""},
               {ISO_CONTRACT_LIST_PEOPLE, ""},
               {ISO_CONTRACT_DELETE_PERSON, "s"},
               {ISO_CONTRACT_GET_STATUS, ""},
               {ISO_CONTRACT_READ_LOG, "tu"},
               {ISO_CONTRACT_CLEAR_LOCKOUT, ""},
               {ISO_CONTRACT_SET_LOCKDOWN, "b"},
               {ISO_CONTRACT_AIM_START, ""},
               {ISO_CONTRACT_AIM_STOP, ""},
               {ISO_CONTRACT_PICTURE, ""},
               {"Introspect", ""},
               {"NoSuchMethod", "s"},
               {ISO_CONTRACT_SET_VALIDITY, "sa"},
               {ISO_CONTRACT_RENAME_PERSON, "ss"},
               {ISO_CONTRACT_GET_SETTINGS, ""},
               {ISO_CONTRACT_SET_SETTING, "sss"},
               {ISO_CONTRACT_RESET_SETTING, "ss"}};

/* Sends a call from one of the clients. The caller holds bus_lock. */
static void call(struct input *input)
{
    uint64_t number; /* without room for this, sd_bus_send() asks for no answer */
    static const char *const clients[] = {":1.7", ":1.8", ":1.9", ""};
    static const char odd_types[] = "subxtdya";
    const size_t method = take(input, 1) % (sizeof methods / sizeof *methods);
    const uint64_t how = take(input, 1);
    const char *client = clients[how & 3];
    const char *types = methods[method].types;
    char others[4] = "";
    sd_bus_message *message = NULL;
    if (how >> 2 == 1) { /* arguments of wrong types */
        for (size_t i = 0; i + 1 < sizeof others; i++) {
            others[i] = odd_types[take(input, 1) % (sizeof odd_types - 1)];
        }
        types = others;
    }
    int r = sd_bus_message_new_method_call(bus, &message, ":1.1", ISO_CONTRACT_PATH,
                                           strcmp(methods[method].name, "Introspect") == 0
                                               ? "org.freedesktop.DBus.Introspectable"
                                               : ISO_CONTRACT_INTERFACE,
                                           methods[method].name);
    for (; r >= 0 && *types; types++) {
        r = append_value(message, input, *types);
    }
    r = r < 0 || !*client ? r : sd_bus_message_set_sender(message, client);
    if (r >= 0) {
        asked++;
        fuzz_check(sd_bus_send(bus, message, &number) >= 0, "a call that is sent");
    }
    sd_bus_message_unref(message);
}

/* Tells the service that a client has left the bus. The caller holds bus_lock. */
static void leave(struct input *input)
{
    uint64_t number;
    static const char *const clients[] = {":1.7", ":1.8", ":1.9"};
    sd_bus_message *signal = NULL;
    const char *name = clients[take(input, 1) % 3];
    int r = sd_bus_message_new_signal(bus, &signal, "/org/freedesktop/DBus", "org.freedesktop.DBus",
                                      "NameOwnerChanged");
    r = r < 0 ? r : sd_bus_message_append(signal, "sss", name, name, "");
    r = r < 0 ? r : sd_bus_message_set_sender(signal, "org.freedesktop.DBus");
    fuzz_check(r >= 0, "a signal");
    fuzz_check(sd_bus_send(bus, signal, &number) >= 0, "a signal that is sent");
    sd_bus_message_unref(signal);
}

static void with_bus(void (*act)(struct input *input), struct input *input)
{
    (void)pthread_mutex_lock(&bus_lock);
    act(input);
    (void)pthread_mutex_unlock(&bus_lock);
}

/* While the door is in service, frames would open it for the enrolled person, so there are no
 * frames then. */
static void show(struct input *input)
{
    if (iso_appliance_status(rig->appliance).mode > ISO_APPLIANCE_CLAIMED) {
        rig_show(rig, 50 + (int)take(input, 1) % 16, 1);
        rig_run(rig, 40);
    }
}

static void forget_everything(void)
{
    struct iso_fault fault;
    const struct iso_person *people;
    size_t n = 0;
    static const uint8_t all[] = {0, 1, 2};
    for (size_t i = 0; i < sizeof all; i++) {
        struct input one = {&all[i], 1};
        with_bus(leave, &one);
    }
    go_round();
    fuzz_check(iso_appliance_status(rig->appliance).mode == ISO_APPLIANCE_WATCH,
               "a client that leaves releases the camera");
    while ((people = iso_gallery_people(rig->gallery, &n)) && n > 0) {
        fuzz_check(iso_gallery_remove(rig->gallery, people[0].name, &fault) == 0, fault.text);
    }
    fuzz_check(iso_appliance_lockdown(rig->appliance, false, &fault) == 0 &&
                   iso_appliance_clear_lockout(rig->appliance, &fault) == 0,
               fault.text);
    rig_run(rig, 10000);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static int inputs;
    struct input input = {data, size};
    if (!rig) {
        set_up();
    }
    asked = answered = 0;
    for (int i = 0; input.size > 0 && i < VALUES_MAX; i++) {
        const uint64_t what = take(&input, 1) % 8;
        if (what == 0) {
            with_bus(leave, &input);
        } else if (what == 1) {
            rig_run(rig, (int64_t)take(&input, 2));
        } else if (what <= 3) {
            show(&input);
        } else {
            with_bus(call, &input);
        }
        go_round();
        fuzz_check(!rig_relay(rig), "no call opens the door");
    }
    forget_everything(); /* also ends a call to Picture(), which waits for the next frame */
    fuzz_check(all_answered(), "every call is answered once");
    if (++inputs % INPUTS_A_RIG == 0) {
        tear_down();
    }
    return 0;
}
