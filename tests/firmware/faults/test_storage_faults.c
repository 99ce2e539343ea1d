/* The Nth call that changes a file fails, for every N until an act of the appliance makes no more
 * calls, in every way in which a disk fails (tests/support/disk/failing_disk.h). Each time two
 * things are tried, with processes of their own:
 *
 *   restart   the process ends behind the act; another one opens what it has left
 *   go on     the disk works again, the process goes on for a while, enrols one person more and
 *             ends; another one opens what it has left
 *
 * What is found has to be what the client was told, and what the process had in its memory;
 * gallery, log and anchors have to open; nobody may be lost or back.
 *
 * usage: storage_faults [STRIDE [ACT]]     exit status 0 if everything was as it has to be
 *
 * With a stride of 3, each call fails in two of the six ways, in one of those that last for one
 * call and in one of the others. */
#include <errno.h>
#include <ftw.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/appliance/administration.h"
#include "firmware/keys/heads.h"
#include "firmware/keys/key_ring.h"
#include "tests/firmware/faults/fault_tally.h"
#include "tests/firmware/faults/storage_acts.h"
#include "tests/firmware/rigs/stores.h"
#include "tests/support/disk/failing_disk.h"
#include "tests/support/scratch.h"

enum { PEOPLE_SIZE = 400, CALLS_MAX = 5000 };

/* What a process that acts has to say, and one that looks. */
struct report {
    bool done; /* it came to its end */
    int told;
    bool out_of_service, lockdown, locked, may_return;
    int records_told, grants_told;
    long calls, writes, kernel_writes;
    struct iso_fault fault;
    char people[PEOPLE_SIZE];
    bool zoe;
};

struct found {
    bool done, sound, lockdown, locked, zoe;
    int records, grants;
    struct iso_fault fault; /* why it does not open */
    char people[PEOPLE_SIZE];
};

/* One trial. */
struct point {
    const struct storage_act *act;
    enum failing_disk_kind kind;
    long nth;
    bool goes_on;
};

static struct shared {
    struct report report;
    struct found found;
} * shared;

static char directory[64];
static struct {
    long points, violations;
} total;

/* ---- the process that acts ---- */

static void go_on(struct storage_world *w)
{
    struct rig *rig = w->rig;
    struct iso_fault fault = {.text = ""};
    const struct iso_audit_record record = iso_audit_record_of("y");
    const struct iso_person zoe = {.name = "zoe", .enrolled_s = 1};
    const struct iso_template tmpl = puppet_template(170, PUPPET_ALGORITHM);
    const char *remark = NULL;
    rig_run(rig, 2500);
    struct iso_audit_report report = {
        .sound = false}; /* what is in memory of the log is what is on the disk */
    if (iso_audit_verify(rig->audit, 0, NULL, NULL, &report, &fault) || !report.sound) {
        fprintf(stderr, "the log is not sound: %s%s\n", fault.text, report.flaw);
        _exit(1);
    }
    if (iso_gallery_add(rig->gallery, &zoe, &tmpl, &fault) ||
        iso_audit_append(rig->audit, &record, &fault) ||
        iso_appliance_rotate_keys(rig->appliance, NULL, &remark, &fault)) {
        fprintf(stderr, "does not go on: %s\n", fault.text);
        _exit(1);
    }
}

static void end_process(struct storage_world *w)
{
    struct rig *rig = w->rig;
    iso_appliance_stop(rig->appliance);
    iso_appliance_free(rig->appliance);
    iso_audit_close(rig->audit);
    iso_gallery_close(rig->gallery);
    stores_forget();
}

static void remember(struct storage_world *w, struct report *report)
{
    report->records_told = w->records_told;
    report->grants_told = w->grants_told;
    if (w->rig) {
        const struct iso_appliance_status status = iso_appliance_status(w->rig->appliance);
        storage_people(w->rig->gallery, report->people, sizeof report->people);
        report->zoe = iso_gallery_find(w->rig->gallery, "zoe") != NULL;
        report->lockdown = status.lockdown;
        report->locked = status.lockout_ns > 0;
        report->out_of_service = iso_gallery_state(w->rig->gallery, NULL) != 0;
        if (report->out_of_service && iso_gallery_everybody(w->rig->gallery).n_entries > 0) {
            fprintf(stderr, "out of service, and people are candidates\n");
            _exit(1);
        }
    }
}

