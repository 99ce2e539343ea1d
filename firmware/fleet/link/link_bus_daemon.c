/* The functions of link_daemon.h, each a method of the bus. */
#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>

#include "firmware/fleet/link/link_bus_inner.h"

#define S_US UINT64_C(1000000)

static const uint64_t LIMIT_US = 25 * S_US;
static const uint64_t SNAPSHOT_LIMIT_US = 600 * S_US; /* a whole zone is stored */

/* ---- GetFleet ---- */

static bool read_digits(const char *text, uint8_t *out, size_t n)
{
    size_t read = 0;

    return strlen(text) == 2 * n && sodium_hex2bin(out, n, text, 2 * n, NULL, &read, NULL) == 0 &&
           read == n;
}

static int read_zones(sd_bus_message *reply, struct iso_link_status *out)
{
    int r = sd_bus_message_enter_container(reply, 'v', "a(sttsb)");

    r = r < 0 ? r : sd_bus_message_enter_container(reply, 'a', "(sttsb)");
    while (r >= 0) {
        const char *zone = NULL, *digest = NULL;
        struct iso_fleet_place place = {.epoch = 0};
        int wants = 0;
        r = sd_bus_message_read(reply, "(sttsb)", &zone, &place.epoch, &place.sequence, &digest,
                                &wants);
        if (r <= 0) {
            break;
        }
        if (out->n == ISO_FLEET_ZONES_MAX || iso_fleet_id_read(zone, &place.zone) < 0 ||
            !read_digits(digest, place.digest, sizeof place.digest)) {
            return -EBADMSG;
        }
        out->wants_snapshot[out->n] = wants != 0;
        out->places[out->n++] = place;
    }
    r = r < 0 ? r : sd_bus_message_exit_container(reply);
    return r < 0 ? r : sd_bus_message_exit_container(reply);
}

static int read_text(sd_bus_message *reply, char *out, size_t size)
{
    const char *text = NULL;
    const int r = sd_bus_message_read(reply, "v", "s", &text);

    if (r >= 0) {
        (void)snprintf(out, size, "%s", text);
    }
    return r;
}

static int read_id(sd_bus_message *reply, struct iso_fleet_id *out)
{
    const char *text = NULL;
    const int r = sd_bus_message_read(reply, "v", "s", &text);

    return r < 0 ? r : iso_fleet_id_read(text, out);
}

static int read_signs(sd_bus_message *reply, struct iso_link_status *out)
{
    const char *text = NULL;
    const int r = sd_bus_message_read(reply, "v", "s", &text);

    return r < 0 || read_digits(text, out->hub_signs, sizeof out->hub_signs) ? r : -EBADMSG;
}

static int read_behind(sd_bus_message *reply, bool *out)
{
    int value = 0;
    const int r = sd_bus_message_read(reply, "v", "b", &value);

    *out = value != 0;
    return r;
}

static int read_value(sd_bus_message *reply, const char *key, struct iso_link_status *out,
                      struct link_bus_lease *lease)
{
    if (strcmp(key, ISO_CONTRACT_FLEET_DOOR) == 0) {
        return read_id(reply, &out->door);
    }
    if (strcmp(key, ISO_CONTRACT_FLEET_HUB_SIGNS) == 0) {
        return read_signs(reply, out);
    }
    if (strcmp(key, ISO_CONTRACT_FLEET_LAST_EVENT) == 0) {
        return sd_bus_message_read(reply, "v", "t", &out->last_event);
    }
    if (strcmp(key, ISO_CONTRACT_FLEET_ACKED) == 0) {
        return sd_bus_message_read(reply, "v", "t", &out->acked);
    }
    if (strcmp(key, ISO_CONTRACT_FLEET_LEASE_S) == 0) {
        return sd_bus_message_read(reply, "v", "u", &out->lease_s);
    }
    if (strcmp(key, ISO_CONTRACT_FLEET_ZONES) == 0) {
        return read_zones(reply, out);
    }
    if (strcmp(key, ISO_CONTRACT_FLEET_LEASE) == 0) {
        return read_text(reply, lease->word, sizeof lease->word);
    }
    if (strcmp(key, ISO_CONTRACT_FLEET_LEASE_LEFT) == 0) {
        return sd_bus_message_read(reply, "v", "x", &lease->left_s);
    }
    if (strcmp(key, ISO_CONTRACT_FLEET_PENDING) == 0) {
        return sd_bus_message_read(reply, "v", "u", &lease->pending);
    }
    if (strcmp(key, ISO_CONTRACT_FLEET_BEHIND) == 0) {
        return read_behind(reply, &lease->is_hub_behind);
    }
    if (strcmp(key, ISO_CONTRACT_FLEET_FAULT) == 0) {
        return read_text(reply, lease->fault, sizeof lease->fault);
    }
    if (strcmp(key, ISO_CONTRACT_FLEET_DOOR_NAME) == 0) {
        return read_text(reply, lease->door_name, sizeof lease->door_name);
    }
    if (strcmp(key, ISO_CONTRACT_FLEET_HUB_NAME) == 0) {
        return read_text(reply, lease->hub_name, sizeof lease->hub_name);
    }
    return sd_bus_message_skip(reply, "v");
}

