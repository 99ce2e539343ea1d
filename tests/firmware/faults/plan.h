/* A schedule of faults: which fault occurs when. A seed determines it, so that a run can be
 * repeated. The plan does not say how to cause a fault: the program that steps the appliance asks
 * before every step which faults are present. */
#ifndef TESTS_FIRMWARE_FAULTS_PLAN_H
#define TESTS_FIRMWARE_FAULTS_PLAN_H

#include <stdbool.h>
#include <stdint.h>

enum sim_fault {
    SIM_FAULT_SENSOR_DROP = 0, /* frames are lost */
    SIM_FAULT_SENSOR_LATE,     /* frames are delayed until the fault ends, then come all at once */
    SIM_FAULT_SENSOR_TWICE,    /* frames are delivered twice */
    SIM_FAULT_SENSOR_CORRUPT,  /* frames have impossible values, or the computation fails */
    SIM_FAULT_SENSOR_FROZEN,   /* frames repeat bit by bit, with new time stamps */
    SIM_FAULT_SENSOR_BLANK,    /* every depth is zero */
    SIM_FAULT_SENSOR_GONE,     /* the device is unplugged */
    SIM_FAULT_CLOCK_STEP,      /* the date jumps; lasts one step */
    SIM_FAULT_DISK_FULL,
    SIM_FAULT_DISK_READ_ONLY,
    SIM_FAULT_DATABASE_BUSY, /* another process has locked the gallery's file */
    SIM_FAULT_BUS_GONE,      /* clients are gone, and no new client comes */
    SIM_FAULT_NO_MEMORY,     /* one allocation of each frame fails, see value */
    SIM_FAULT_RESTART,       /* the appliance ends and starts again; lasts one step */
    SIM_FAULTS
};

/* Returns "sensor-drop", ...; NULL for a number that is no fault. */
const char *sim_fault_name(enum sim_fault fault);

enum { SIM_FAULT_EVENTS_MAX = 256 };

struct sim_fault_event {
    enum sim_fault fault;
    int first, last; /* numbers of the first and the last step */
    int64_t value;   /* clock-step: nanoseconds; no-memory: number of allocations of a frame that
                        succeed before one fails; else 0 */
};

struct fault_plan {
    uint64_t seed;
    int n_steps, n_events;
    struct sim_fault_event events[SIM_FAULT_EVENTS_MAX]; /* sorted by first step */
};

/* Draws a plan. A fault begins about six steps after the previous one and lasts up to thirty steps,
 * so that two or three faults are present at a time. Two faults of the same kind do not overlap. */
struct fault_plan fault_plan_draw(uint64_t seed, int n_steps);

/* Returns the event of this fault that is present at a step, or NULL. */
const struct sim_fault_event *fault_plan_at(const struct fault_plan *plan, int step,
                                            enum sim_fault fault);

#endif
