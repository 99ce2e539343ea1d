#include "tests/enroll/pam/puppet_daemon.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <signal.h>
#include <stdbool.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <systemd/sd-bus.h>
#include <unistd.h>

#include "firmware/contract/bus_connect.h"
#include "firmware/contract/contract.h"

struct puppet {
    enum puppet_act act;
    sd_bus *bus, *forger;
    int calls;
};

/* Sends a status, and waits until the bus has passed it on. */
static void send_status(sd_bus *bus, const char *to, const char *result, bool done)
{
    sd_bus_message *signal = NULL;
    if (sd_bus_message_new_signal(bus, &signal, ISO_CONTRACT_PATH, ISO_CONTRACT_INTERFACE,
                                  ISO_CONTRACT_VERIFY_STATUS) < 0 ||
        sd_bus_message_append(signal, "sbsdd", result, (int)done, "", NAN, 0.0) < 0 ||
        sd_bus_message_set_destination(signal, to) < 0 || sd_bus_send(bus, signal, NULL) < 0 ||
        sd_bus_call_method(bus, "org.freedesktop.DBus", "/org/freedesktop/DBus",
                           "org.freedesktop.DBus", "GetId", NULL, NULL, NULL) < 0) {
        _exit(3);
    }
    sd_bus_message_unref(signal);
}

/* VerifySelf is answered with the user of the caller, or with root. */
static int accept_call(sd_bus_message *call, bool other)
{
    sd_bus_creds *creds = NULL;
    uid_t user = 0;
    if (sd_bus_query_sender_creds(call, SD_BUS_CREDS_EUID, &creds) < 0 ||
        sd_bus_creds_get_euid(creds, &user) < 0) {
        _exit(4);
    }
    sd_bus_creds_unref(creds);
    return sd_bus_message_is_method_call(call, NULL, ISO_CONTRACT_VERIFY_SELF)
               ? sd_bus_reply_method_return(call, "u", other ? 0 : (uint32_t)user)
               : sd_bus_reply_method_return(call, NULL);
}

static void speak_otherwise(struct puppet *puppet, const char *to)
{
    static const char *const words[] = {"identify-match", "verify-matches", "enroll-match", "match",
                                        ""};
    send_status(puppet->bus, to, "verify-match", false);
    send_status(puppet->bus, to, "identify-match", true);
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        send_status(puppet->bus, to, words[i], false);
    }
    send_status(puppet->bus, to, "verify-attack", true);
    send_status(puppet->bus, to, "verify-match", true); /* after the end */
}

static void give_hints(struct puppet *puppet, const char *to)
{
    static const char *const words[] = {"verify-retry-too-far", "verify-retry-too-far",
                                        "verify-retry-no-such-word", "verify-retry-moving"};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        send_status(puppet->bus, to, words[i], false);
    }
    send_status(puppet->bus, to, "verify-timed-out", true);
}

/* What comes after the call was accepted. */
static void go_on(struct puppet *puppet, const char *to)
{
    switch (puppet->act) {
    case PUPPET_LEAVES:
        (void)sd_bus_flush(puppet->bus);
        _exit(0);
    case PUPPET_IS_FORGED:
    case PUPPET_IS_FORGED_ALONE:
        send_status(puppet->forger, to, "verify-match", true);
        if (puppet->act == PUPPET_IS_FORGED) {
            send_status(puppet->bus, to, "verify-no-match", true);
        }
        break;
    case PUPPET_IS_EARLY:
        send_status(puppet->bus, to, "verify-no-match", true);
        break;
    case PUPPET_GIVES_HINTS:
        give_hints(puppet, to);
        break;
    case PUPPET_SPEAKS_OTHERWISE:
        speak_otherwise(puppet, to);
        break;
    default:
        send_status(puppet->bus, to, "verify-match", true);
        break;
    }
}

static int on_call(sd_bus_message *call, void *context, sd_bus_error *unused)
{
    struct puppet *puppet = context;
    const char *sender = sd_bus_message_get_sender(call);
    (void)unused;
    if (!sd_bus_message_is_method_call(call, ISO_CONTRACT_INTERFACE, NULL)) {
        return 0;
    }
    puppet->calls++;
    switch (puppet->act) {
    case PUPPET_SAYS_NOTHING:
        return 1;
    case PUPPET_REFUSES:
        return sd_bus_reply_method_errorf(call, ISO_CONTRACT_ERROR_DEVICE_FAULT, "no camera");
    case PUPPET_STAYS_BUSY:
    case PUPPET_BUSY_TWICE:
        if (puppet->act == PUPPET_STAYS_BUSY || puppet->calls <= 2) {
            return sd_bus_reply_method_errorf(call, ISO_CONTRACT_ERROR_ALREADY_IN_USE, "busy");
        }
        break;
    case PUPPET_IS_EARLY:
        send_status(puppet->bus, sender, "verify-match", true);
        break;
    default:
        break;
    }
    const int r = accept_call(call, puppet->act == PUPPET_IS_OTHER_USER);
    if (r >= 0) {
        go_on(puppet, sender);
    }
    return r < 0 ? r : 1;
}

static void serve(const char *address, enum puppet_act act, int ready)
{
    struct puppet puppet = {.act = act};
    (void)prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (iso_bus_connect(address, &puppet.bus) < 0 || iso_bus_connect(address, &puppet.forger) < 0 ||
        sd_bus_add_filter(puppet.bus, NULL, on_call, &puppet) < 0 ||
        sd_bus_request_name(puppet.bus, ISO_CONTRACT_NAME, 0) < 0 || write(ready, "r", 1) != 1) {
        _exit(1);
    }
    for (;;) {
        while (sd_bus_process(puppet.bus, NULL) > 0) {
        }
        (void)sd_bus_wait(puppet.bus, UINT64_MAX);
    }
}

pid_t puppet_daemon_start(const char *address, enum puppet_act act)
{
    int ready[2];
    char byte;
    assert_int_equal(pipe(ready), 0);
    const pid_t pid = fork();
    assert_true(pid >= 0);
    if (pid == 0) {
        (void)close(ready[0]);
        serve(address, act, ready[1]);
    }
    (void)close(ready[1]);
    assert_int_equal(read(ready[0], &byte, 1), 1);
    (void)close(ready[0]);
    return pid;
}

void puppet_daemon_stop(pid_t pid)
{
    (void)kill(pid, SIGKILL);
    (void)waitpid(pid, NULL, 0);
}