static int read_fleet(sd_bus_message *reply, struct iso_link_status *out,
                      struct link_bus_lease *lease)
{
    int r = sd_bus_message_enter_container(reply, 'a', "{sv}");

    while (r >= 0 && (r = sd_bus_message_enter_container(reply, 'e', "sv")) > 0) {
        const char *key = NULL;
        r = sd_bus_message_read(reply, "s", &key);
        r = r < 0 ? r : read_value(reply, key, out, lease);
        r = r < 0 ? r : sd_bus_message_exit_container(reply);
    }
    return r;
}

int link_bus_status(struct link_bus *bus, struct iso_link_status *out, struct link_bus_lease *lease,
                    struct iso_fault *fault)
{
    struct iso_link_status status = {.n = 0};
    struct link_bus_lease read = {.left_s = 0};
    sd_bus_message *reply = NULL;
    int r = link__bus_ask(bus, ISO_CONTRACT_GET_FLEET, &reply, fault);

    if (r < 0) {
        return r;
    }
    r = read_fleet(reply, &status, &read);
    sd_bus_message_unref(reply);
    if (r < 0) {
        return link__bus_bad_reply(r, fault);
    }
    if (iso_fleet_id_is_zero(&status.door)) {
        return iso_fault_set(fault, -ENOENT, "the door belongs to no fleet");
    }
    *out = status;
    if (lease) {
        *lease = read;
    }
    return 0;
}

static int get_status(void *context, struct iso_link_status *out, struct iso_fault *fault)
{
    return link_bus_status(context, out, NULL, fault);
}

/* ---- bytes and words ---- */

static int read_bytes(sd_bus_message *reply, struct iso_fleet_bytes *out)
{
    const void *bytes = NULL;
    size_t size = 0;
    const int r = sd_bus_message_read_array(reply, 'y', &bytes, &size);

    if (r >= 0 && size) {
        iso_fleet_put(out, bytes, size);
    }
    return r < 0 ? r : out->error;
}

/* Reads the bytes of a reply, which is released. */
static int finish_bytes(sd_bus_message *reply, struct iso_fleet_bytes *out, struct iso_fault *fault)
{
    struct iso_fleet_bytes bytes = {.bytes = NULL};
    const int r = read_bytes(reply, &bytes);

    sd_bus_message_unref(reply);
    if (r < 0) {
        iso_fleet_bytes_free(&bytes);
        return link__bus_bad_reply(r, fault);
    }
    *out = bytes;
    return 0;
}

static int finish_outcome(sd_bus_message *reply, struct iso_link_outcome *out,
                          struct iso_fault *fault)
{
    static const char *const words[] = ISO_CONTRACT_FLEET_WORDS;
    struct iso_link_outcome read = {.outcome = ISO_FLEET_OUTCOMES};
    const char *word = NULL, *zone = NULL;
    int r = sd_bus_message_read(reply, "ss", &word, &zone);

    for (unsigned i = 0; r >= 0 && i < ISO_FLEET_OUTCOMES; i++) {
        if (strcmp(word, words[i]) == 0) {
            read.outcome = (enum iso_fleet_outcome)i;
        }
    }
    if (r >= 0 && (read.outcome == ISO_FLEET_OUTCOMES ||
                   (zone[0] && iso_fleet_id_read(zone, &read.zone) < 0))) {
        r = -EBADMSG;
    }
    sd_bus_message_unref(reply);
    if (r < 0) {
        return link__bus_bad_reply(r, fault);
    }
    *out = read;
    return 0;
}

/* Sends a call whose arguments were appended with the result r. */
static int send(struct link_bus *bus, sd_bus_message *call, int r, uint64_t limit_us,
                sd_bus_message **reply, struct iso_fault *fault)
{
    if (r < 0) {
        sd_bus_message_unref(call);
        return iso_fault_set(fault, r, "a call of the daemon: %s", strerror(-r));
    }
    return link__bus_send(bus, call, limit_us, reply, fault);
}

/* ---- the methods ---- */

static int question(void *context, struct iso_fleet_bytes *out, struct iso_fault *fault)
{
    sd_bus_message *reply = NULL;
    const int r = link__bus_ask(context, ISO_CONTRACT_FLEET_QUESTION, &reply, fault);

    return r < 0 ? r : finish_bytes(reply, out, fault);
}

static int receive(void *context, const void *bytes, size_t size, struct iso_link_outcome *out,
                   struct iso_fault *fault)
{
    sd_bus_message *call = NULL, *reply = NULL;
    int r = link__bus_begin(context, ISO_CONTRACT_FLEET_RECEIVE, &call, fault);

    if (r < 0) {
        return r;
    }
    r = sd_bus_message_append_array(call, 'y', bytes, size);
    r = send(context, call, r, LIMIT_US, &reply, fault);
    return r < 0 ? r : finish_outcome(reply, out, fault);
}

