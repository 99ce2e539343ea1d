#include "tests/firmware/fleet/link/bus_service.h"

#include <errno.h>
#include <signal.h>
#include <sodium.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <systemd/sd-bus.h>
#include <unistd.h>

#include "firmware/contract/bus_connect.h"
#include "firmware/contract/contract.h"
#include "firmware/fleet/message/membership.h"
#include "tests/firmware/rigs/cmocka_headers.h"

static struct fake_daemon served;
static struct iso_link_daemon calls;
static bool is_member;

/* ---- GetFleet ---- */

static int add_zones(sd_bus_message *reply)
{
    int r = sd_bus_message_open_container(reply, 'e', "sv");

    r = r < 0 ? r : sd_bus_message_append(reply, "s", ISO_CONTRACT_FLEET_ZONES);
    r = r < 0 ? r : sd_bus_message_open_container(reply, 'v', "a(sttsb)");
    r = r < 0 ? r : sd_bus_message_open_container(reply, 'a', "(sttsb)");
    for (size_t i = 0; r >= 0 && i < served.n; i++) {
        const struct fake_zone *zone = &served.zones[i];
        char id[ISO_FLEET_ID_TEXT_SIZE], digest[65];
        (void)sodium_bin2hex(digest, sizeof digest, zone->place.digest, 32);
        r = sd_bus_message_append(reply, "(sttsb)", iso_fleet_id_text(&zone->place.zone, id),
                                  zone->place.epoch, zone->place.sequence, digest,
                                  (int)zone->wants_snapshot);
    }
    r = r < 0 ? r : sd_bus_message_close_container(reply);
    r = r < 0 ? r : sd_bus_message_close_container(reply);
    return r < 0 ? r : sd_bus_message_close_container(reply);
}

static int add_state(sd_bus_message *reply)
{
    char id[ISO_FLEET_ID_TEXT_SIZE], signs[65];
    int r;

    (void)sodium_bin2hex(signs, sizeof signs, served.hub_signs, 32);
    r = sd_bus_message_append(
        reply, "{sv}{sv}{sv}{sv}{sv}{sv}{sv}{sv}{sv}{sv}", ISO_CONTRACT_FLEET_DOOR, "s",
        iso_fleet_id_text(&served.door, id), ISO_CONTRACT_FLEET_DOOR_NAME, "s", "East",
        ISO_CONTRACT_FLEET_HUB_NAME, "s", "Works", ISO_CONTRACT_FLEET_HUB_SIGNS, "s", signs,
        ISO_CONTRACT_FLEET_LEASE, "s", "held", ISO_CONTRACT_FLEET_LEASE_LEFT, "x", (int64_t)1234,
        ISO_CONTRACT_FLEET_LAST_EVENT, "t", served.last_event, ISO_CONTRACT_FLEET_ACKED, "t",
        served.acked, ISO_CONTRACT_FLEET_PENDING, "u", (uint32_t)3, ISO_CONTRACT_FLEET_BEHIND, "b",
        1);
    r = r < 0 ? r
              : sd_bus_message_append(reply, "{sv}{sv}{sv}", ISO_CONTRACT_FLEET_LEASE_S, "u",
                                      served.lease_s, ISO_CONTRACT_FLEET_FAULT, "s",
                                      "the policy is too large", "of-a-later-version", "s", "x");
    return r < 0 ? r : add_zones(reply);
}

static int get_fleet(sd_bus_message *call, void *context, sd_bus_error *error)
{
    sd_bus_message *reply = NULL;
    int r = sd_bus_message_new_method_return(call, &reply);

    (void)context;
    (void)error;
    r = r < 0 ? r : sd_bus_message_open_container(reply, 'a', "{sv}");
    r = r < 0 || !is_member ? r : add_state(reply);
    r = r < 0 ? r : sd_bus_message_close_container(reply);
    r = r < 0 ? r : sd_bus_send(NULL, reply, NULL);
    sd_bus_message_unref(reply);
    return r;
}

/* ---- the other methods ---- */

static int reply_bytes(sd_bus_message *call, struct iso_fleet_bytes *bytes)
{
    sd_bus_message *reply = NULL;
    int r = sd_bus_message_new_method_return(call, &reply);

    r = r < 0 ? r : sd_bus_message_append_array(reply, 'y', bytes->bytes, bytes->size);
    r = r < 0 ? r : sd_bus_send(NULL, reply, NULL);
    sd_bus_message_unref(reply);
    iso_fleet_bytes_free(bytes);
    return r;
}

