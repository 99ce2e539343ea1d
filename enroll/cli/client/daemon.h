/* The connection of a client to the daemon: calls whose faults are plain texts, and a wait for
 * signals that a person can interrupt. Only one thread may use a connection. */
#ifndef CLI_CLIENT_DAEMON_H
#define CLI_CLIENT_DAEMON_H

#include <stdbool.h>
#include <systemd/sd-bus.h>

#include "enroll/cli/client/bus.h"
#include "enroll/cli/client/fault.h"

struct cli_daemon;

/* Connects to the bus. The daemon need not be on it. CLI_EXIT_FAULT "no-bus" if the bus cannot be
 * reached. */
enum cli_exit cli_daemon_open(const struct cli_bus *bus, struct cli_daemon **out,
                              struct cli_fault *fault) __attribute__((warn_unused_result));

/* Closes the connection. The daemon then releases what this connection has claimed. NULL is
 * accepted. */
void cli_daemon_close(struct cli_daemon *daemon);

/* Makes a call of a method of the daemon, to which the caller appends arguments with
 * sd_bus_message_append(). cli_daemon_send() takes it over. CLI_EXIT_FAULT "internal" if it cannot
 * be made. */
enum cli_exit cli_daemon_message(struct cli_daemon *daemon, const char *method,
                                 sd_bus_message **out, struct cli_fault *fault)
    __attribute__((warn_unused_result));

/* Sends a call, releases it and waits for the reply. The caller unreferences *reply; `reply` may be
 * NULL. Errors of the daemon are translated to faults:
 *   CLI_EXIT_USAGE      invalid-name, invalid-argument
 *   CLI_EXIT_NOT_FOUND  no-such-person
 *   CLI_EXIT_NO         access-denied, name-in-use, locked-out
 *   CLI_EXIT_TIMED_OUT  no-reply within 10 s
 *   CLI_EXIT_FAULT      no-daemon, already-in-use, gallery-full, device-fault, ... */
enum cli_exit cli_daemon_send(struct cli_daemon *daemon, sd_bus_message *call,
                              sd_bus_message **reply, struct cli_fault *fault)
    __attribute__((warn_unused_result));

/* cli_daemon_message and cli_daemon_send for a method without arguments. */
enum cli_exit cli_daemon_call(struct cli_daemon *daemon, const char *method, sd_bus_message **reply,
                              struct cli_fault *fault) __attribute__((warn_unused_result));

/* Makes the fault "bad-reply" of a reply that could not be read. `error` is the negative errno of
 * sd_bus_message_read(). Returns CLI_EXIT_FAULT. */
enum cli_exit cli_daemon_bad_reply(int error, const char *method, struct cli_fault *fault);

/* Sets *has to whether a daemon owns the name now. Faults of cli_daemon_send(). */
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

/* The same as cli_daemon_send, for a call that may take long and reports its progress by signals.
 * The handler of the subscription is called for the signals; its result is ignored. The daemon may
 * send no signal for ten minutes: after it has sealed all records, it writes them to the disk as
 * one transaction. */
enum cli_exit cli_daemon_send_and_listen(struct cli_daemon *daemon, sd_bus_message *call,
                                         sd_bus_message **reply, struct cli_fault *fault)
    __attribute__((warn_unused_result));

/* From now on SIGINT and SIGTERM end a wait instead of the program. */
enum cli_exit cli_daemon_catch_interrupt(struct cli_daemon *daemon, struct cli_fault *fault)
    __attribute__((warn_unused_result));

/* Dispatches signals until one of these happens: the handler ends the wait (CLI_EXIT_OK), timeout_s
 * seconds have passed (CLI_EXIT_TIMED_OUT), the person interrupts (CLI_EXIT_INTERRUPTED), or the
 * daemon or the bus goes away (CLI_EXIT_FAULT "daemon-gone"). *fault is filled in only for the last
 * one. A timeout_s of 0 is no limit. */
enum cli_exit cli_daemon_wait(struct cli_daemon *daemon, double timeout_s, struct cli_fault *fault)
    __attribute__((warn_unused_result));

#endif
