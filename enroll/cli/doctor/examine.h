/* Examines the appliance: the bus, the daemon, the rights of the user, and the daemon's status. */
#ifndef CLI_DOCTOR_EXAMINE_H
#define CLI_DOCTOR_EXAMINE_H

#include "enroll/cli/client/daemon.h"
#include "enroll/cli/doctor/diagnosis.h"

/* Adds a finding for each thing that was examined. It opens the bus itself: a bus that cannot be
 * reached is one of the findings. */
void cli_doctor_examine(const struct cli_bus *bus, struct cli_diagnosis *diagnosis);

#endif
