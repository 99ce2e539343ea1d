#include "sim/door/door_watch.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <systemd/sd-bus.h>
#include <time.h>

#include "firmware/contract/contract.h"

struct sim_door_watch {
    sd_bus *bus;
    struct sim_door_verdict verdict;
    bool locked, was_unlocked;
};

static int on_visit(sd_bus_message *signal, void *context, sd_bus_error *error)
{
    struct sim_door_watch *watch = context;
    struct sim_door_verdict *verdict = &watch->verdict;
    const char *word, *person, *reason, *door, *door_fault;

    (void)error;
    if (verdict->given) {
        return 0;
    }
    const int r = sd_bus_message_read(signal, "ssdduxsss", &word, &person, &verdict->score,
                                      &verdict->threshold, &verdict->frames, &verdict->latency_us,
                                      &reason, &door, &door_fault);
    if (r < 0) {
        return r;
    }
    verdict->given = true;
    verdict->allow = strcmp(word, "allow") == 0;
    (void)snprintf(verdict->person, sizeof verdict->person, "%s", person);
    (void)snprintf(verdict->reason, sizeof verdict->reason, "%s", reason);
    (void)snprintf(verdict->door, sizeof verdict->door, "%s", door);
    return 0;
}

static void set_state(struct sim_door_watch *watch, const char *state)
{
    watch->locked = strcmp(state, "locked") == 0;
    watch->was_unlocked |= !watch->locked;
}

static int on_door_changed(sd_bus_message *signal, void *context, sd_bus_error *error)
{
    const char *state, *cause;
    const int r = sd_bus_message_read(signal, "ss", &state, &cause);

    (void)error;
    if (r >= 0) {
        set_state(context, state);
    }
    return r < 0 ? r : 0;
}

static int call_get_status(struct sim_door_watch *watch, sd_bus_message **reply,
                           struct iso_fault *fault)
{
    sd_bus_error error = SD_BUS_ERROR_NULL;
    const int r = sd_bus_call_method(watch->bus, ISO_CONTRACT_NAME, ISO_CONTRACT_PATH,
                                     ISO_CONTRACT_INTERFACE, ISO_CONTRACT_GET_STATUS, &error, reply,
                                     NULL);
    if (r < 0) {
        const bool absent = sd_bus_error_has_name(&error, SD_BUS_ERROR_SERVICE_UNKNOWN);
        (void)iso_fault_set(fault, 0, "%s: %s", ISO_CONTRACT_NAME,
                            error.message ? error.message : strerror(-r));
        sd_bus_error_free(&error);
        return absent ? -ENOENT : r;
    }
    return 0;
}

/* Moves to the value of this key in the dictionary. Returns 1 if the reply is positioned there,
 * 0 if the key is missing, or the negative errno of the bus. */
static int find_key(sd_bus_message *reply, const char *key, const char *type)
{
    const char *name;
    int r = sd_bus_message_enter_container(reply, 'a', "{sv}");

    while (r >= 0 && (r = sd_bus_message_enter_container(reply, 'e', "sv")) > 0) {
        r = sd_bus_message_read_basic(reply, 's', &name);
        if (r >= 0 && strcmp(name, key) == 0) {
            r = sd_bus_message_enter_container(reply, 'v', type);
            return r < 0 ? r : 1;
        }
        r = r < 0 ? r : sd_bus_message_skip(reply, "v");
        r = r < 0 ? r : sd_bus_message_exit_container(reply);
    }
    return r;
}

/* Reads one value of GetStatus. The caller unrefs *reply, also after an error; a text in *value is
 * a part of the reply. */
static int get_status(struct sim_door_watch *watch, const char *key, char type,
                      sd_bus_message **reply, void *value, struct iso_fault *fault)
{
    int r = call_get_status(watch, reply, fault);

    if (r < 0) {
        return r;
    }
    r = find_key(*reply, key, (char[]){type, '\0'});
    r = r <= 0 ? r : sd_bus_message_read_basic(*reply, type, value);
    if (r <= 0) {
        return iso_fault_set(fault, -EBADMSG, "%s: GetStatus has no valid %s", ISO_CONTRACT_NAME,
                             key);
    }
    return 0;
}

int sim_door_watch_frames(struct sim_door_watch *watch, uint64_t *frames, struct iso_fault *fault)
{
    sd_bus_message *reply = NULL;
    const int r = get_status(watch, "frames", 't', &reply, frames, fault);

    sd_bus_message_unref(reply);
    return r;
}

static int read_door_state(struct sim_door_watch *watch, struct iso_fault *fault)
{
    sd_bus_message *reply = NULL;
    const char *state;
    const int r = get_status(watch, "door-state", 's', &reply, &state, fault);

    if (r == 0) {
        set_state(watch, state);
    }
    sd_bus_message_unref(reply);
    return r;
}

static int connect_bus(struct sim_door_watch *watch, const char *address)
{
    int r = sd_bus_new(&watch->bus);

    r = r < 0 ? r : sd_bus_set_address(watch->bus, address);
    r = r < 0 ? r : sd_bus_set_bus_client(watch->bus, 1);
    r = r < 0 ? r : sd_bus_start(watch->bus);
    r = r < 0 ? r
              : sd_bus_match_signal(watch->bus, NULL, ISO_CONTRACT_NAME, ISO_CONTRACT_PATH,
                                    ISO_CONTRACT_INTERFACE, ISO_CONTRACT_VISIT, on_visit, watch);
    return r < 0 ? r
                 : sd_bus_match_signal(watch->bus, NULL, ISO_CONTRACT_NAME, ISO_CONTRACT_PATH,
                                       ISO_CONTRACT_INTERFACE, ISO_CONTRACT_DOOR_CHANGED,
                                       on_door_changed, watch);
}

int sim_door_watch_open(const char *address, struct sim_door_watch **out, struct iso_fault *fault)
{
    struct sim_door_watch *watch = calloc(1, sizeof *watch);

    if (!watch) {
        return iso_fault_set(fault, -ENOMEM, "out of memory");
    }
    int r = connect_bus(watch, address);
    if (r < 0) {
        (void)iso_fault_set(fault, 0, "%s: %s", address, strerror(-r));
    } else {
        r = read_door_state(watch, fault);
    }
    if (r < 0) {
        sim_door_watch_close(watch);
        return r;
    }
    *out = watch;
    return 0;
}

void sim_door_watch_close(struct sim_door_watch *watch)
{
    if (watch) {
        sd_bus_flush_close_unref(watch->bus);
        free(watch);
    }
}

int sim_door_watch_step(struct sim_door_watch *watch, int64_t duration_ms, struct iso_fault *fault)
{
    int r = sd_bus_process(watch->bus, NULL);

    if (r == 0 && duration_ms > 0) {
        r = sd_bus_wait(watch->bus, (uint64_t)duration_ms * 1000);
        r = r == -EINTR ? 0 : r;
    }
    return r < 0 ? iso_fault_set(fault, r, "the bus has gone away: %s", strerror(-r)) : 0;
}

void sim_door_watch_reset(struct sim_door_watch *watch)
{
    watch->verdict = (struct sim_door_verdict){0};
    watch->was_unlocked = false;
}

struct sim_door_verdict sim_door_watch_verdict(const struct sim_door_watch *watch)
{
    return watch->verdict;
}

bool sim_door_watch_is_locked(const struct sim_door_watch *watch)
{
    return watch->locked;
}

bool sim_door_watch_was_unlocked(const struct sim_door_watch *watch)
{
    return watch->was_unlocked;
}
