/* The methods of isotherm-link (firmware/contract/fleet_words.h). The policy of the bus lets nobody
 * else call them but root. */
#include <errno.h>
#include <sodium.h>
#include <string.h>

#include "firmware/appliance/administration/administration.h"
#include "firmware/bus/bus_state.h"
#include "firmware/contract/contract.h"
#include "firmware/fleet/door/fleet.h"

enum { WHO_SIZE = 48, HEX_SIZE = 2 * ISO_FLEET_DIGEST_BYTES + 1 };

static int refuse(sd_bus_error *out, int error, const struct iso_fault *fault)
{
    switch (error) {
    case -ENOENT:
        return sd_bus_error_set(out, ISO_CONTRACT_ERROR_NO_FLEET, fault->text);
    case -EEXIST:
        return sd_bus_error_set(out, ISO_CONTRACT_ERROR_CONFLICT, fault->text);
    case -ENXIO:
        return sd_bus_error_set(out, ISO_CONTRACT_ERROR_INVALID_ARGUMENT, fault->text);
    default:
        return iso__bus_refuse(out, error, fault);
    }
}

/* The fleet, or NULL with the error of a gallery that cannot be read. */
static struct iso_fleet *fleet_of(const struct iso_bus *bus, sd_bus_error *out)
{
    struct iso_fleet *fleet = iso_appliance_fleet(bus->appliance);
    if (!fleet) {
        (void)sd_bus_error_set(out, ISO_CONTRACT_ERROR_STORAGE,
                               "it cannot be read whether the door belongs to a fleet");
    }
    return fleet;
}

/* ---- the state ---- */

static const char *hex(const uint8_t *bytes, size_t n, char text[HEX_SIZE])
{
    return sodium_bin2hex(text, HEX_SIZE, bytes, n);
}

static const char *lease_word(const struct iso_fleet_status *status)
{
    if (!status->lease_given) {
        return ISO_CONTRACT_FLEET_LEASE_NONE;
    }
    return status->lease_left_ns > 0 ? ISO_CONTRACT_FLEET_LEASE_HELD
                                     : ISO_CONTRACT_FLEET_LEASE_OVER;
}

static int append_zones(sd_bus_message *reply, const struct iso_fleet_status *status)
{
    char zone[ISO_FLEET_ID_TEXT_SIZE], digest[HEX_SIZE];
    int r = sd_bus_message_open_container(reply, 'e', "sv");
    r = r < 0 ? r : sd_bus_message_append(reply, "s", ISO_CONTRACT_FLEET_ZONES);
    r = r < 0 ? r : sd_bus_message_open_container(reply, 'v', "a(sttsb)");
    r = r < 0 ? r : sd_bus_message_open_container(reply, 'a', "(sttsb)");
    for (size_t i = 0; r >= 0 && i < status->n; i++) {
        const struct iso_fleet_place *place = &status->places[i];
        r = sd_bus_message_append(
            reply, "(sttsb)", iso_fleet_id_text(&place->zone, zone), place->epoch, place->sequence,
            hex(place->digest, sizeof place->digest, digest), (int)status->wants_snapshot[i]);
    }
    for (int depth = 0; r >= 0 && depth < 3; depth++) {
        r = sd_bus_message_close_container(reply);
    }
    return r;
}

