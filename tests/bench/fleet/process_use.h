/* What the servers and the simulated doors use of the machine: processor time and memory from
 * /proc, and the bytes of the connections of the doors from ss(8). */
#ifndef TESTS_BENCH_FLEET_PROCESS_USE_H
#define TESTS_BENCH_FLEET_PROCESS_USE_H

#include <stdint.h>

enum fleet_part { FLEET_BROKER, FLEET_HUB, FLEET_POSTGRES, FLEET_DOORS, FLEET_PARTS };

struct process_use {
    int64_t at_ns;             /* CLOCK_MONOTONIC */
    double cpu_s[FLEET_PARTS]; /* user and system, of all processes of the part */
    double mb[FLEET_PARTS];    /* resident, 10^6 bytes; of PostgreSQL without what it shares */
};

/* "broker", "hub", "postgres", "doors". */
const char *fleet_part_name(enum fleet_part part);

/* Reads the processes that a file names: "broker PID", "hub PID", "postgres PID" (with its
 * children), "doors PID", a line each; several lines of a part are added. */
struct process_use process_use_now(const char *pids_file);

/* Bytes that the broker has received and sent on this port, of the connections that are open. They
 * contain TLS, and neither the headers of TCP nor those of IP. 0: ss is missing. */
double process_use_bytes(uint16_t port);

#endif
