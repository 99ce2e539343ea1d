/* What the tests of the audit log share: a.log in a directory of the test's, on a clock that
 * stands. */
#ifndef TESTS_FIRMWARE_RIGS_AUDIT_RIG_H
#define TESTS_FIRMWARE_RIGS_AUDIT_RIG_H

#include "firmware/audit/audit.h"
#include "tests/firmware/rigs/stores.h"

/* 2026-11-21T08:33:20.250Z, 81.25 s after the start of the machine. */
extern const struct iso_times audit_rig_times;

int audit_rig_try_open(const char *directory, struct iso_audit **out, struct iso_fault *fault);

/* The same; a failure fails the test. */
struct iso_audit *audit_rig_open(const char *directory);

/* A log of small segments, of which it keeps three, that is not synchronised. */
struct iso_audit *audit_rig_open_small(const char *directory);

/* Line number `number` of a text, from 0. */
const char *audit_rig_line(const char *text, int number);

/* A record of an event and nothing more. */
int audit_rig_append(struct iso_audit *audit, const char *event, struct iso_fault *fault);

/* What the log of a directory says, and what is on the disk; to be freed. */
char *audit_rig_log(const char *directory);
char *audit_rig_file(const char *directory);

struct iso_audit_report audit_rig_verify(struct iso_audit *audit);

/* For iso_audit_read: takes the context, a struct audit_rig_seen, from record to record. */
struct audit_rig_seen {
    unsigned n, first, last;
    int stop_at; /* the result of the call for this one is 7 */
};

int audit_rig_see(void *context, const char *line);

#endif
