/* The arguments of the module: what the configuration of PAM, which belongs to root, says. */
#ifndef LOGIN_ARGUMENTS_H
#define LOGIN_ARGUMENTS_H

#include <stdbool.h>

#include "core/base/fault.h"

/* The system bus. The environment of the caller may not replace it: it can be the user's own. */
#define LOGIN_SYSTEM_BUS "unix:path=/run/dbus/system_bus_socket"

enum { LOGIN_TIMEOUT_S = 10, LOGIN_TIMEOUT_MAX_S = 60 };

struct login_arguments {
    const char *bus;   /* the D-Bus address of a socket: unix:path=... or unix:abstract=... */
    const char *users; /* the file of firmware/contract/login_users.h */
    const char *ask;   /* services, separated by commas; "all", or "none" */
    int timeout_s;     /* how long to look, 1 to LOGIN_TIMEOUT_MAX_S */
};

/* Reads `bus=`, `users=`, `ask=` and `timeout=`, each at most once. *out points into argv, or to
 * constants where an argument is missing; `users` is the file where none is named. -EINVAL with a
 * fault that names the argument, if it is unknown, repeated, or has a bad value. */
int login_arguments_read(int argc, const char *const argv[], const char *users,
                         struct login_arguments *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Whether to ask for Enter before this service looks at a face; NULL is a service without a name.
 * Where the list of `ask` is missing, services that give rights within a session are asked. */
bool login_arguments_ask(const struct login_arguments *arguments, const char *service);

#endif