static int append_fleet(sd_bus_message *reply, const struct iso_fleet_status *status)
{
    char door[ISO_FLEET_ID_TEXT_SIZE], signs[HEX_SIZE], door_name[ISO_FLEET_TITLE_SIZE],
        hub_name[ISO_FLEET_TITLE_SIZE], fault[300];
    const struct iso_fleet_membership *member = status->member;
    iso__bus_clean_text(door_name, sizeof door_name, member->door_name);
    iso__bus_clean_text(hub_name, sizeof hub_name, member->hub_name);
    iso__bus_clean_text(fault, sizeof fault, status->fault);
    int r = sd_bus_message_append(
        reply, "{sv}{sv}{sv}{sv}", ISO_CONTRACT_FLEET_DOOR, "s",
        iso_fleet_id_text(&member->door, door), ISO_CONTRACT_FLEET_DOOR_NAME, "s", door_name,
        ISO_CONTRACT_FLEET_HUB_NAME, "s", hub_name, ISO_CONTRACT_FLEET_HUB_SIGNS, "s",
        hex(member->hub_signs, sizeof member->hub_signs, signs));
    r = r < 0 ? r
              : sd_bus_message_append(reply, "{sv}{sv}{sv}{sv}{sv}", ISO_CONTRACT_FLEET_LEASE, "s",
                                      lease_word(status), ISO_CONTRACT_FLEET_LEASE_LEFT, "x",
                                      status->lease_left_ns / ISO_NS_PER_S,
                                      ISO_CONTRACT_FLEET_LEASE_S, "u", status->lease_s,
                                      ISO_CONTRACT_FLEET_LAST_EVENT, "t", status->last_event,
                                      ISO_CONTRACT_FLEET_ACKED, "t", status->acked);
    r = r < 0 ? r : append_zones(reply, status);
    return r < 0 ? r
                 : sd_bus_message_append(reply, "{sv}{sv}{sv}{sv}", ISO_CONTRACT_FLEET_PENDING, "u",
                                         status->pending, ISO_CONTRACT_FLEET_PEOPLE, "u",
                                         status->people, ISO_CONTRACT_FLEET_BEHIND, "b",
                                         (int)status->behind, ISO_CONTRACT_FLEET_FAULT, "s", fault);
}

int iso__bus_get_fleet(sd_bus_message *call, void *context, sd_bus_error *out)
{
    struct iso_fleet *fleet = fleet_of(context, out);
    struct iso_fleet_status status;
    struct iso_fault fault = {.text = ""};
    sd_bus_message *reply = NULL;
    const int error = fleet ? iso_fleet_get_status(fleet, &status, &fault) : -EIO;
    if (!fleet || (error && error != -ENOENT)) {
        return fleet ? refuse(out, error, &fault) : error;
    }
    int r = sd_bus_message_new_method_return(call, &reply);
    r = r < 0 ? r : sd_bus_message_open_container(reply, 'a', "{sv}");
    if (r >= 0 && !error) {
        r = append_fleet(reply, &status);
    }
    return iso__bus_send_reply(reply, r < 0 ? r : sd_bus_message_close_container(reply));
}

/* ---- belonging ---- */

int iso__bus_fleet_join(sd_bus_message *call, void *context, sd_bus_error *out)
{
    struct iso_fleet *fleet = fleet_of(context, out);
    struct iso_fault fault = {.text = ""};
    char who[WHO_SIZE];
    const void *bytes = NULL;
    size_t size = 0;
    int r = fleet ? sd_bus_message_read_array(call, 'y', &bytes, &size) : -EIO;
    if (r < 0) {
        return r;
    }
    iso__bus_describe_caller(call, who, sizeof who);
    r = iso_fleet_join(fleet, bytes, size, who, &fault);
    return r < 0 ? refuse(out, r, &fault) : sd_bus_reply_method_return(call, NULL);
}

int iso__bus_fleet_leave(sd_bus_message *call, void *context, sd_bus_error *out)
{
    struct iso_fleet *fleet = fleet_of(context, out);
    struct iso_fault fault = {.text = ""};
    char who[WHO_SIZE];
    if (!fleet) {
        return -EIO;
    }
    iso__bus_describe_caller(call, who, sizeof who);
    const int r = iso_fleet_leave(fleet, who, &fault);
    return r < 0 ? refuse(out, r, &fault) : sd_bus_reply_method_return(call, NULL);
}

/* ---- messages of the hub ---- */

static int reply_outcome(sd_bus_message *call, enum iso_fleet_outcome outcome,
                         const struct iso_fleet_id *zone)
{
    static const char *const words[ISO_FLEET_OUTCOMES] = ISO_CONTRACT_FLEET_WORDS;
    char text[ISO_FLEET_ID_TEXT_SIZE];
    return sd_bus_reply_method_return(call, "ss", words[outcome],
                                      iso_fleet_id_is_zero(zone) ? ""
                                                                 : iso_fleet_id_text(zone, text));
}

int iso__bus_fleet_receive(sd_bus_message *call, void *context, sd_bus_error *out)
{
    struct iso_fleet *fleet = fleet_of(context, out);
    struct iso_fault fault = {.text = ""};
    enum iso_fleet_outcome outcome = ISO_FLEET_REFUSED;
    struct iso_fleet_id zone;
    const void *bytes = NULL;
    size_t size = 0;
    int r = fleet ? sd_bus_message_read_array(call, 'y', &bytes, &size) : -EIO;
    if (r < 0) {
        return r;
    }
    r = iso_fleet_receive(fleet, bytes, size, &outcome, &zone, &fault);
    return r < 0 ? refuse(out, r, &fault) : reply_outcome(call, outcome, &zone);
}

