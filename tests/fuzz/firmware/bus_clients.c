#include "tests/fuzz/firmware/bus_clients.h"

#include <string.h>
#include <unistd.h>

#include "firmware/contract/contract.h"
#include "firmware/contract/fleet_words.h"

/* Types of arguments that the signatures of the bus write with more than one character. */
enum { OPTIONS = 'a', BYTES = 'A', FILE_OF_BYTES = 'h' };

uint64_t bus_input_take(struct bus_input *input, size_t bytes)
{
    uint64_t value = 0;
    for (size_t i = 0; i < bytes && input->size > 0; i++) {
        value = value << 8 | *input->data++;
        input->size--;
    }
    return value;
}

/* Takes a known text, or up to 255 ASCII characters: D-Bus refuses texts that are not UTF-8. */
static const char *take_text(struct bus_input *input)
{
    static const char *const known[] = {
        "anna",      "bob",       ISO_CONTRACT_ALLOW_DUPLICATE,   ISO_CONTRACT_VALID_FROM,
        "decision",  "threshold", ISO_CONTRACT_VALID_UNTIL,       ISO_CONTRACT_EXPIRED,
        "-100",      "door",      ISO_CONTRACT_CONSENT,           "ANNA",
        "unlock_ms", "9000",      ISO_CONTRACT_FLEET_DELTAS_WORD, ISO_CONTRACT_FLEET_SNAPSHOT_WORD};
    static char text[256];
    const size_t length = bus_input_take(input, 1);
    if (length % 2 == 0) {
        return known[length / 2 % (sizeof known / sizeof *known)];
    }
    for (size_t i = 0; i < length; i++) {
        text[i] = (char)(1 + bus_input_take(input, 1) % 127);
    }
    text[length] = '\0';
    return text;
}

static int append_value(sd_bus_message *message, struct bus_input *input, char type);

static int append_options(sd_bus_message *message, struct bus_input *input)
{
    static const char types[] = "bxsdutby";
    int r = sd_bus_message_open_container(message, 'a', "{sv}");
    for (uint64_t n = bus_input_take(input, 1) % 5; r >= 0 && n > 0; n--) {
        const char type[2] = {types[bus_input_take(input, 1) % (sizeof types - 1)], '\0'};
        r = sd_bus_message_open_container(message, 'e', "sv");
        r = r < 0 ? r : sd_bus_message_append(message, "s", take_text(input));
        r = r < 0 ? r : sd_bus_message_open_container(message, 'v', type);
        r = r < 0 ? r : append_value(message, input, type[0]);
        r = r < 0 ? r : sd_bus_message_close_container(message);
        r = r < 0 ? r : sd_bus_message_close_container(message);
    }
    return r < 0 ? r : sd_bus_message_close_container(message);
}

static int append_value(sd_bus_message *message, struct bus_input *input, char type)
{
    union {
        uint64_t whole;
        double real;
    } value;
    switch (type) {
    case 's':
        return sd_bus_message_append(message, "s", take_text(input));
    case OPTIONS:
        return append_options(message, input);
    case 'b':
        return sd_bus_message_append(message, "b", (int)(bus_input_take(input, 1) & 1));
    case 'u':
        return sd_bus_message_append(message, "u", (uint32_t)bus_input_take(input, 4));
    case 'y':
        return sd_bus_message_append(message, "y", (int)bus_input_take(input, 1));
    case 'd':
        value.whole = bus_input_take(input, 8);
        return sd_bus_message_append(message, "d", value.real);
    default:
        value.whole = bus_input_take(input, 8);
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
               {ISO_CONTRACT_RESET_SETTING, "ss"},
               {ISO_CONTRACT_GET_FLEET, ""},
               {ISO_CONTRACT_FLEET_JOIN, "A"},
               {ISO_CONTRACT_FLEET_LEAVE, ""},
               {ISO_CONTRACT_FLEET_QUESTION, ""},
               {ISO_CONTRACT_FLEET_RECEIVE, "A"},
               {ISO_CONTRACT_FLEET_FETCH, "ss"},
               {ISO_CONTRACT_FLEET_SNAPSHOT, "h"},
               {ISO_CONTRACT_FLEET_EVENTS, "tu"},
               {ISO_CONTRACT_FLEET_REQUESTS, ""},
               {ISO_CONTRACT_FLEET_UPDATE, "sssss"},
               {ISO_CONTRACT_FLEET_FETCH_UPDATE, "st"}};

static int append_argument(sd_bus_message *message, struct door_rig *hub, struct bus_input *input,
                           char type)
{
    if (type == BYTES) {
        struct iso_fleet_bytes bytes = bus_hub_message(hub, input);
        const int r = sd_bus_message_append_array(message, 'y', bytes.bytes, bytes.size);
        iso_fleet_bytes_free(&bytes);
        return r;
    }
    if (type == FILE_OF_BYTES) {
        const int fd = bus_hub_file(hub, input);
        const int r = sd_bus_message_append(message, "h", fd); /* has its own copy */
        (void)close(fd);
        return r;
    }
    return append_value(message, input, type);
}

sd_bus_message *bus_clients_call(sd_bus *bus, struct door_rig *hub, struct bus_input *input)
{
    static const char *const clients[] = {":1.7", ":1.8", ":1.9", ""};
    static const char odd_types[] = "subxtdyaAh";
    const size_t method = bus_input_take(input, 1) % (sizeof methods / sizeof *methods);
    const uint64_t how = bus_input_take(input, 1);
    const char *client = clients[how & 3];
    const char *types = methods[method].types;
    char others[4] = "";
    sd_bus_message *message = NULL;
    if (how >> 2 == 1) { /* arguments of wrong types */
        for (size_t i = 0; i + 1 < sizeof others; i++) {
            others[i] = odd_types[bus_input_take(input, 1) % (sizeof odd_types - 1)];
        }
        types = others;
    }
    int r = sd_bus_message_new_method_call(bus, &message, ":1.1", ISO_CONTRACT_PATH,
                                           strcmp(methods[method].name, "Introspect") == 0
                                               ? "org.freedesktop.DBus.Introspectable"
                                               : ISO_CONTRACT_INTERFACE,
                                           methods[method].name);
    for (; r >= 0 && *types; types++) {
        r = append_argument(message, hub, input, *types);
    }
    r = r < 0 || !*client ? r : sd_bus_message_set_sender(message, client);
    return r < 0 ? sd_bus_message_unref(message) : message;
}

sd_bus_message *bus_clients_leave(sd_bus *bus, struct bus_input *input)
{
    static const char *const clients[] = {":1.7", ":1.8", ":1.9"};
    sd_bus_message *signal = NULL;
    const char *name = clients[bus_input_take(input, 1) % 3];
    int r = sd_bus_message_new_signal(bus, &signal, "/org/freedesktop/DBus", "org.freedesktop.DBus",
                                      "NameOwnerChanged");
    r = r < 0 ? r : sd_bus_message_append(signal, "sss", name, name, "");
    r = r < 0 ? r : sd_bus_message_set_sender(signal, "org.freedesktop.DBus");
    return r < 0 ? sd_bus_message_unref(signal) : signal;
}
