/* One appliance of a rehearsal: its configuration, its state, and what it has reported about the
 * enrolment or the visit that is in progress. */
#ifndef SIM_DOOR_REHEARSAL_DOOR_H
#define SIM_DOOR_REHEARSAL_DOOR_H

#include "firmware/daemon/components.h"
#include "sim/base/virtual_clock.h"
#include "sim/door/shared_extraction.h"
#include "sim/door/trace.h"
#include "sim/door/visit.h"

/* What an appliance is made of. */
struct sim_rehearsal_setup {
    const char *slot;           /* the link that its sensor plays */
    const char *state;          /* an existing directory for gallery and log */
    const char *model, *metric; /* files */
    double threshold;           /* decision.threshold; NaN: that of the level */
    enum iso_level level;
};

struct sim_rehearsal_door {
    struct sim_virtual_clock *clock; /* borrowed */
    struct iso_config config;
    struct iso_components *parts;
    struct iso_appliance_borrowed lent;
    struct sim_shared_pipeline pipeline;
    struct sim_trace *trace; /* of the visit that is drawn; NULL: none is. Borrowed */
    struct iso_appliance *appliance;

    bool enrol_done;
    char enrol_result[64];
    struct sim_door_verdict verdict; /* the first of the visit */
    bool unlocked;                   /* at any time of the visit */
    uint64_t last_frame;             /* of the visit: its number */
};

/* Opens an appliance on the clock and starts it. It takes templates from `shared`. The door is all
 * zero before and stays where it is; close it, whatever is returned. Errors of iso_components_open
 * and of the appliance; -ENAMETOOLONG. */
int sim_rehearsal_door_open(struct sim_rehearsal_door *door,
                            const struct sim_rehearsal_setup *setup,
                            struct sim_virtual_clock *clock, struct sim_shared_extraction *shared,
                            struct sim_trace *trace, struct iso_fault *fault)
    __attribute__((warn_unused_result));
void sim_rehearsal_door_close(struct sim_rehearsal_door *door);

/* Claims the camera and begins to enrol somebody; errors of the appliance. Release the claim
 * (iso_appliance_release), whatever is returned. */
int sim_rehearsal_door_enrol(struct sim_rehearsal_door *door, const char *person,
                             bool allow_duplicate, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* A visit of so many frames begins. */
void sim_rehearsal_door_visit(struct sim_rehearsal_door *door, size_t n_frames);

/* Whether a verdict was given, or all frames of the visit were seen. */
bool sim_rehearsal_door_is_through(const struct sim_rehearsal_door *door);

#endif