int iso__bus_fleet_snapshot(sd_bus_message *call, void *context, sd_bus_error *out)
{
    struct iso_fleet *fleet = fleet_of(context, out);
    struct iso_fault fault = {.text = ""};
    enum iso_fleet_outcome outcome = ISO_FLEET_REFUSED;
    struct iso_fleet_id zone;
    int fd = -1; /* of the call */
    int r = fleet ? sd_bus_message_read(call, "h", &fd) : -EIO;
    if (r < 0) {
        return r;
    }
    r = iso_fleet_snapshot_file(fleet, fd, &outcome, &zone, &fault);
    return r < 0 ? refuse(out, r, &fault) : reply_outcome(call, outcome, &zone);
}

/* ---- messages for the hub ---- */

/* Begins a reply with bytes, which are freed. */
static int new_reply(sd_bus_message *call, struct iso_fleet_bytes *bytes, sd_bus_message **reply)
{
    int r = sd_bus_message_new_method_return(call, reply);
    r = r < 0 ? r : sd_bus_message_append_array(*reply, 'y', bytes->bytes, bytes->size);
    iso_fleet_bytes_free(bytes);
    return r;
}

int iso__bus_fleet_question(sd_bus_message *call, void *context, sd_bus_error *out)
{
    struct iso_fleet *fleet = fleet_of(context, out);
    struct iso_fault fault = {.text = ""};
    struct iso_fleet_bytes bytes = {.bytes = NULL};
    sd_bus_message *reply = NULL;
    const int r = fleet ? iso_fleet_question(fleet, &bytes, &fault) : -EIO;
    if (r < 0) {
        return fleet ? refuse(out, r, &fault) : r;
    }
    const int made = new_reply(call, &bytes, &reply);
    return iso__bus_send_reply(reply, made);
}

/* The word for what is to be fetched. -EINVAL it is none. */
static int read_wanted(const char *word, enum iso_fleet_wanted *what)
{
    const bool deltas = strcmp(word, ISO_CONTRACT_FLEET_DELTAS_WORD) == 0;
    *what = deltas ? ISO_FLEET_WANT_DELTAS : ISO_FLEET_WANT_SNAPSHOT;
    return deltas || strcmp(word, ISO_CONTRACT_FLEET_SNAPSHOT_WORD) == 0 ? 0 : -EINVAL;
}

int iso__bus_fleet_fetch(sd_bus_message *call, void *context, sd_bus_error *out)
{
    struct iso_fleet *fleet = fleet_of(context, out);
    struct iso_fault fault = {.text = ""};
    struct iso_fleet_bytes bytes = {.bytes = NULL};
    struct iso_fleet_id zone;
    enum iso_fleet_wanted what;
    const char *id, *word;
    sd_bus_message *reply = NULL;
    int r = fleet ? sd_bus_message_read(call, "ss", &id, &word) : -EIO;
    if (r < 0) {
        return r;
    }
    if (iso_fleet_id_read(id, &zone) || read_wanted(word, &what)) {
        return sd_bus_error_setf(out, ISO_CONTRACT_ERROR_INVALID_ARGUMENT,
                                 "'%.40s', '%.20s': no zone, or nothing that can be fetched", id,
                                 word);
    }
    r = iso_fleet_fetch(fleet, &zone, what, &bytes, &fault);
    if (r < 0) {
        return refuse(out, r, &fault);
    }
    r = new_reply(call, &bytes, &reply);
    return iso__bus_send_reply(reply, r);
}

/* Copies a text that must fit. */
static bool take(const char *text, char *out, size_t size)
{
    const size_t length = strlen(text);
    if (length < size) {
        memcpy(out, text, length + 1);
    }
    return length < size;
}

