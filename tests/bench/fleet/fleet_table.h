/* What the programs of the measurement of a fleet (fleet_bench.sh) know of its doors: one file that
 * all of them map. `fleet_bench join` makes it, with the keys of the doors; the processes of doors
 * (fleet_crowd.c) write what their doors do; `fleet_bench` reads it. All times are of
 * CLOCK_MONOTONIC, which is the same for all processes. */
#ifndef TESTS_BENCH_FLEET_FLEET_TABLE_H
#define TESTS_BENCH_FLEET_FLEET_TABLE_H

#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>

#include "firmware/fleet/message/envelope.h"
#include "firmware/fleet/message/fleet_id.h"

enum {
    FLEET_TABLE_CHANGES_MOST = 512, /* of the zone, in one measurement */
    FLEET_TABLE_MEMBERSHIP_MAX = 512,
};

struct fleet_table_door {
    /* Written when the door joins. */
    struct iso_fleet_signer signs;
    struct iso_fleet_receiver receives;
    uint8_t membership[FLEET_TABLE_MEMBERSHIP_MAX];
    uint32_t membership_size;
    /* Written by the door: its link (link_report), twice a second. */
    _Atomic uint32_t phase;
    _Atomic int64_t online_ns; /* since when it has a lease of this connection; 0: it has none */
    _Atomic uint64_t connections, questions, fetches, failed_fetches, faults;
    _Atomic uint64_t last_event, events_acked; /* of the log */
    /* Written by the door at once: the place of its zone, and when it came there. */
    _Atomic uint64_t sequence;
    _Atomic int64_t applied_ns[FLEET_TABLE_CHANGES_MOST]; /* by the sequence; 0: not yet */
};

struct fleet_table {
    uint32_t n; /* doors */
    struct iso_fleet_id zone;
    /* Written by fleet_bench. */
    uint32_t people, revoked;        /* how many were enrolled, and how many of them revoked */
    _Atomic uint64_t visits;         /* records of the log that each door shall have made by now */
    struct fleet_table_door doors[]; /* [n] */
};

int64_t fleet_table_now_ns(void);

/* Makes the file of n doors, or opens it, and maps it until the program ends. A failure ends the
 * program with a line. */
struct fleet_table *fleet_table_make(const char *path, uint32_t n);
struct fleet_table *fleet_table_open(const char *path);

#endif
