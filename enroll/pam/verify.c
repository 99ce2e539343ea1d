#include "enroll/pam/verify.h"

#include <errno.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <systemd/sd-bus.h>
#include <time.h>

#include "firmware/contract/bus_connect.h"
#include "firmware/contract/contract.h"

#define BUS_NAME      "org.freedesktop.DBus"
#define BUS_PATH      "/org/freedesktop/DBus"
#define RESULT_PREFIX "verify-"

enum { RETRY_MS = 250 };

/* One login. */
struct talk {
    const struct login_request *request;
    struct iso_fault *fault;
    sd_bus *bus;
    char owner[256];       /* the unique name of the daemon */
    sd_bus_message *reply; /* the answer to the call that is awaited; NULL: it has not come */
    bool gone;             /* the daemon has left the bus */
    bool begun;            /* the daemon looks for this login */
    bool ended;            /* the last status has come */
    char result[48];       /* its word, without the prefix */
};

static int64_t now_ms(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000 + now.tv_nsec / 1000000;
}

/* ---- waiting ---- */

/* Handles what the bus brings until the answer or the last status is there. -ETIMEDOUT, -ENOTCONN
 * the daemon has left, or an error of the connection. */
static int wait_until(struct talk *talk, bool (*is_there)(const struct talk *), int64_t end_ms)
{
    while (!is_there(talk)) {
        const int64_t left_ms = end_ms - now_ms();
        if (talk->gone) {
            return -ENOTCONN;
        }
        if (left_ms <= 0) {
            return -ETIMEDOUT;
        }
        int r = sd_bus_process(talk->bus, NULL);
        if (r == 0) {
            r = sd_bus_wait(talk->bus, (uint64_t)left_ms * 1000);
        }
        if (r < 0 && r != -EINTR) {
            return r;
        }
    }
    return 0;
}

static bool has_reply(const struct talk *talk)
{
    return talk->reply != NULL;
}

static bool has_ended(const struct talk *talk)
{
    return talk->ended;
}

static bool never(const struct talk *talk)
{
    (void)talk;
    return false;
}

static int on_reply(sd_bus_message *reply, void *context, sd_bus_error *unused)
{
    struct talk *talk = context;
    (void)unused;
    talk->reply = sd_bus_message_ref(reply);
    return 0;
}

/* Sends a call, and releases it, and waits for its answer, which talk->reply keeps. */
static int send_call(struct talk *talk, sd_bus_message *call, int limit_ms)
{
    sd_bus_slot *slot = NULL;
    talk->reply = sd_bus_message_unref(talk->reply);
    int r = sd_bus_call_async(talk->bus, &slot, call, on_reply, talk, (uint64_t)limit_ms * 1000);
    sd_bus_message_unref(call);
    if (r >= 0) {
        r = wait_until(talk, has_reply, now_ms() + limit_ms);
    }
    sd_bus_slot_unref(slot);
    return r;
}

/* Whether the answer is no error and comes from this sender. The bus passes on answers of others,
 * if its policy is a loose one. */
static bool is_answer_of(const struct talk *talk, const char *sender)
{
    const char *from = sd_bus_message_get_sender(talk->reply);
    return !sd_bus_message_is_method_error(talk->reply, NULL) && from && strcmp(from, sender) == 0;
}

/* ---- the daemon ---- */

/* Learns the unique name of the daemon. It is not started by the bus. */
static int find_daemon(struct talk *talk)
{
    sd_bus_message *call = NULL;
    const char *owner = NULL;
    int r = sd_bus_message_new_method_call(talk->bus, &call, BUS_NAME, BUS_PATH, BUS_NAME,
                                           "GetNameOwner");
    if (r >= 0) {
        r = sd_bus_message_append(call, "s", ISO_CONTRACT_NAME);
    }
    if (r < 0) {
        sd_bus_message_unref(call);
        return r;
    }
    r = send_call(talk, call, LOGIN_CONNECT_MS);
    if (r < 0) {
        return r;
    }
    if (!is_answer_of(talk, BUS_NAME) || sd_bus_message_read(talk->reply, "s", &owner) < 0 ||
        owner[0] != ':' || strlen(owner) >= sizeof talk->owner) {
        return -ENOENT;
    }
    (void)snprintf(talk->owner, sizeof talk->owner, "%s", owner);
    return 0;
}

static int on_status(sd_bus_message *signal, void *context, sd_bus_error *unused)
{
    static const char retry[] = ISO_CONTRACT_RESULT_RETRY;
    struct talk *talk = context;
    const char *sender = sd_bus_message_get_sender(signal), *word = NULL;
    int done = 0;
    (void)unused;
    if (!talk->begun || talk->ended || !sender || strcmp(sender, talk->owner) != 0 ||
        sd_bus_message_read(signal, "sb", &word, &done) < 0 ||
        strncmp(word, RESULT_PREFIX, strlen(RESULT_PREFIX)) != 0) {
        return 0;
    }
    word += strlen(RESULT_PREFIX);
    if (done) {
        talk->ended = true;
        (void)snprintf(talk->result, sizeof talk->result, "%s", word);
    } else if (strncmp(word, retry, sizeof retry - 1) == 0) {
        talk->request->hint(talk->request->context, word + sizeof retry - 1);
    }
    return 0;
}