int iso__bus_fleet_update(sd_bus_message *call, void *context, sd_bus_error *out)
{
    struct iso_fleet *fleet = fleet_of(context, out);
    struct iso_fault fault = {.text = ""};
    struct iso_fleet_update_report report = {.is_known = true};
    const char *state, *rollout, *version, *board, *why;
    bool busy = false;
    int r = fleet ? sd_bus_message_read(call, "sssss", &state, &rollout, &version, &board, &why)
                  : -EIO;
    if (r < 0) {
        return r;
    }
    if (iso_fleet_update_state_read(state, &report.state) ||
        iso_fleet_id_read(rollout, &report.rollout) ||
        !take(version, report.version, sizeof report.version) ||
        !take(board, report.board, sizeof report.board) ||
        !take(why, report.fault, sizeof report.fault)) {
        return sd_bus_error_setf(out, ISO_CONTRACT_ERROR_INVALID_ARGUMENT,
                                 "'%.20s', '%.40s': no state of an update, or no rollout", state,
                                 rollout);
    }
    r = iso_fleet_set_update(fleet, &report, &busy, &fault);
    return r < 0 ? refuse(out, r, &fault) : sd_bus_reply_method_return(call, "b", (int)busy);
}

int iso__bus_fleet_fetch_update(sd_bus_message *call, void *context, sd_bus_error *out)
{
    struct iso_fleet *fleet = fleet_of(context, out);
    struct iso_fault fault = {.text = ""};
    struct iso_fleet_bytes bytes = {.bytes = NULL};
    struct iso_fleet_id rollout;
    const char *id;
    uint64_t after;
    sd_bus_message *reply = NULL;
    int r = fleet ? sd_bus_message_read(call, "st", &id, &after) : -EIO;
    if (r < 0) {
        return r;
    }
    if (iso_fleet_id_read(id, &rollout)) {
        return sd_bus_error_setf(out, ISO_CONTRACT_ERROR_INVALID_ARGUMENT, "'%.40s': no rollout",
                                 id);
    }
    r = iso_fleet_fetch_update(fleet, &rollout, after, &bytes, &fault);
    if (r < 0) {
        return refuse(out, r, &fault);
    }
    r = new_reply(call, &bytes, &reply);
    return iso__bus_send_reply(reply, r);
}

int iso__bus_fleet_events(sd_bus_message *call, void *context, sd_bus_error *out)
{
    struct iso_fleet *fleet = fleet_of(context, out);
    struct iso_fault fault = {.text = ""};
    struct iso_fleet_bytes bytes = {.bytes = NULL};
    sd_bus_message *reply = NULL;
    uint64_t after, last = 0;
    uint32_t most;
    int r = fleet ? sd_bus_message_read(call, "tu", &after, &most) : -EIO;
    if (r < 0) {
        return r;
    }
    r = iso_fleet_events(fleet, after, most, &bytes, &last, &fault);
    if (r < 0) {
        return refuse(out, r, &fault);
    }
    r = new_reply(call, &bytes, &reply);
    return iso__bus_send_reply(reply, r < 0 ? r : sd_bus_message_append(reply, "t", last));
}

/* A reply that gets one message after the other. */
struct requests {
    sd_bus_message *reply;
    int r;
};

static void append_request(void *context, const void *bytes, size_t size)
{
    struct requests *requests = context;
    if (requests->r >= 0) {
        requests->r = sd_bus_message_append_array(requests->reply, 'y', bytes, size);
    }
}

int iso__bus_fleet_requests(sd_bus_message *call, void *context, sd_bus_error *out)
{
    struct iso_fleet *fleet = fleet_of(context, out);
    struct iso_fault fault = {.text = ""};
    struct requests requests = {.reply = NULL};
    if (!fleet) {
        return -EIO;
    }
    requests.r = sd_bus_message_new_method_return(call, &requests.reply);
    if (requests.r >= 0) {
        requests.r = sd_bus_message_open_container(requests.reply, 'a', "ay");
    }
    const int error = requests.r < 0 ? requests.r
                                     : iso_fleet_requests(fleet, append_request, &requests, &fault);
    if (error < 0) {
        sd_bus_message_unref(requests.reply);
        return refuse(out, error, &fault);
    }
    return iso__bus_send_reply(requests.reply,
                               requests.r < 0 ? requests.r
                                              : sd_bus_message_close_container(requests.reply));
}

void iso__bus_on_fleet_work(void *context, const char *what)
{
    sd_bus_message *signal = NULL;
    int r = iso__bus_new_signal(context, ISO_CONTRACT_FLEET_WORK, &signal);
    r = r < 0 ? r : sd_bus_message_append(signal, "s", what);
    iso__bus_send_signal(signal, NULL, r);
}
