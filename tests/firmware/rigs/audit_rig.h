/* Functions that the tests of the audit log share. The log is a.log in a directory of the test, and
 * its clock stands still. */
#ifndef TESTS_FIRMWARE_RIGS_AUDIT_RIG_H
#define TESTS_FIRMWARE_RIGS_AUDIT_RIG_H

#include "firmware/audit/audit.h"
#include "tests/firmware/rigs/stores.h"

/* 2026-11-21T08:33:20.250Z, 81.25 s after the start of the machine. */
extern const struct iso_times audit_rig_times;

int audit_rig_try_open(const char *directory, struct iso_audit **out, struct iso_fault *fault);

/* Like audit_rig_try_open, but a failure fails the test. */
struct iso_audit *audit_rig_open(const char *directory);

/* Opens a log with small segments. It keeps three of them and does not synchronise. */
struct iso_audit *audit_rig_open_small(const char *directory);

/* Returns line number `number` of a text, counted from 0. */
const char *audit_rig_line(const char *text, int number);

/* Appends a record that has only an event. */
int audit_rig_append(struct iso_audit *audit, const char *event, struct iso_fault *fault);

/* The decrypted log of a directory, and the content of its file. Free both with free(). */
char *audit_rig_log(const char *directory);
char *audit_rig_file(const char *directory);

struct iso_audit_report audit_rig_verify(struct iso_audit *audit);

/* audit_rig_see is a callback for iso_audit_read. The context is a struct audit_rig_seen, which it
 * updates with each record. */
struct audit_rig_seen {
    unsigned n, first, last;
    int stop_at; /* the callback returns 7 for this record */
};

int audit_rig_see(void *context, const char *line);

#endif
