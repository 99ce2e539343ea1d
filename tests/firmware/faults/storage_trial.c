#include "tests/firmware/faults/storage_trial.h"

#include <errno.h>
#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "firmware/appliance/administration/administration.h"
#include "firmware/keys/heads.h"
#include "firmware/keys/key_ring.h"
#include "tests/firmware/rigs/stores.h"

struct storage_trial *storage_trial;

static char directory[64];

bool storage_trial_prepare(void)
{
    void *memory = mmap(NULL, sizeof *storage_trial, PROT_READ | PROT_WRITE,
                        MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    storage_trial = memory == MAP_FAILED ? NULL : memory;
    return storage_trial != NULL;
}

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
    struct iso_audit_report report = {.sound = false};
    /* The records that the log has in memory must be the records on the disk. */
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

static void remember(struct storage_world *w, struct storage_report *report)
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

static void act(const struct storage_point *point)
{
    struct storage_world w = {.file = -1};
    struct storage_report *report = &storage_trial->report;
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

/* ---- the process that reads ---- */

static int count(void *context, const char *line)
{
    struct storage_found *found = context;
    found->records += strstr(line, "\"event\":\"x\"") != NULL;
    found->grants += strstr(line, "\"event\":\"grant\"") != NULL;
    return 0;
}

/* Opens the stores one by one, to get the fault of the store that does not open. */
static bool opens(struct storage_found *found)
{
    struct iso_gallery *gallery = NULL;
    struct iso_gallery_options options = stores_gallery(directory);
    options.capacity = 10;
    if (iso_gallery_open(&options, &gallery, &found->fault)) {
        return false;
    }
    const int error = iso_heads_check(iso_key_ring_board(options.ring), &found->fault);
    iso_gallery_close(gallery);
    stores_forget(); /* read the state of the ring again, not the remembered one */
    return error == 0;
}

static void look(void)
{
    struct storage_world w = {.file = -1};
    struct storage_found *found = &storage_trial->found;
    struct iso_audit_report report;
    (void)snprintf(w.directory, sizeof w.directory, "%s", directory);
    if (!opens(found)) {
        return;
    }
    storage_world_start(&w);
    if (iso_heads_check(iso_key_ring_board(stores_ring(directory)), &found->fault)) {
        return; /* no fault of the disk may be reported as an older file */
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

/* ---- the trial ---- */

static bool run(void (*process)(const struct storage_point *point),
                const struct storage_point *point)
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

static void look_at(const struct storage_point *point)
{
    (void)point;
    look();
}

static int remove_entry(const char *path, const struct stat *status, int type, struct FTW *walk)
{
    (void)status, (void)type, (void)walk;
    return remove(path);
}

bool storage_try(const struct storage_point *point)
{
    *storage_trial = (struct storage_trial){.report = {.done = false}};
    const char *place = getenv("TMPDIR");
    (void)snprintf(directory, sizeof directory, "%s/isotherm-storage-XXXXXX",
                   place ? place : "/tmp");
    if (!mkdtemp(directory)) {
        perror(directory);
        exit(2);
    }
    const bool acted = run(act, point) && storage_trial->report.done;
    const bool looked = run(look_at, point) && storage_trial->found.done;
    (void)nftw(directory, remove_entry, 16, FTW_DEPTH | FTW_PHYS);
    return acted && looked;
}