static void act(const struct point *point)
{
    struct storage_world w = {.file = -1};
    struct report *report = &shared->report;
    (void)snprintf(w.directory, sizeof w.directory, "%s", directory);
    point->act->prepare(&w);
    failing_disk_arm(point->kind, point->nth);
    report->told = point->act->act(&w, &report->fault);
    report->writes = failing_disk_writes();
    report->kernel_writes = failing_disk_kernel_writes();
    remember(&w, report);
    report->may_return = failing_disk_journal_may_return();
    report->calls = failing_disk_heal();
    if (point->goes_on) {
        const bool was_lost = report->out_of_service;
        if (!w.rig) {
            storage_world_start(&w);
        }
        go_on(&w);
        remember(&w, report);
        report->out_of_service = was_lost;
        end_process(&w);
    }
    report->done = true;
}

/* ---- the process that looks ---- */

static int count(void *context, const char *line)
{
    struct found *found = context;
    found->records += strstr(line, "\"event\":\"x\"") != NULL;
    found->grants += strstr(line, "\"event\":\"grant\"") != NULL;
    return 0;
}

/* The stores one by one, for the fault of the one that does not open. */
static bool opens(struct found *found)
{
    struct iso_gallery *gallery = NULL;
    struct iso_gallery_options options = stores_gallery(directory);
    options.capacity = 10;
    if (iso_gallery_open(&options, &gallery, &found->fault)) {
        return false;
    }
    const int error = iso_heads_check(iso_key_ring_board(options.ring), &found->fault);
    iso_gallery_close(gallery);
    stores_forget(); /* what was found when the ring was opened is found anew */
    return error == 0;
}

static void look(void)
{
    struct storage_world w = {.file = -1};
    struct found *found = &shared->found;
    struct iso_audit_report report;
    (void)snprintf(w.directory, sizeof w.directory, "%s", directory);
    if (!opens(found)) {
        return;
    }
    storage_world_start(&w);
    if (iso_heads_check(iso_key_ring_board(stores_ring(directory)), &found->fault)) {
        return; /* no fault of the disk is taken for an older file */
    }
    const struct iso_appliance_status status = iso_appliance_status(w.rig->appliance);
    storage_people(w.rig->gallery, found->people, sizeof found->people);
    found->zoe = iso_gallery_find(w.rig->gallery, "zoe") != NULL;
    found->lockdown = status.lockdown;
    found->locked = status.lockout_ns > 0;
    if (iso_audit_verify(w.rig->audit, 0, NULL, NULL, &report, &found->fault) ||
        iso_audit_read(w.rig->audit, 1, UINT32_MAX, count, found)) {
        return;
    }
    found->sound = report.sound;
    if (!report.sound) {
        (void)iso_fault_set(&found->fault, -EBADMSG, "%s", report.flaw);
    }
    found->done = true;
}

/* ---- trials ---- */

static bool run(void (*process)(const struct point *point), const struct point *point)
{
    int status = 0;
    (void)fflush(NULL);
    const pid_t pid = fork();
    if (pid == 0) {
        process(point);
        _exit(0);
    }
    return pid > 0 && waitpid(pid, &status, 0) == pid && WIFEXITED(status) &&
           WEXITSTATUS(status) == 0;
}

static void look_at(const struct point *point)
{
    (void)point;
    look();
}

static int remove_entry(const char *path, const struct stat *status, int type, struct FTW *walk)
{
    (void)status, (void)type, (void)walk;
    return remove(path);
}

