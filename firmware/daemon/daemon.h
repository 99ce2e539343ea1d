/* The life of the daemon between its options and its exit code: appliance, bus, event loop, service
 * manager. */
#ifndef ISO_FIRMWARE_DAEMON_DAEMON_H
#define ISO_FIRMWARE_DAEMON_DAEMON_H

#include "core/base/fault.h"
#include "firmware/config/config.h"

/* Runs until SIGTERM or SIGINT: 0. Else a negative errno with a fault: of opening what the
 * configuration asks for, or of the bus; a bus that is lost later is no reason to end. */
int iso_daemon_run(const struct iso_config *config, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Whether iso_daemon_run would start with this configuration, as far as that can be told without
 * devices, without the bus and without what the stores hold: asks what the start asks first. Errors
 * of iso_components_check; -EINVAL an address of no bus. */
int iso_daemon_check(const struct iso_config *config, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* A line on stderr, with the priority (as in syslog.h) in front if that is the system's journal. It
 * does not wait for the journal: a line for which a stuck one has no room is lost. */
void iso_daemon_say(int priority, const char *text);

#endif
