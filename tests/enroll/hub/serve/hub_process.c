/* The commands of the hub that run with a broker, as a program for tests:
 * hub_process CONNINFO KEY-FILE FOLDER COMMAND [OPTION...] */
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>

#include "enroll/hub/broker/broker_command.h"
#include "enroll/hub/serve/serve_command.h"

int main(int argc, char **argv)
{
    if (argc < 5) {
        return 2;
    }
    const struct hub_store_options store = {
        .conninfo = argv[1], .key_file = argv[2], .hub_name = "Test", .actor = "hub"};
    (void)prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (strcmp(argv[4], "serve") == 0) {
        return hub_serve_command(&store, argv[3], argc - 4, argv + 4);
    }
    return hub_broker_command(&store, argv[3], argc - 4, argv + 4);
}
