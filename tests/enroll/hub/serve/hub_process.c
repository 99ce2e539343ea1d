/* The running hub as a program for tests:
 * hub_process CONNINFO KEY-FILE FOLDER LISTEN BROKER-PORT DOOR-PORT BROKER-FOLDER METRICS-FILE */
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/prctl.h>

#include "enroll/hub/serve/hub_serve.h"

int main(int argc, char **argv)
{
    struct iso_fault fault = {.text = ""};

    if (argc != 9) {
        return 2;
    }
    const struct hub_serve_options options = {
        .store = {.conninfo = argv[1], .key_file = argv[2], .hub_name = "Test", .actor = "hub"},
        .folder = argv[3],
        .listen = argv[4],
        .hosts = {"127.0.0.1"},
        .n_hosts = 1,
        .broker_host = "localhost",
        .broker_port = (uint16_t)atoi(argv[5]),
        .door_broker_host = "127.0.0.1",
        .door_broker_port = (uint16_t)atoi(argv[6]),
        .broker_folder = argv[7],
        .metrics_file = argv[8],
        .keep = {.acts = 30},
        .home_assistant = true};
    (void)prctl(PR_SET_PDEATHSIG, SIGKILL);
    const int error = hub_serve_run(&options, &fault);
    if (error) {
        fprintf(stderr, "%s\n", fault.text);
    }
    return error ? 4 : 0;
}