static int on_owner_changed(sd_bus_message *signal, void *context, sd_bus_error *unused)
{
    struct talk *talk = context;
    const char *name = NULL, *old = NULL, *new = NULL;
    (void)unused;
    if (sd_bus_message_read(signal, "sss", &name, &old, &new) >= 0 &&
        strcmp(name, talk->owner) == 0 && !*new) {
        talk->gone = true;
    }
    return 0;
}

/* Listens to the daemon, and to the bus for its end. */
static int listen(struct talk *talk)
{
    char match[512];
    int r = sd_bus_match_signal_async(talk->bus, NULL, talk->owner, ISO_CONTRACT_PATH,
                                      ISO_CONTRACT_INTERFACE, ISO_CONTRACT_VERIFY_STATUS, on_status,
                                      NULL, talk);
    if (r < 0) {
        return r;
    }
    (void)snprintf(match, sizeof match,
                   "type='signal',sender='" BUS_NAME "',path='" BUS_PATH "',interface='" BUS_NAME
                   "',member='NameOwnerChanged',arg0='%s'",
                   talk->owner);
    return sd_bus_add_match_async(talk->bus, NULL, match, on_owner_changed, NULL, talk);
}

/* ---- the login ---- */

/* Asks the daemon to look. 1: it does. 0: talk->reply has its error. */
static int ask_to_look(struct talk *talk)
{
    const char *person = talk->request->person;
    sd_bus_message *call = NULL;
    uint32_t user = 0;
    int r = sd_bus_message_new_method_call(
        talk->bus, &call, talk->owner, ISO_CONTRACT_PATH, ISO_CONTRACT_INTERFACE,
        person ? ISO_CONTRACT_VERIFY_LOGIN : ISO_CONTRACT_VERIFY_SELF);
    if (r >= 0 && person) {
        r = sd_bus_message_append(call, "s", person);
    }
    if (r < 0) {
        sd_bus_message_unref(call);
        return r;
    }
    r = send_call(talk, call, LOGIN_ANSWER_MS);
    if (r < 0) {
        return r;
    }
    if (sd_bus_message_is_method_error(talk->reply, NULL)) {
        return 0;
    }
    if (!is_answer_of(talk, talk->owner) ||
        (!person && (sd_bus_message_read(talk->reply, "u", &user) < 0 ||
                     (uid_t)user != talk->request->user))) {
        return -EBADMSG;
    }
    return 1;
}

/* The same, and while another client has the camera again and again for a limited time. */
static int wait_for_turn(struct talk *talk)
{
    const int64_t end_ms = now_ms() + LOGIN_TURN_MS;
    for (;;) {
        int r = ask_to_look(talk);
        if (r != 0 ||
            !sd_bus_message_is_method_error(talk->reply, ISO_CONTRACT_ERROR_ALREADY_IN_USE) ||
            now_ms() + RETRY_MS > end_ms) {
            return r;
        }
        r = wait_until(talk, never, now_ms() + RETRY_MS);
        if (r != -ETIMEDOUT) {
            return r;
        }
    }
}

static enum login_verdict fail(struct talk *talk, int error, const char *what)
{
    (void)iso_fault_set(talk->fault, error, "%s: %s", what, strerror(-error));
    return LOGIN_UNAVAILABLE;
}

static enum login_verdict judge(struct talk *talk)
{
    if (strcmp(talk->result, ISO_CONTRACT_RESULT_MATCH) == 0) {
        return LOGIN_MATCH;
    }
    (void)iso_fault_set(talk->fault, -EACCES, "the result is %s", talk->result);
    return strcmp(talk->result, ISO_CONTRACT_RESULT_NO_MATCH) == 0 ||
                   strcmp(talk->result, ISO_CONTRACT_RESULT_ATTACK) == 0
               ? LOGIN_REFUSED
               : LOGIN_UNAVAILABLE;
}

static enum login_verdict look(struct talk *talk)
{
    int r = find_daemon(talk);
    if (r == -ENOENT) {
        (void)iso_fault_set(talk->fault, r, "isothermd is not running");
        return LOGIN_UNAVAILABLE;
    }
    if (r >= 0) {
        r = listen(talk);
    }
    if (r < 0) {
        return fail(talk, r, "the message bus");
    }
    r = wait_for_turn(talk);
    if (r == 0) {
        const sd_bus_error *error = sd_bus_message_get_error(talk->reply);
        (void)iso_fault_set(talk->fault, -EACCES, "isothermd refuses: %s",
                            error && error->message ? error->message : "without a reason");
        return LOGIN_UNAVAILABLE;
    }
    if (r < 0) {
        return fail(talk, r, "isothermd");
    }
    talk->begun = true;
    talk->request->began(talk->request->context);
    r = wait_until(talk, has_ended, now_ms() + (int64_t)talk->request->timeout_s * 1000);
    return r < 0 ? fail(talk, r, r == -ETIMEDOUT ? "no verdict" : "isothermd") : judge(talk);
}

enum login_verdict login_verify(const struct login_request *request, struct iso_fault *fault)
{
    struct talk talk = {.request = request, .fault = fault};
    const int r = iso_bus_connect(request->bus, &talk.bus);
    if (r < 0) {
        return fail(&talk, r, "the message bus");
    }
    const enum login_verdict verdict = look(&talk);
    sd_bus_message_unref(talk.reply);
    /* Without waiting for messages that are still to be sent: the bus may hang. The daemon ends the
     * login when this connection is gone. */
    sd_bus_close_unref(talk.bus);
    return verdict;
}
