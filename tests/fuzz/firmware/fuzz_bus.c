/* Calls on the message bus: the service of a whole appliance. The input decides what its clients
 * send: any method, with arguments of right or wrong types, from several names, while frames arrive
 * and time passes. One client has the messages of a hub, which the door may join. The door must
 * stay locked, and each call must be answered. */
#include <errno.h>
#include <poll.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <systemd/sd-bus.h>
#include <unistd.h>

#include "firmware/appliance/administration/administration.h"
#include "firmware/bus/bus.h"
#include "tests/firmware/rigs/rig.h"
#include "tests/fuzz/firmware/bus_clients.h"
#include "tests/fuzz/fuzz.h"

enum { INPUTS_A_RIG = 2000, VALUES_MAX = 64, ROUNDS_A_CALL = 50, ROUNDS_TO_END = 5000 };

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
static struct door_rig hub; /* which the door may join */

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
                   sd_bus_set_trusted(bus, 1) >= 0 && sd_bus_negotiate_fds(bus, 1) >= 0 &&
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

/* Runs the event loop until the service has answered all calls. The loop makes at least one round
 * and at most `rounds`. The service answers Picture() with the next frame, or when its claim ends;
 * within an input neither of them may happen. */
static void go_round(int rounds)
{
    for (int i = 0; i < rounds; i++) {
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

/* The hub of the door's keys. */
static void make_hub(void)
{
    struct iso_transfer_keys keys;
    iso_transfer_get_keys(rig->borrowed.ring, &keys);
    hub = (struct door_rig){.directory = rig->directory, .gallery = rig->gallery};
    memcpy(hub.door_signs.public, keys.signs, sizeof keys.signs);
    memcpy(hub.door_receives.public, keys.receives, sizeof keys.receives);
    hub.fleet = iso_appliance_fleet(rig->appliance);
    fuzz_check(hub.fleet != NULL, "a door that can belong to a fleet");
    door_rig_make_hub(&hub);
}

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
    make_hub();
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

/* Each takes a message from bus_clients.h and sends it. The caller holds bus_lock. */
static void call(struct bus_input *input)
{
    uint64_t number; /* without room for this, sd_bus_send() asks for no answer */
    sd_bus_message *message = bus_clients_call(bus, &hub, input);
    if (message) {
        asked++;
        fuzz_check(sd_bus_send(bus, message, &number) >= 0, "a call that is sent");
    }
    sd_bus_message_unref(message);
}

static void leave(struct bus_input *input)
{
    uint64_t number;
    sd_bus_message *signal = bus_clients_leave(bus, input);
    fuzz_check(signal && sd_bus_send(bus, signal, &number) >= 0, "a signal that is sent");
    sd_bus_message_unref(signal);
}

static void with_bus(void (*act)(struct bus_input *input), struct bus_input *input)
{
    (void)pthread_mutex_lock(&bus_lock);
    act(input);
    (void)pthread_mutex_unlock(&bus_lock);
}

/* While the door is in service, frames would open it for the enrolled person, so there are no
 * frames then. */
static void show(struct bus_input *input)
{
    if (iso_appliance_status(rig->appliance).mode > ISO_APPLIANCE_CLAIMED) {
        rig_show(rig, 50 + (int)bus_input_take(input, 1) % 16, 1);
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
        struct bus_input one = {&all[i], 1};
        with_bus(leave, &one);
    }
    go_round(ROUNDS_TO_END);
    fuzz_check(iso_appliance_status(rig->appliance).mode == ISO_APPLIANCE_WATCH,
               "a client that leaves releases the camera");
    const int left = iso_fleet_leave(hub.fleet, "fuzz", &fault);
    fuzz_check(left == 0 || left == -ENOENT, fault.text);
    for (size_t i = 0; i < sizeof hub.zone / sizeof *hub.zone; i++) {
        hub.zone[i].place = hub.zone[i].base; /* each input begins with a hub without changes */
    }
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
    struct bus_input input = {data, size};
    if (!rig) {
        set_up();
    }
    asked = answered = 0;
    for (int i = 0; input.size > 0 && i < VALUES_MAX; i++) {
        const uint64_t what = bus_input_take(&input, 1) % 8;
        if (what == 0) {
            with_bus(leave, &input);
        } else if (what == 1) {
            rig_run(rig, (int64_t)bus_input_take(&input, 2));
        } else if (what <= 3) {
            show(&input);
        } else {
            with_bus(call, &input);
        }
        go_round(ROUNDS_A_CALL);
        fuzz_check(!rig_relay(rig), "no call opens the door");
    }
    forget_everything(); /* also ends a call to Picture(), which waits for the next frame */
    fuzz_check(all_answered(), "every call is answered once");
    if (++inputs % INPUTS_A_RIG == 0) {
        tear_down();
    }
    return 0;
}