static int fetch(void *context, const struct iso_fleet_id *zone, enum iso_fleet_wanted what,
                 struct iso_fleet_bytes *out, struct iso_fault *fault)
{
    char text[ISO_FLEET_ID_TEXT_SIZE];
    sd_bus_message *call = NULL, *reply = NULL;
    int r = link__bus_begin(context, ISO_CONTRACT_FLEET_FETCH, &call, fault);

    if (r < 0) {
        return r;
    }
    r = sd_bus_message_append(call, "ss", iso_fleet_id_text(zone, text),
                              what == ISO_FLEET_WANT_SNAPSHOT ? ISO_CONTRACT_FLEET_SNAPSHOT_WORD
                                                              : ISO_CONTRACT_FLEET_DELTAS_WORD);
    r = send(context, call, r, LIMIT_US, &reply, fault);
    return r < 0 ? r : finish_bytes(reply, out, fault);
}

static int fetch_update(void *context, const struct iso_fleet_id *rollout, uint64_t after,
                        struct iso_fleet_bytes *out, struct iso_fault *fault)
{
    char text[ISO_FLEET_ID_TEXT_SIZE];
    sd_bus_message *call = NULL, *reply = NULL;
    int r = link__bus_begin(context, ISO_CONTRACT_FLEET_FETCH_UPDATE, &call, fault);

    if (r < 0) {
        return r;
    }
    r = sd_bus_message_append(call, "st", iso_fleet_id_text(rollout, text), after);
    r = send(context, call, r, LIMIT_US, &reply, fault);
    return r < 0 ? r : finish_bytes(reply, out, fault);
}

static int update(void *context, const struct iso_fleet_update_report *report, bool *busy,
                  struct iso_fault *fault)
{
    char text[ISO_FLEET_ID_TEXT_SIZE];
    sd_bus_message *call = NULL, *reply = NULL;
    int is_busy = 0, r = link__bus_begin(context, ISO_CONTRACT_FLEET_UPDATE, &call, fault);

    if (r < 0) {
        return r;
    }
    r = sd_bus_message_append(call, "sssss", iso_fleet_update_state_word(report->state),
                              iso_fleet_id_text(&report->rollout, text), report->version,
                              report->board, report->fault);
    r = send(context, call, r, LIMIT_US, &reply, fault);
    if (r < 0) {
        return r;
    }
    r = sd_bus_message_read(reply, "b", &is_busy);
    *busy = is_busy;
    sd_bus_message_unref(reply);
    return r < 0 ? link__bus_bad_reply(r, fault) : 0;
}

static int snapshot(void *context, int fd, struct iso_link_outcome *out, struct iso_fault *fault)
{
    sd_bus_message *call = NULL, *reply = NULL;
    int r = link__bus_begin(context, ISO_CONTRACT_FLEET_SNAPSHOT, &call, fault);

    if (r < 0) {
        return r;
    }
    r = sd_bus_message_append(call, "h", fd);
    r = send(context, call, r, SNAPSHOT_LIMIT_US, &reply, fault);
    return r < 0 ? r : finish_outcome(reply, out, fault);
}

static int events(void *context, uint64_t after, uint32_t most, struct iso_fleet_bytes *out,
                  uint64_t *last, struct iso_fault *fault)
{
    struct iso_fleet_bytes bytes = {.bytes = NULL};
    sd_bus_message *call = NULL, *reply = NULL;
    uint64_t number = 0;
    int r = link__bus_begin(context, ISO_CONTRACT_FLEET_EVENTS, &call, fault);

    if (r < 0) {
        return r;
    }
    r = sd_bus_message_append(call, "tu", after, most);
    r = send(context, call, r, LIMIT_US, &reply, fault);
    if (r < 0) {
        return r;
    }
    r = read_bytes(reply, &bytes);
    r = r < 0 ? r : sd_bus_message_read(reply, "t", &number);
    sd_bus_message_unref(reply);
    if (r < 0) {
        iso_fleet_bytes_free(&bytes);
        return link__bus_bad_reply(r, fault);
    }
    *out = bytes;
    *last = number;
    return 0;
}

static int requests(void *context, void (*each)(void *context, const void *bytes, size_t size),
                    void *each_context, struct iso_fault *fault)
{
    sd_bus_message *reply = NULL;
    int r = link__bus_ask(context, ISO_CONTRACT_FLEET_REQUESTS, &reply, fault);

    if (r < 0) {
        return r;
    }
    r = sd_bus_message_enter_container(reply, 'a', "ay");
    while (r >= 0) {
        const void *bytes = NULL;
        size_t size = 0;
        r = sd_bus_message_read_array(reply, 'y', &bytes, &size);
        if (r <= 0) {
            break;
        }
        each(each_context, bytes, size);
    }
    sd_bus_message_unref(reply);
    return r < 0 ? link__bus_bad_reply(r, fault) : 0;
}

struct iso_link_daemon link_bus_daemon(struct link_bus *bus)
{
    return (struct iso_link_daemon){.context = bus,
                                    .status = get_status,
                                    .question = question,
                                    .receive = receive,
                                    .fetch = fetch,
                                    .snapshot = snapshot,
                                    .events = events,
                                    .requests = requests,
                                    .update = update,
                                    .fetch_update = fetch_update};
}