static int reply_outcome(sd_bus_message *call, const struct iso_link_outcome *outcome)
{
    static const char *const words[] = ISO_CONTRACT_FLEET_WORDS;
    char id[ISO_FLEET_ID_TEXT_SIZE] = "";

    if (!iso_fleet_id_is_zero(&outcome->zone)) {
        (void)iso_fleet_id_text(&outcome->zone, id);
    }
    return sd_bus_reply_method_return(call, "ss", words[outcome->outcome], id);
}

static int question(sd_bus_message *call, void *context, sd_bus_error *error)
{
    struct iso_fleet_bytes bytes = {.bytes = NULL};
    const int r = calls.question(calls.context, &bytes, NULL);

    (void)context;
    (void)error;
    (void)sd_bus_emit_signal(sd_bus_message_get_bus(call), ISO_CONTRACT_PATH,
                             ISO_CONTRACT_INTERFACE, ISO_CONTRACT_FLEET_WORK, "s", "events");
    return r < 0 ? r : reply_bytes(call, &bytes);
}

static int receive(sd_bus_message *call, void *context, sd_bus_error *error)
{
    struct iso_link_outcome outcome;
    const void *bytes;
    size_t size;
    int r = sd_bus_message_read_array(call, 'y', &bytes, &size);

    (void)context;
    (void)error;
    r = r < 0 ? r : calls.receive(calls.context, bytes, size, &outcome, NULL);
    return r < 0 ? r : reply_outcome(call, &outcome);
}

static int fetch(sd_bus_message *call, void *context, sd_bus_error *error)
{
    struct iso_fleet_bytes bytes = {.bytes = NULL};
    struct iso_fleet_id id;
    const char *zone, *what;
    int r = sd_bus_message_read(call, "ss", &zone, &what);

    (void)context;
    if (r < 0 || iso_fleet_id_read(zone, &id) < 0) {
        return sd_bus_error_set(error, ISO_CONTRACT_ERROR_INVALID_ARGUMENT, "no zone");
    }
    r = calls.fetch(calls.context, &id,
                    strcmp(what, "snapshot") == 0 ? ISO_FLEET_WANT_SNAPSHOT : ISO_FLEET_WANT_DELTAS,
                    &bytes, NULL);
    return r < 0 ? r : reply_bytes(call, &bytes);
}

static int snapshot(sd_bus_message *call, void *context, sd_bus_error *error)
{
    struct iso_link_outcome outcome;
    int fd = -1;
    int r = sd_bus_message_read(call, "h", &fd);

    (void)context;
    (void)error;
    r = r < 0 ? r : calls.snapshot(calls.context, fd, &outcome, NULL);
    return r < 0 ? r : reply_outcome(call, &outcome);
}

static int events(sd_bus_message *call, void *context, sd_bus_error *error)
{
    struct iso_fleet_bytes bytes = {.bytes = NULL};
    sd_bus_message *reply = NULL;
    uint64_t after, last = 0;
    uint32_t most;
    int r = sd_bus_message_read(call, "tu", &after, &most);

    (void)context;
    (void)error;
    r = r < 0 ? r : calls.events(calls.context, after, most, &bytes, &last, NULL);
    r = r < 0 ? r : sd_bus_message_new_method_return(call, &reply);
    r = r < 0 ? r : sd_bus_message_append_array(reply, 'y', bytes.bytes, bytes.size);
    r = r < 0 ? r : sd_bus_message_append(reply, "t", last);
    r = r < 0 ? r : sd_bus_send(NULL, reply, NULL);
    sd_bus_message_unref(reply);
    iso_fleet_bytes_free(&bytes);
    return r;
}

static void append_request(void *context, const void *bytes, size_t size)
{
    (void)sd_bus_message_append_array(context, 'y', bytes, size);
}

