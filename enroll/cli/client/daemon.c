#include "enroll/cli/client/daemon.h"

#include <errno.h>
#include <signal.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <systemd/sd-event.h>
#include <time.h>
#include <unistd.h>

#include "enroll/cli/client/daemon_error.h"
#include "firmware/contract/contract.h"

enum {
    CALL_TIMEOUT_US = 10 * 1000 * 1000,
    SILENCE_US = 10 * 60 * 1000 * 1000, /* the longest wait for a signal or an answer of a call */
};

struct cli_daemon {
    sd_bus *bus;
    sd_event *event;
    cli_daemon_signal_fn handler;
    void *context;
    bool done, interrupted, gone; /* why a wait ended */
    uint64_t heard;               /* how often the handler was called for a signal */
};

static enum cli_exit no_bus(int error, const struct cli_bus *bus, struct cli_fault *fault)
{
    const char *name = bus->session ? "session" : "system";

    if (bus->address) {
        name = bus->address;
    }
    return cli_fault_set(fault, CLI_EXIT_FAULT, "no-bus", "cannot reach the bus (%s): %s", name,
                         strerror(-error));
}

static int on_bus_gone(sd_bus_message *signal, void *context, sd_bus_error *error)
{
    (void)signal, (void)error;
    ((struct cli_daemon *)context)->gone = true;
    return 0;
}

static int on_owner_changed(sd_bus_message *signal, void *context, sd_bus_error *error)
{
    struct cli_daemon *daemon = context;
    const char *name, *before, *after;

    (void)error;
    if (sd_bus_message_read(signal, "sss", &name, &before, &after) >= 0 && *before && !*after) {
        daemon->gone = true;
    }
    return 0;
}

/* Both matches are installed without waiting. The bus has them before any later call of this
 * client. */
static int watch_daemon(struct cli_daemon *daemon)
{
    const int r = sd_bus_add_match_async(
        daemon->bus, NULL,
        "type='signal',sender='org.freedesktop.DBus',path='/org/freedesktop/DBus',"
        "interface='org.freedesktop.DBus',member='NameOwnerChanged',arg0='" ISO_CONTRACT_NAME "'",
        on_owner_changed, NULL, daemon);
    if (r < 0) {
        return r;
    }
    return sd_bus_match_signal_async(daemon->bus, NULL, "org.freedesktop.DBus.Local", NULL,
                                     "org.freedesktop.DBus.Local", "Disconnected", on_bus_gone,
                                     NULL, daemon);
}

enum cli_exit cli_daemon_open(const struct cli_bus *bus, struct cli_daemon **out,
                              struct cli_fault *fault)
{
    struct cli_daemon *daemon = calloc(1, sizeof *daemon);
    const char *unique;
    int r;

    if (!daemon) {
        return no_bus(-ENOMEM, bus, fault);
    }
    r = cli_bus_connect(bus, &daemon->bus);
    if (r >= 0) {
        /* This call waits for the handshake. */
        r = sd_bus_get_unique_name(daemon->bus, &unique);
    }
    if (r >= 0) {
        r = sd_bus_set_method_call_timeout(daemon->bus, CALL_TIMEOUT_US);
    }
    if (r >= 0) {
        r = sd_event_new(&daemon->event);
    }
    if (r >= 0) {
        r = sd_bus_attach_event(daemon->bus, daemon->event, SD_EVENT_PRIORITY_NORMAL);
    }
    if (r >= 0) {
        r = watch_daemon(daemon);
    }
    if (r < 0) {
        cli_daemon_close(daemon);
        return no_bus(r, bus, fault);
    }
    *out = daemon;
    return CLI_EXIT_OK;
}

void cli_daemon_close(struct cli_daemon *daemon)
{
    if (!daemon) {
        return;
    }
    if (daemon->bus) {
        sd_bus_detach_event(daemon->bus);
        sd_bus_flush_close_unref(daemon->bus);
    }
    sd_event_unref(daemon->event);
    free(daemon);
}

enum cli_exit cli_daemon_message(struct cli_daemon *daemon, const char *method,
                                 sd_bus_message **out, struct cli_fault *fault)
{
    const int r = sd_bus_message_new_method_call(daemon->bus, out, ISO_CONTRACT_NAME,
                                                 ISO_CONTRACT_PATH, ISO_CONTRACT_INTERFACE, method);

    if (r < 0) {
        return cli_fault_set(fault, CLI_EXIT_FAULT, "internal", "%s: %s", method, strerror(-r));
    }
    return CLI_EXIT_OK;
}

