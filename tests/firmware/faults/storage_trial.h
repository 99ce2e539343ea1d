/* One trial of test_storage_faults.c: an act is done on a disk that fails, and another process
 * looks at what is left (storage_trial.c). Then what was found is judged (storage_judge.c). */
#ifndef TESTS_FIRMWARE_FAULTS_STORAGE_TRIAL_H
#define TESTS_FIRMWARE_FAULTS_STORAGE_TRIAL_H

#include <stdbool.h>

#include "tests/firmware/faults/storage_acts.h"
#include "tests/support/disk/failing_disk.h"

enum { STORAGE_PEOPLE_SIZE = 400 };

/* What the process that acts reports. */
struct storage_report {
    bool done; /* it came to its end */
    int told;  /* what the client was told: 0, or a negative errno with the fault below */
    bool out_of_service, lockdown, locked, may_return;
    int records_told, grants_told;
    long calls, writes, kernel_writes;
    struct iso_fault fault;
    char people[STORAGE_PEOPLE_SIZE];
    bool zoe;
};

/* What the process that looks finds. */
struct storage_found {
    bool done, sound, lockdown, locked, zoe;
    int records, grants;
    struct iso_fault fault; /* why it does not open */
    char people[STORAGE_PEOPLE_SIZE];
};

/* Which call of which act fails, and how. */
struct storage_point {
    const struct storage_act *act;
    enum failing_disk_kind kind;
    long nth;     /* from 1 */
    bool goes_on; /* the process goes on when the disk works again */
};

/* What is found before an act, and after one on a disk that works. */
struct storage_ends {
    struct storage_found before, after;
};

/* What the processes of the present trial report, in memory that they share. */
struct storage_trial {
    struct storage_report report;
    struct storage_found found;
};
extern struct storage_trial *storage_trial;

/* Makes the shared memory. False: there is none. */
bool storage_trial_prepare(void);

/* Acts, and has another process look at what is left. False: a process did not come to its end. */
bool storage_try(const struct storage_point *point);

/* Prints a rule that did not hold in this trial, with the trial, and counts it. */
__attribute__((format(printf, 2, 3))) void storage_violation(const struct storage_point *point,
                                                             const char *format, ...);

/* How often a rule did not hold so far. */
long storage_violations(void);

/* Judges what was found after a call that failed. */
void storage_judge(const struct storage_point *point, const struct storage_ends *ends);

/* Judges what is left by a process that was killed: it told nobody anything, so what is left is as
 * before the change or as after it. */
void storage_judge_kill(const struct storage_point *point, const struct storage_ends *ends);

#endif