static int requests(sd_bus_message *call, void *context, sd_bus_error *error)
{
    sd_bus_message *reply = NULL;
    int r = sd_bus_message_new_method_return(call, &reply);

    (void)context;
    (void)error;
    r = r < 0 ? r : sd_bus_message_open_container(reply, 'a', "ay");
    r = r < 0 ? r : calls.requests(calls.context, append_request, reply, NULL);
    r = r < 0 ? r : sd_bus_message_close_container(reply);
    r = r < 0 ? r : sd_bus_send(NULL, reply, NULL);
    sd_bus_message_unref(reply);
    return r;
}

static int get_address(sd_bus_message *call, void *context, sd_bus_error *error)
{
    char text[129];

    (void)context;
    (void)error;
    (void)sodium_bin2hex(text, 65, served.signer.public, 32);
    (void)sodium_bin2hex(text + 64, 65, served.receiver.public, 32);
    return sd_bus_reply_method_return(call, "s", text);
}

static int join(sd_bus_message *call, void *context, sd_bus_error *error)
{
    struct iso_fleet_membership membership;
    const void *bytes;
    size_t size;
    const int r = sd_bus_message_read_array(call, 'y', &bytes, &size);

    (void)context;
    if (is_member || r < 0 || iso_fleet_read_membership(bytes, size, &membership) < 0 ||
        memcmp(membership.door_signs, served.signer.public, 32) != 0) {
        return sd_bus_error_set(error, ISO_CONTRACT_ERROR_REJECTED, "the membership is not mine");
    }
    served.door = membership.door;
    memcpy(served.hub_signs, membership.hub_signs, 32);
    is_member = true;
    return sd_bus_reply_method_return(call, NULL);
}

static int leave(sd_bus_message *call, void *context, sd_bus_error *error)
{
    (void)context;
    (void)error;
    is_member = false;
    return sd_bus_reply_method_return(call, NULL);
}

static const sd_bus_vtable table[] = {
    SD_BUS_VTABLE_START(0),
    SD_BUS_METHOD(ISO_CONTRACT_GET_FLEET, "", "a{sv}", get_fleet, 0),
    SD_BUS_METHOD(ISO_CONTRACT_FLEET_JOIN, "ay", "", join, 0),
    SD_BUS_METHOD(ISO_CONTRACT_FLEET_LEAVE, "", "", leave, 0),
    SD_BUS_METHOD(ISO_CONTRACT_FLEET_QUESTION, "", "ay", question, 0),
    SD_BUS_METHOD(ISO_CONTRACT_FLEET_RECEIVE, "ay", "ss", receive, 0),
    SD_BUS_METHOD(ISO_CONTRACT_FLEET_FETCH, "ss", "ay", fetch, 0),
    SD_BUS_METHOD(ISO_CONTRACT_FLEET_SNAPSHOT, "h", "ss", snapshot, 0),
    SD_BUS_METHOD(ISO_CONTRACT_FLEET_EVENTS, "tu", "ayt", events, 0),
    SD_BUS_METHOD(ISO_CONTRACT_FLEET_REQUESTS, "", "aay", requests, 0),
    SD_BUS_METHOD(ISO_CONTRACT_GET_ADDRESS, "", "s", get_address, 0),
    SD_BUS_SIGNAL(ISO_CONTRACT_FLEET_WORK, "s", 0),
    SD_BUS_VTABLE_END,
};

static int serve(const char *address)
{
    sd_bus *bus = NULL;
    int r = iso_bus_connect(address, &bus);

    r = r < 0 ? r
              : sd_bus_add_object_vtable(bus, NULL, ISO_CONTRACT_PATH, ISO_CONTRACT_INTERFACE,
                                         table, NULL);
    r = r < 0 ? r : sd_bus_request_name(bus, ISO_CONTRACT_NAME, 0);
    while (r >= 0) {
        r = sd_bus_process(bus, NULL);
        r = r == 0 ? sd_bus_wait(bus, UINT64_MAX) : r;
    }
    return r;
}

pid_t bus_service_start(const char *address, const struct fake_daemon *from, bool member)
{
    const pid_t pid = fork();

    assert_true(pid >= 0);
    if (pid == 0) {
        (void)prctl(PR_SET_PDEATHSIG, SIGKILL);
        served = *from;
        is_member = member;
        calls = fake_daemon_calls(&served);
        (void)serve(address);
        _exit(1);
    }
    return pid;
}

void bus_service_stop(pid_t pid)
{
    (void)kill(pid, SIGKILL);
    (void)waitpid(pid, NULL, 0);
}
