/* The daemon's unit, through the D-Bus interface of systemd (org.freedesktop.systemd1). */
#ifndef CLI_MACHINE_SERVICE_H
#define CLI_MACHINE_SERVICE_H

#include "enroll/cli/client/daemon.h"
#include "enroll/cli/client/fault.h"

struct cli_service;

/* Connects to the service manager and records whether the unit is enabled and active. `unit` must
 * outlive *out. CLI_EXIT_FAULT "no-manager" if there is no service manager on this bus, "no-unit"
 * if it does not know the unit. */
enum cli_exit cli_service_open(const struct cli_bus *bus, const char *unit,
                               struct cli_service **out, struct cli_fault *fault)
    __attribute__((warn_unused_result));

/* Enables the unit, starts or restarts it, and waits until it has started. CLI_EXIT_FAULT
 * "no-start" if it fails or has not started after 130 s; CLI_EXIT_INTERRUPTED. */
enum cli_exit cli_service_start(struct cli_service *service, struct cli_fault *fault)
    __attribute__((warn_unused_result));

/* Restores the state of the unit at cli_service_open: restarts or stops it, and disables it if it
 * was not enabled. Ignores interrupts. CLI_EXIT_FAULT. */
enum cli_exit cli_service_undo(struct cli_service *service, struct cli_fault *fault)
    __attribute__((warn_unused_result));

/* Closes the connection and frees the object. NULL is accepted. */
void cli_service_close(struct cli_service *service);

#endif
