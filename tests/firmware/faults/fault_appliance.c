#include "tests/firmware/faults/fault_step.h"

#include <errno.h>

#include "tests/firmware/rigs/stores.h"
#include "tests/support/disk/broken_disk.h"
#include "tests/support/memory/scarce_memory.h"

void world_end_appliance(struct world *w)
{
    struct rig *rig = w->rig;
    iso_appliance_stop(rig->appliance);
    iso_appliance_free(rig->appliance);
    iso_audit_close(rig->audit);
    iso_gallery_close(rig->gallery);
    rig->appliance = NULL;
    rig->borrowed.audit = rig->audit = NULL;
    rig->borrowed.gallery = rig->gallery = NULL;
    w->running = false;
    w->oracle.claimed = false;
    w->oracle.n_seen = 0;
    rig->sensor.next = rig->sensor.n_frames; /* frames that were not fetched are lost */
    w->last_actor = NOBODY;                  /* the next process does not know the last frame */
    total.restarts++;
    /* A broken disk could not store this state, so the restart loses it. */
    if (broken_disk.error || w->rig->now_ns - w->oracle.broken_ns < 3 * ISO_NS_PER_S) {
        struct oracle *o = &w->oracle;
        o->lockdown = false;
        o->failures = o->attacks = o->locks = 0;
        o->locked_until_ns = o->failed_ns = 0;
    }
}

void world_begin_appliance(struct world *w)
{
    struct rig *rig = w->rig;
    struct iso_fault fault = {.text = ""};
    const struct iso_gallery_options gallery = stores_gallery(rig->directory);
    struct iso_audit_options audit = stores_audit(rig->directory);
    audit.sync = false;
    int error = iso_gallery_open(&gallery, &rig->gallery, &fault);
    if (!error) {
        error = iso_audit_open(&audit, &rig->borrowed.times, &rig->audit, &fault);
    }
    rig->borrowed.gallery = rig->gallery;
    rig->borrowed.audit = rig->audit;
    if (!error) {
        error = iso_appliance_new(&rig->borrowed, &rig->appliance);
    }
    if (!error) {
        error = iso_appliance_start(rig->appliance, &fault);
    }
    if (error) {
        if (error == -EBADMSG) {
            world_broken(w, "the stored files are damaged: %s", fault.text);
        }
        iso_appliance_free(rig->appliance);
        iso_audit_close(rig->audit);
        iso_gallery_close(rig->gallery);
        rig->appliance = NULL;
        rig->audit = NULL;
        rig->gallery = NULL;
        total.absences++;
    }
    w->running = error == 0;
    w->oracle.sighted_ns = w->rig->now_ns; /* an opened camera has a second to start */
}

void world_pass_frame(struct world *w)
{
    const struct sim_fault_event *scarce = fault_plan_at(&w->plan, w->step, SIM_FAULT_NO_MEMORY);
    if (!w->running) {
        w->rig->now_ns += FRAME_MS * ISO_NS_PER_MS;
        w->rig->wall_ns += FRAME_MS * ISO_NS_PER_MS;
        return;
    }
    scarce_memory_left = scarce ? (long)scarce->value : -1;
    rig_run(w->rig, FRAME_MS);
    scarce_memory_left = -1;
}
