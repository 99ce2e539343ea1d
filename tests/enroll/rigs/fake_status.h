/* What the scripted stand-in for the daemon answers to GetStatus. */
#ifndef TEST_FAKE_STATUS_H
#define TEST_FAKE_STATUS_H

#include <systemd/sd-bus.h>

#include "tests/enroll/rigs/fake_daemon.h"

/* Appends the dictionary a{sv}: what the script says, and for everything else that all is well. A
 * negative errno of sd_bus_message_append(). */
int fake_status_append(sd_bus_message *reply, const struct fake_script *script);

#endif
