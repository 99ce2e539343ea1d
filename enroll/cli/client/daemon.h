/* The client's side of the daemon: one connection, calls with their faults in plain words, and a
 * wait for signals that a person can interrupt. A connection is used by one thread. */
#ifndef CLI_CLIENT_DAEMON_H
#define CLI_CLIENT_DAEMON_H

#include <stdbool.h>
#include <systemd/sd-bus.h>

#include "enroll/cli/client/bus.h"
#include "enroll/cli/client/fault.h"

struct cli_daemon;

/* Connects to the bus; the daemon need not be on it. CLI_EXIT_FAULT "no-bus" if the bus cannot be
 * reached. */
enum cli_exit cli_daemon_open(const struct cli_bus *bus, struct cli_daemon **out,
                              struct cli_fault *fault) __attribute__((warn_unused_result));

/* The daemon itself releases what this connection has claimed. NULL is fine. */
void cli_daemon_close(struct cli_daemon *daemon);

/* A call of a method of the daemon; arguments are appended with sd_bus_message_append(). Never
 * NULL, except for want of memory (CLI_EXIT_FAULT). */
enum cli_exit cli_daemon_message(struct cli_daemon *daemon, const char *method,
                                 sd_bus_message **out, struct cli_fault *fault)
    __attribute__((warn_unused_result));

/* Sends a call and takes the reference to it. *reply (NULL if it is of no interest) is the
 * caller's to unreference. Faults of the daemon are translated:
 *   CLI_EXIT_USAGE      invalid-name, invalid-argument
 *   CLI_EXIT_NOT_FOUND  no-such-person
 *   CLI_EXIT_NO         access-denied
 *   CLI_EXIT_TIMED_OUT  no-reply within 10 s
 *   CLI_EXIT_FAULT      no-daemon, already-in-use, gallery-full, device-fault, ... */
enum cli_exit cli_daemon_send(struct cli_daemon *daemon, sd_bus_message *call,
                              sd_bus_message **reply, struct cli_fault *fault)
    __attribute__((warn_unused_result));

/* cli_daemon_message and cli_daemon_send for a method without arguments. */
enum cli_exit cli_daemon_call(struct cli_daemon *daemon, const char *method, sd_bus_message **reply,
                              struct cli_fault *fault) __attribute__((warn_unused_result));

/* Translates a reply that could not be read (a negative errno of sd_bus_message_read()). */
enum cli_exit cli_daemon_bad_reply(int error, const char *method, struct cli_fault *fault);

/* Whether a daemon owns the name now. */
enum cli_exit cli_daemon_has_daemon(struct cli_daemon *daemon, bool *has, struct cli_fault *fault)
    __attribute__((warn_unused_result));

/* Called for a signal; returns true to end the wait. */
typedef bool (*cli_daemon_signal_fn)(sd_bus_message *signal, void *context);

/* From now on `handler` is called, during cli_daemon_wait() and cli_daemon_send_and_listen(), for
 * every signal of the daemon with the name `member` (NULL: for all signals). At most one
 * subscription a connection. */
enum cli_exit cli_daemon_subscribe(struct cli_daemon *daemon, const char *member,
                                   cli_daemon_signal_fn handler, void *context,
                                   struct cli_fault *fault) __attribute__((warn_unused_result));

/* As cli_daemon_send, for a call that may take long and reports its progress by signals. The
 * handler of the subscription is called for the signals; its result is ignored. The daemon may be
 * silent for ten minutes: after it has sealed all records, it writes them to the disk as one
 * transaction and sends no signals meanwhile. */
enum cli_exit cli_daemon_send_and_listen(struct cli_daemon *daemon, sd_bus_message *call,
                                         sd_bus_message **reply, struct cli_fault *fault)
    __attribute__((warn_unused_result));

/* From now on SIGINT and SIGTERM end a wait instead of the program. */
enum cli_exit cli_daemon_catch_interrupt(struct cli_daemon *daemon, struct cli_fault *fault)
    __attribute__((warn_unused_result));

/* Dispatches signals until the handler ends the wait (CLI_EXIT_OK), for at most timeout_s seconds
 * (CLI_EXIT_TIMED_OUT; nothing is said in *fault), or until the person interrupts
 * (CLI_EXIT_INTERRUPTED, likewise) or the daemon or the bus goes away (CLI_EXIT_FAULT
 * "daemon-gone"). A timeout_s of 0 is no limit. */
enum cli_exit cli_daemon_wait(struct cli_daemon *daemon, double timeout_s, struct cli_fault *fault)
    __attribute__((warn_unused_result));

#endif
