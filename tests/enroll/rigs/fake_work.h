/* The methods of the stand-in for the daemon that take long: ExportPeople, ImportPeople,
 * RotateKeys, VerifyLog. */
#ifndef TEST_FAKE_WORK_H
#define TEST_FAKE_WORK_H

#include <systemd/sd-bus.h>

#include "tests/enroll/rigs/fake_daemon.h"

/* Sends the Progress signals of the script and answers the call: 2 people are exported, 2 are added
 * and none was known, the keys are rotated without a remark, records 1 to 100 are sound. Returns a
 * negative errno of sd-bus if it fails. */
int fake_work(sd_bus_message *call, const struct fake_script *script);

#endif
