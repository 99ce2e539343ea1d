/* The daemon after its options are read and before its exit code: appliance, bus, event loop,
 * service manager. */
#ifndef ISO_FIRMWARE_DAEMON_DAEMON_H
#define ISO_FIRMWARE_DAEMON_DAEMON_H

#include "core/base/fault.h"
#include "firmware/config/config.h"

/* Runs until SIGTERM or SIGINT, and then returns 0. Otherwise returns a negative errno with a
 * fault: an error of opening the components, or of the bus. The loss of the bus at a later time
 * does not end the daemon. */
int iso_daemon_run(const struct iso_config *config, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Whether iso_daemon_run would start with this configuration, as far as this can be judged without
 * devices, without the bus and without the contents of the stores. It makes the first checks of the
 * start. Errors of iso_components_check; -EINVAL for a text that is not the address of a bus. */
int iso_daemon_check(const struct iso_config *config, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Writes a line to stderr, with the priority (as in syslog.h) in front if stderr is the system's
 * journal. It does not wait for the journal: if the journal is stuck and has no room, the line is
 * lost. */
void iso_daemon_say(int priority, const char *text);

#endif
