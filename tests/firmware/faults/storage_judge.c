#include "tests/firmware/faults/storage_trial.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static long violations;

void storage_violation(const struct storage_point *point, const char *format, ...)
{
    va_list arguments;
    violations++;
    printf("%s, call %ld %s, %s: ", point->act->name, point->nth, failing_disk_names[point->kind],
           point->goes_on ? "goes on" : "restart");
    va_start(arguments, format);
    vprintf(format, arguments);
    va_end(arguments);
    printf("\n    told %d '%s'\n    memory '%s'%s\n    found  '%s' %s\n",
           storage_trial->report.told, storage_trial->report.fault.text,
           storage_trial->report.people,
           storage_trial->report.out_of_service ? " (out of service)" : "",
           storage_trial->found.people, storage_trial->found.fault.text);
}

long storage_violations(void)
{
    return violations;
}

static void judge_people(const struct storage_point *point, const struct storage_ends *ends)
{
    const struct storage_report *report = &storage_trial->report;
    const struct storage_found *found = &storage_trial->found;
    const bool before = strcmp(found->people, ends->before.people) == 0;
    const bool after = strcmp(found->people, ends->after.people) == 0;
    const bool has_memory = !point->act->opens || point->goes_on;
    const bool is_told = !report->out_of_service && !point->act->opens;
    if (!before && !after) {
        storage_violation(point, "somebody is lost, or back");
    } else if (!report->told && !after) {
        storage_violation(point, "told that it is done, and it is not");
    } else if (report->told && !report->out_of_service && !before) {
        storage_violation(point, "told that it is not done, and it is");
    }
    if (is_told && report->may_return) {
        storage_violation(point, "a power cut may bring the state from before back");
    }
    if (has_memory && (point->goes_on || !report->out_of_service) &&
        (strcmp(found->people, report->people) != 0 || found->zoe != report->zoe)) {
        storage_violation(point, "the memory differs from the disk");
    }
}

/* A record, or a group of records, may be there if the store could not remove it again because the
 * disk did not allow writing. */
static void judge_log(const struct storage_point *point)
{
    const struct storage_report *report = &storage_trial->report;
    const struct storage_found *found = &storage_trial->found;
    const int unknown = point->act->unknown_records;
    const int spare = point->kind >= FAILING_DISK_BROKEN && !point->goes_on ? unknown : 0;
    if (found->records < report->records_told || found->records > report->records_told + spare) {
        storage_violation(point, "%d records were said to be written, there are %d",
                          report->records_told, found->records);
    }
    if (found->grants < report->grants_told) {
        storage_violation(point, "somebody was let in without a record");
    }
}

static void judge_door(const struct storage_point *point, const struct storage_ends *ends)
{
    const struct storage_report *report = &storage_trial->report;
    const struct storage_found *found = &storage_trial->found;
    const bool told_done = !report->told && found->lockdown != ends->after.lockdown;
    const bool told_not = report->told && found->lockdown != ends->before.lockdown &&
                          !point->act->may_be_stricter && point->kind != FAILING_DISK_DEAD;
    if (told_done || told_not) {
        storage_violation(point, "lockdown: %d", found->lockdown);
    }
    if (point->goes_on && !point->act->opens &&
        (found->lockdown != report->lockdown || found->locked != report->locked)) {
        storage_violation(point, "lockdown and lock-out were %d %d in memory and are %d %d on disk",
                          report->lockdown, report->locked, found->lockdown, found->locked);
    }
}

static void judge_words(const struct storage_point *point)
{
    const struct storage_report *report = &storage_trial->report;
    if (report->told && !point->act->opens && !strstr(report->fault.text, "the disk refused: ")) {
        storage_violation(point, "the fault does not say that the disk refused");
    }
}

void storage_judge(const struct storage_point *point, const struct storage_ends *ends)
{
    judge_people(point, ends);
    judge_log(point);
    judge_door(point, ends);
    judge_words(point);
}

void storage_judge_kill(const struct storage_point *point, const struct storage_ends *ends)
{
    const struct storage_found *found = &storage_trial->found;
    if (!found->done) {
        storage_violation(point, "the files do not open");
        return;
    }
    if (strcmp(found->people, ends->before.people) != 0 &&
        strcmp(found->people, ends->after.people) != 0) {
        storage_violation(point, "somebody is lost, or back");
    }
    if (found->records < ends->before.records) {
        storage_violation(point, "records are lost");
    }
    if (found->lockdown != ends->before.lockdown && found->lockdown != ends->after.lockdown) {
        storage_violation(point, "lockdown: %d", found->lockdown);
    }
}