/* Acts, and has somebody look at what is left. False: a process did not come to its end. */
static bool try(const struct point *point)
{
    *shared = (struct shared){.report = {.done = false}};
    const char *place = getenv("TMPDIR");
    (void)snprintf(directory, sizeof directory, "%s/isotherm-storage-XXXXXX",
                   place ? place : "/tmp");
    if (!mkdtemp(directory)) {
        perror(directory);
        exit(2);
    }
    const bool acted = run(act, point) && shared->report.done;
    const bool looked = run(look_at, point) && shared->found.done;
    (void)nftw(directory, remove_entry, 16, FTW_DEPTH | FTW_PHYS);
    return acted && looked;
}

__attribute__((format(printf, 2, 3))) static void violation(const struct point *point,
                                                            const char *format, ...)
{
    va_list arguments;
    total.violations++;
    printf("%s, call %ld %s, %s: ", point->act->name, point->nth, failing_disk_names[point->kind],
           point->goes_on ? "goes on" : "restart");
    va_start(arguments, format);
    vprintf(format, arguments);
    va_end(arguments);
    printf("\n    told %d '%s'\n    memory '%s'%s\n    found  '%s' %s\n", shared->report.told,
           shared->report.fault.text, shared->report.people,
           shared->report.out_of_service ? " (out of service)" : "", shared->found.people,
           shared->found.fault.text);
}

/* What is there before an act, and after one with a disk that works. */
struct ends {
    struct found before, after;
};

static void judge_people(const struct point *point, const struct ends *ends)
{
    const struct report *report = &shared->report;
    const struct found *found = &shared->found;
    const bool before = strcmp(found->people, ends->before.people) == 0;
    const bool after = strcmp(found->people, ends->after.people) == 0;
    const bool has_memory = !point->act->opens || point->goes_on;
    const bool is_told = !report->out_of_service && !point->act->opens;
    if (!before && !after) {
        violation(point, "somebody is lost, or back");
    } else if (!report->told && !after) {
        violation(point, "told that it is done, and it is not");
    } else if (report->told && !report->out_of_service && !before) {
        violation(point, "told that it is not done, and it is");
    }
    if (is_told && report->may_return) {
        violation(point, "a power cut may bring the state from before back");
    }
    if (has_memory && (point->goes_on || !report->out_of_service) &&
        (strcmp(found->people, report->people) != 0 || found->zoe != report->zoe)) {
        violation(point, "the memory is not what is on the disk");
    }
}

/* A record, or a group, that could not be taken away again may be there, if the disk was not to be
 * written. */
static void judge_log(const struct point *point)
{
    const struct report *report = &shared->report;
    const struct found *found = &shared->found;
    const int unknown = point->act->unknown_records;
    const int spare = point->kind >= FAILING_DISK_BROKEN && !point->goes_on ? unknown : 0;
    if (found->records < report->records_told || found->records > report->records_told + spare) {
        violation(point, "%d records were said to be written, there are %d", report->records_told,
                  found->records);
    }
    if (found->grants < report->grants_told) {
        violation(point, "somebody was let in without a record");
    }
}

static void judge_door(const struct point *point, const struct ends *ends)
{
    const struct report *report = &shared->report;
    const struct found *found = &shared->found;
    const bool told_done = !report->told && found->lockdown != ends->after.lockdown;
    const bool told_not = report->told && found->lockdown != ends->before.lockdown &&
                          !point->act->may_be_stricter && point->kind != FAILING_DISK_DEAD;
    if (told_done || told_not) {
        violation(point, "lockdown: %d", found->lockdown);
    }
    if (point->goes_on && !point->act->opens &&
        (found->lockdown != report->lockdown || found->locked != report->locked)) {
        violation(point, "the door was shut, or is (%d %d, %d %d)", report->lockdown,
                  report->locked, found->lockdown, found->locked);
    }
}

static void judge_words(const struct point *point)
{
    const struct report *report = &shared->report;
    if (report->told && !point->act->opens && !strstr(report->fault.text, "the disk refused: ")) {
        violation(point, "a fault of the disk is not told as one");
    }
}

