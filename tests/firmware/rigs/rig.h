/* An appliance on a rig: puppets for sensor and pipeline, the null door, real gallery and audit log
 * in a directory of its own, and a clock that jumps from one due time to the next. */
#ifndef TESTS_FIRMWARE_RIGS_RIG_H
#define TESTS_FIRMWARE_RIGS_RIG_H

#include "firmware/appliance/appliance.h"
#include "tests/firmware/rigs/puppets.h"

struct rig {
    char *directory;
    int64_t now_ns, wall_ns;
    int64_t asleep_ns;        /* how long the machine has been suspended so far */
    struct iso_config config; /* the defaults, with thresholds for the puppets' scores */
    struct puppet_sensor sensor;
    struct puppet_pipeline puppet;
    struct iso_door_io *door_io;
    struct iso_gallery *gallery;
    struct iso_audit *audit;
    struct iso_appliance_borrowed borrowed;
    struct iso_appliance *appliance;
    char warned[256]; /* the last line for the system's log that was a warning or worse */
    char told[4096];  /* what it has reported: "door locked start; visit allow anna 2; ..." */
};

/* How many people the gallery of a rig holds that is set up from here on; 0: as in stores.h. */
extern int rig_capacity;

/* How the log of such a rig is kept: all zero is one segment that is not synchronised. */
extern struct rig_log {
    bool sync;
    uint64_t segment_bytes;
    int segments;
} rig_log;

/* cmocka set-up and tear-down: *state is a struct rig, not started. Time is 100 s, the date
 * 2026-11-21T08:33:20Z. */
int rig_setup(void **state);

/* The same in a directory of the caller's, of which the tear-down removes everything. */
int rig_setup_in(void **state, char *directory);
int rig_teardown(void **state);

/* Starts it; nobody is told of that. */
void rig_start(struct rig *rig);

/* The same, and a client has the claim. */
void rig_start_claimed(struct rig *rig);

/* Puts a face into the gallery. */
void rig_enrol(struct rig *rig, const char *person, int face);

/* n usable frames of a face, 33 ms apart, the first in 33 ms. */
void rig_show(struct rig *rig, int face, int n);

/* One usable frame of a face at such a place, so much later. */
void rig_show_at(struct rig *rig, int face, int right_mm, int64_t in_ms);

/* Frames without a usable face. */
void rig_show_unusable(struct rig *rig, enum iso_capture capture, int n);

/* Steps until so much time has passed. */
void rig_run(struct rig *rig, int64_t ms);

/* What was reported since the last call. */
const char *rig_news(struct rig *rig);

bool rig_relay(const struct rig *rig);

/* The audit log's last record that has this event; "" if there is none. Valid until the next call.
 */
const char *rig_record(struct rig *rig, const char *event);

/* From now on the audit log's file cannot grow. */
void rig_fill_disk(void);
void rig_free_disk(void);

#endif
