/* The command `isotherm-hub serve`. */
#ifndef HUB_SERVE_SERVE_COMMAND_H
#define HUB_SERVE_SERVE_COMMAND_H

#include "enroll/hub/store/hub_store.h"

/* Reads the options of the command (argv[0] is its word) and serves. Prints faults. Returns the
 * exit status of the program: 0, 2 the options are wrong, 4 a fault. */
int hub_serve_command(const struct hub_store_options *store, const char *folder, int argc,
                      char **argv);

#endif
