/* What goes wrong, and when: a schedule of faults that a seed decides, so that a run can be done
 * again. It says nothing of how a fault is brought about: whoever steps the appliance asks before
 * every step which faults there are. */
#ifndef TESTS_FIRMWARE_FAULTS_PLAN_H
#define TESTS_FIRMWARE_FAULTS_PLAN_H

#include <stdbool.h>
#include <stdint.h>

enum sim_fault {
    SIM_FAULT_SENSOR_DROP = 0, /* frames are lost */
    SIM_FAULT_SENSOR_LATE,     /* frames come when the fault ends, all at once */
    SIM_FAULT_SENSOR_TWICE,    /* frames are handed up twice */
    SIM_FAULT_SENSOR_CORRUPT,  /* frames hold what cannot be, or the computation fails */
    SIM_FAULT_SENSOR_FROZEN,   /* frames repeat to the bit, with times that go on */
    SIM_FAULT_SENSOR_BLANK,    /* every depth is zero */
    SIM_FAULT_SENSOR_GONE,     /* the device is unplugged */
    SIM_FAULT_CLOCK_STEP,      /* the date jumps; for one step */
    SIM_FAULT_DISK_FULL,
    SIM_FAULT_DISK_READ_ONLY,
    SIM_FAULT_DATABASE_BUSY, /* somebody else has the gallery's file locked */
    SIM_FAULT_BUS_GONE,      /* clients are gone, and none comes */
    SIM_FAULT_NO_MEMORY,     /* one allocation of each step fails, see value */
    SIM_FAULT_RESTART,       /* the appliance ends and begins anew; for one step */
    SIM_FAULTS
};

/* "sensor-drop", ...; NULL outside. */
const char *sim_fault_name(enum sim_fault fault);

enum { SIM_FAULT_EVENTS_MAX = 256 };

struct sim_fault_event {
    enum sim_fault fault;
    int first, last; /* steps */
    int64_t value;   /* clock-step: nanoseconds; no-memory: which allocation of the step; else 0 */
};

struct fault_plan {
    uint64_t seed;
    int n_steps, n_events;
    struct sim_fault_event events[SIM_FAULT_EVENTS_MAX]; /* by rising first step */
};

/* A fault begins some six steps after the one before it and lasts up to thirty, so that two or
 * three are there at a time; a fault does not overlap with itself. */
struct fault_plan fault_plan_draw(uint64_t seed, int n_steps);

/* The event of this fault that is there at a step, or NULL. */
const struct sim_fault_event *fault_plan_at(const struct fault_plan *plan, int step,
                                            enum sim_fault fault);

#endif
