/* The command `isotherm-hub broker-config`. */
#ifndef HUB_BROKER_BROKER_COMMAND_H
#define HUB_BROKER_BROKER_COMMAND_H

#include "enroll/hub/store/hub_store.h"

/* Reads the options of the command (argv[0] is its word), writes the folder of the broker and says
 * how to reload it. `folder` is that of the authority. Prints faults. Returns the exit status of
 * the program: 0, 2 the options are wrong, 4 a fault. */
int hub_broker_command(const struct hub_store_options *store, const char *folder, int argc,
                       char **argv);

#endif