enum cli_exit cli_daemon_send(struct cli_daemon *daemon, sd_bus_message *call,
                              sd_bus_message **reply, struct cli_fault *fault)
{
    sd_bus_error error = SD_BUS_ERROR_NULL;
    enum cli_exit exit = CLI_EXIT_OK;
    const int r = sd_bus_call(daemon->bus, call, 0, &error, reply);

    if (r < 0) {
        exit = cli_daemon_error(&error, r, sd_bus_message_get_member(call), fault);
    }
    sd_bus_error_free(&error);
    sd_bus_message_unref(call);
    return exit;
}

enum cli_exit cli_daemon_call(struct cli_daemon *daemon, const char *method, sd_bus_message **reply,
                              struct cli_fault *fault)
{
    sd_bus_message *call = NULL;
    const enum cli_exit exit = cli_daemon_message(daemon, method, &call, fault);

    return exit ? exit : cli_daemon_send(daemon, call, reply, fault);
}

enum cli_exit cli_daemon_bad_reply(int error, const char *method, struct cli_fault *fault)
{
    return cli_fault_set(fault, CLI_EXIT_FAULT, "bad-reply",
                         "%s: the daemon's answer is not understood (%s); do `isotherm --version` "
                         "and `isothermd --version` agree?",
                         method, strerror(-error));
}

/* Finds the connection that owns the daemon's name now. The caller frees *owner. */
static int find_owner(struct cli_daemon *daemon, sd_bus_error *error, char **owner)
{
    sd_bus_message *reply = NULL;
    const char *name;
    int r = sd_bus_call_method(daemon->bus, "org.freedesktop.DBus", "/org/freedesktop/DBus",
                               "org.freedesktop.DBus", "GetNameOwner", error, &reply, "s",
                               ISO_CONTRACT_NAME);

    if (r >= 0) {
        r = sd_bus_message_read_basic(reply, 's', &name);
    }
    if (r >= 0) {
        *owner = strdup(name);
        r = *owner ? 0 : -ENOMEM;
    }
    sd_bus_message_unref(reply);
    return r;
}

enum cli_exit cli_daemon_has_daemon(struct cli_daemon *daemon, bool *has, struct cli_fault *fault)
{
    sd_bus_error error = SD_BUS_ERROR_NULL;
    enum cli_exit exit = CLI_EXIT_OK;
    char *owner = NULL;
    const int r = find_owner(daemon, &error, &owner);

    if (r < 0 && !sd_bus_error_has_name(&error, SD_BUS_ERROR_NAME_HAS_NO_OWNER)) {
        exit = cli_daemon_error(&error, r, "GetNameOwner", fault);
    } else {
        *has = r >= 0;
    }
    free(owner);
    sd_bus_error_free(&error);
    return exit;
}

static int on_signal(sd_bus_message *signal, void *context, sd_bus_error *error)
{
    struct cli_daemon *daemon = context;

    (void)error;
    daemon->heard++;
    if (!daemon->done && daemon->handler(signal, daemon->context)) {
        daemon->done = true;
    }
    return 0;
}

/* The match names the connection and not the service. Any client may send a signal directly to this
 * one, past the matching of the bus, and sd-bus itself compares only the name of a connection. */
enum cli_exit cli_daemon_subscribe(struct cli_daemon *daemon, const char *member,
                                   cli_daemon_signal_fn handler, void *context,
                                   struct cli_fault *fault)
{
    sd_bus_error error = SD_BUS_ERROR_NULL;
    enum cli_exit exit = CLI_EXIT_OK;
    char *owner = NULL;
    int r = find_owner(daemon, &error, &owner);

    daemon->handler = handler;
    daemon->context = context;
    if (r >= 0) {
        r = sd_bus_match_signal(daemon->bus, NULL, owner, ISO_CONTRACT_PATH, ISO_CONTRACT_INTERFACE,
                                member, on_signal, daemon);
    }
    if (r < 0) {
        exit = cli_daemon_error(&error, r, "AddMatch", fault);
    }
    free(owner);
    sd_bus_error_free(&error);
    return exit;
}

/* A signal handler writes to this event descriptor. A signalfd would not work: it needs a blocked
 * signal, but the threads of a library, such as a BLAS, do not block it, so that the signal would
 * end the program. */
static int interrupt_fd = -1;

static void handle_interrupt(int number)
{
    const int saved = errno;

    (void)number;
    (void)!write(interrupt_fd, &(uint64_t){1}, sizeof(uint64_t));
    errno = saved;
}

