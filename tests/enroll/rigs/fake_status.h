/* The answer of the scripted stand-in for the daemon to GetStatus. */
#ifndef TEST_FAKE_STATUS_H
#define TEST_FAKE_STATUS_H

#include <systemd/sd-bus.h>

#include "tests/enroll/rigs/fake_daemon.h"

/* Appends the dictionary a{sv}. The script sets some of its values; every other value means that
 * there is no fault. Returns 0 or a negative errno of sd_bus_message_append(). */
int fake_status_append(sd_bus_message *reply, const struct fake_script *script);

/* Appends the entries of the script's site to a dictionary that is open (fake_site.c). */
int fake_site_append(sd_bus_message *reply, const struct fake_script *script);

#endif