static void judge(const struct point *point, const struct ends *ends)
{
    judge_people(point, ends);
    judge_log(point);
    judge_door(point, ends);
    judge_words(point);
}

/* Whoever was killed told nobody anything: what is left is as before the change or as after it. */
static void judge_kill(const struct point *point, const struct ends *ends)
{
    const struct found *found = &shared->found;
    if (!found->done) {
        violation(point, "what is left does not open");
        return;
    }
    if (strcmp(found->people, ends->before.people) != 0 &&
        strcmp(found->people, ends->after.people) != 0) {
        violation(point, "somebody is lost, or back");
    }
    if (found->records < ends->before.records) {
        violation(point, "records are lost");
    }
    if (found->lockdown != ends->before.lockdown && found->lockdown != ends->after.lockdown) {
        violation(point, "lockdown: %d", found->lockdown);
    }
}

static bool kill_at(struct point *point, const struct ends *ends)
{
    point->goes_on = false;
    (void)!try(point);
    if (shared->report.done) {
        return false;
    }
    judge_kill(point, ends);
    total.points++;
    return true;
}

/* One call fails in one way. False: the act does not make so many calls. */
static bool fail_at(struct point *point, const struct ends *ends)
{
    if (point->kind >= FAILING_DISK_KILLS) {
        return kill_at(point, ends);
    }
    for (int i = 0; i < 2; i++) {
        point->goes_on = i == 1;
        const bool ended = try(point);
        if (ended && shared->report.calls < point->nth) {
            return false;
        }
        if (ended) {
            judge(point, ends);
        } else {
            violation(point, shared->report.done ? "what is left does not open" : "does not end");
        }
        total.points++;
    }
    return true;
}

static int do_nothing(struct storage_world *w, struct iso_fault *fault)
{
    (void)w, (void)fault;
    return 0;
}

/* How many calls the act makes. */
static long learn(const struct storage_act *of, struct ends *ends)
{
    struct storage_act nothing = *of;
    const struct point before = {&nothing, FAILING_DISK_ONCE, CALLS_MAX, false};
    const struct point after = {of, FAILING_DISK_ONCE, CALLS_MAX, false};
    nothing.act = do_nothing;
    if (!try(&before)) {
        violation(&before, "does not work with a disk that does");
    }
    ends->before = shared->found;
    if (!try(&after) || shared->report.told) {
        violation(&after, "does not work with a disk that does");
    }
    if (shared->report.kernel_writes >= 0 &&
        shared->report.kernel_writes != shared->report.writes) {
        violation(&after, "%ld writes, of which the test sees %ld", shared->report.kernel_writes,
                  shared->report.writes);
    }
    ends->after = shared->found;
    return shared->report.calls;
}

int main(int argc, char **argv)
{
    const long stride = argc > 1 ? atol(argv[1]) : 1;
    const char *only = argc > 2 ? argv[2] : "";
    size_t acts = 0;
    shared = mmap(NULL, sizeof *shared, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (stride < 1 || shared == MAP_FAILED) {
        fputs("usage: storage_faults [STRIDE [ACT]]\n", stderr);
        return 2;
    }
    for (size_t i = 0; i < storage_acts_n; i++) {
        struct ends ends;
        if (!strstr(storage_acts[i].name, only)) {
            continue;
        }
        const long calls = learn(&storage_acts[i], &ends), before = total.violations;
        struct point point = {.act = &storage_acts[i]};
        for (int kind = 0; kind < FAILING_DISK_KINDS; kind++) {
            point.kind = (enum failing_disk_kind)kind;
            point.nth = 1 + kind % stride;
            while (fail_at(&point, &ends)) {
                point.nth += stride;
            }
        }
        printf("%-14s %4ld calls, violations %ld\n", storage_acts[i].name, calls,
               total.violations - before);
        acts++;
    }
    fault_tally_print("storage faults", total.points, (long)acts, total.violations);
    return total.violations > 0 || total.points == 0;
}
