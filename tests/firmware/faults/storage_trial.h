/* One trial of test_storage_faults.c: an act runs on a disk that fails, and another process reads
 * the files that the act has left (storage_trial.c). Then the trial is judged (storage_judge.c). */
#ifndef TESTS_FIRMWARE_FAULTS_STORAGE_TRIAL_H
#define TESTS_FIRMWARE_FAULTS_STORAGE_TRIAL_H

#include <stdbool.h>

#include "tests/firmware/faults/storage_acts.h"
#include "tests/support/disk/failing_disk.h"

enum { STORAGE_PEOPLE_SIZE = 400 };

/* The report of the process that acts. */
struct storage_report {
    bool done; /* the process reached its end */
    int told;  /* answer to the client: 0, or a negative errno with the fault below */
    bool out_of_service, lockdown, locked, may_return;
    int records_told, grants_told;
    long calls, writes, kernel_writes;
    struct iso_fault fault;
    char people[STORAGE_PEOPLE_SIZE];
    bool zoe;
};

/* The report of the process that reads the files. */
struct storage_found {
    bool done, sound, lockdown, locked, zoe;
    int records, grants;
    struct iso_fault fault; /* why the files do not open, or the flaw of the log */
    char people[STORAGE_PEOPLE_SIZE];
};

/* The call that fails, its act, and the kind of failure. */
struct storage_point {
    const struct storage_act *act;
    enum failing_disk_kind kind;
    long nth;     /* number of the call, from 1 */
    bool goes_on; /* the process continues when the disk works again */
};

/* The state before an act, and the state after it on a disk that works. */
struct storage_ends {
    struct storage_found before, after;
};

/* The reports of the present trial, in memory that the processes share. */
struct storage_trial {
    struct storage_report report;
    struct storage_found found;
};
extern struct storage_trial *storage_trial;

/* Allocates the shared memory. Returns false if it fails. */
bool storage_trial_prepare(void);

/* Runs the act, then lets another process read the files. Returns false if a process did not reach
 * its end. */
bool storage_try(const struct storage_point *point);

/* Prints a rule that did not hold, with the trial, and counts it. */
__attribute__((format(printf, 2, 3))) void storage_violation(const struct storage_point *point,
                                                             const char *format, ...);

/* Returns how often a rule did not hold so far. */
long storage_violations(void);

/* Judges the state after a call that failed. */
void storage_judge(const struct storage_point *point, const struct storage_ends *ends);

/* Judges the state after the process was killed. It has answered to no client, so the state must be
 * the one before the change or the one after it. */
void storage_judge_kill(const struct storage_point *point, const struct storage_ends *ends);

#endif