static int on_interrupt(sd_event_source *source, int fd, uint32_t events, void *context)
{
    (void)source, (void)fd, (void)events;
    ((struct cli_daemon *)context)->interrupted = true;
    return 0;
}

static int catch_interrupt(struct cli_daemon *daemon)
{
    const struct sigaction action = {.sa_handler = handle_interrupt, .sa_flags = SA_RESTART};

    if (interrupt_fd < 0) {
        interrupt_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    }
    if (interrupt_fd < 0 || sigaction(SIGINT, &action, NULL) < 0 ||
        sigaction(SIGTERM, &action, NULL) < 0) {
        return -errno;
    }
    return sd_event_add_io(daemon->event, NULL, interrupt_fd, EPOLLIN, on_interrupt, daemon);
}

enum cli_exit cli_daemon_catch_interrupt(struct cli_daemon *daemon, struct cli_fault *fault)
{
    const int r = catch_interrupt(daemon);

    if (r < 0) {
        return cli_fault_set(fault, CLI_EXIT_FAULT, "internal", "cannot catch interrupts: %s",
                             strerror(-r));
    }
    return CLI_EXIT_OK;
}

static uint64_t now_us(void)
{
    struct timespec now;

    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000000u + (uint64_t)now.tv_nsec / 1000u;
}

static int on_reply(sd_bus_message *reply, void *context, sd_bus_error *error)
{
    (void)error;
    *(sd_bus_message **)context = sd_bus_message_ref(reply);
    return 0;
}

/* Dispatches messages until the reply has come, or until no signal has come for SILENCE_US. If the
 * daemon has gone away, the bus itself replies. */
static int await_reply(struct cli_daemon *daemon, sd_bus_message **reply)
{
    uint64_t heard = daemon->heard, deadline_us = now_us() + SILENCE_US;

    while (!*reply) {
        const uint64_t now = now_us();
        const int r = now < deadline_us ? sd_event_run(daemon->event, deadline_us - now)
                                        : -ETIMEDOUT;
        if (r < 0 && r != -EINTR) {
            return r;
        }
        if (daemon->heard != heard) {
            heard = daemon->heard;
            deadline_us = now_us() + SILENCE_US;
        }
    }
    return sd_bus_is_open(daemon->bus) > 0 ? 0 : -ECONNRESET;
}

enum cli_exit cli_daemon_send_and_listen(struct cli_daemon *daemon, sd_bus_message *call,
                                         sd_bus_message **reply, struct cli_fault *fault)
{
    const char *method = sd_bus_message_get_member(call);
    sd_bus_error error = SD_BUS_ERROR_NULL;
    sd_bus_message *answer = NULL;
    sd_bus_slot *slot = NULL;
    enum cli_exit exit = CLI_EXIT_OK;
    int r;

    daemon->done = false;
    r = sd_bus_call_async(daemon->bus, &slot, call, on_reply, &answer, UINT64_MAX);
    if (r >= 0) {
        r = await_reply(daemon, &answer);
    }
    r = r < 0 ? sd_bus_error_set_errno(&error, r)
              : sd_bus_error_copy(&error, sd_bus_message_get_error(answer));
    if (r < 0) {
        exit = cli_daemon_error(&error, r, method, fault);
    } else if (reply) {
        *reply = sd_bus_message_ref(answer);
    }
    sd_bus_message_unref(answer);
    sd_bus_error_free(&error);
    sd_bus_slot_unref(slot);
    sd_bus_message_unref(call);
    return exit;
}

enum cli_exit cli_daemon_wait(struct cli_daemon *daemon, double timeout_s, struct cli_fault *fault)
{
    const bool forever = timeout_s <= 0;
    const uint64_t deadline_us = now_us() + (forever ? 0 : (uint64_t)(timeout_s * 1e6));

    daemon->done = false;
    while (!daemon->done && !daemon->interrupted && !daemon->gone) {
        const uint64_t now = now_us();
        if (!forever && now >= deadline_us) {
            return CLI_EXIT_TIMED_OUT;
        }
        const int r = sd_event_run(daemon->event, forever ? UINT64_MAX : deadline_us - now);
        if (r < 0 && r != -EINTR) {
            return cli_fault_set(fault, CLI_EXIT_FAULT, "daemon-gone", "lost the bus: %s",
                                 strerror(-r));
        }
    }
    if (daemon->done) {
        return CLI_EXIT_OK;
    }
    if (daemon->interrupted) {
        return CLI_EXIT_INTERRUPTED;
    }
    return cli_fault_set(fault, CLI_EXIT_FAULT, "daemon-gone",
                         "the daemon has gone away; see its log (journalctl --unit=isothermd)");
}
