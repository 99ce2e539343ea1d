/* One appliance of a rehearsal: its configuration, its state, and its reports about the current
 * enrolment or visit. */
#ifndef SIM_DOOR_REHEARSAL_DOOR_H
#define SIM_DOOR_REHEARSAL_DOOR_H

#include "firmware/daemon/components.h"
#include "sim/base/virtual_clock.h"
#include "sim/door/shared_extraction.h"
#include "sim/door/trace.h"
#include "sim/door/visit.h"

/* The inputs of an appliance. */
struct sim_rehearsal_setup {
    const char *slot;           /* the link whose target its sensor plays */
    const char *state;          /* an existing directory for gallery and log */
    const char *model, *metric; /* files */
    double threshold;           /* decision.threshold; NaN: that of the level */
    enum iso_level level;
    bool adapt; /* match.adapt */
};

struct sim_rehearsal_door {
    struct sim_virtual_clock *clock; /* borrowed */
    struct iso_config config;
    struct iso_components *parts;
    struct iso_appliance_borrowed lent;
    struct sim_shared_pipeline pipeline;
    struct sim_trace *trace; /* of the visit to draw; NULL: none. Borrowed */
    struct iso_appliance *appliance;

    bool enrol_done;
    char enrol_result[64];
    struct sim_door_verdict verdict; /* the first verdict of the visit */
    bool unlocked;                   /* at any time of the visit */
    uint64_t last_frame;             /* number of the visit's last frame */
};

/* Opens an appliance on the clock and starts it. It takes templates from `shared`. The door must
 * be all zero, must not be moved, and must be closed even if opening fails. Errors of
 * iso_components_open and of the appliance; -ENAMETOOLONG. */
int sim_rehearsal_door_open(struct sim_rehearsal_door *door,
                            const struct sim_rehearsal_setup *setup,
                            struct sim_virtual_clock *clock, struct sim_shared_extraction *shared,
                            struct sim_trace *trace, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Stops the appliance and frees everything that the door holds, but not the struct itself. A door
 * that is all zero is accepted. */
void sim_rehearsal_door_close(struct sim_rehearsal_door *door);

/* Claims the camera and begins to enrol a person. Errors of the appliance. Release the claim
 * (iso_appliance_release) even on failure. */
int sim_rehearsal_door_enrol(struct sim_rehearsal_door *door, const char *person,
                             bool allow_duplicate, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Waits until the metric is adapted to the present people, if the door adapts it. The daemon does
 * not wait; here the result must not depend on the speed of the machine. The error of the site's
 * statistics, with a fault. */
int sim_rehearsal_door_settle(struct sim_rehearsal_door *door, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Begins a visit of the given number of frames. */
void sim_rehearsal_door_visit(struct sim_rehearsal_door *door, size_t n_frames);

/* Whether a verdict was given or all frames of the visit were examined. */
bool sim_rehearsal_door_is_through(const struct sim_rehearsal_door *door);

#endif
