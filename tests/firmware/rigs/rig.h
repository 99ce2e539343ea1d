/* An appliance for tests. Sensor and pipeline are puppets, and the door is the null door. Gallery
 * and audit log are real, in a directory of their own. The clock jumps from one due time to the
 * next. */
#ifndef TESTS_FIRMWARE_RIGS_RIG_H
#define TESTS_FIRMWARE_RIGS_RIG_H

#include "firmware/appliance/appliance.h"
#include "tests/firmware/rigs/puppets.h"

/* The time zones of the system. */
extern const struct iso_zone_source rig_zones;

struct rig {
    char *directory;
    int64_t now_ns, wall_ns;
    int64_t asleep_ns;        /* how long the machine was suspended so far */
    struct iso_config config; /* the defaults, with thresholds for the scores of the puppets */
    struct puppet_sensor sensor;
    struct puppet_pipeline puppet;
    struct iso_door_io *door_io;
    struct iso_gallery *gallery;
    struct iso_audit *audit;
    struct iso_live_settings settings; /* of `config`; the file "settings" of the directory */
    char settings_path[256];
    struct iso_appliance_borrowed borrowed;
    struct iso_appliance *appliance;
    char warned[256]; /* last line for the system's log that was a warning or worse */
    char told[4096];  /* reports: "door locked start; visit allow anna match 2; ..." */
};

/* The capacity, in people, of the galleries of rigs that are set up from now on; 0: as in stores.h.
 */
extern int rig_capacity;

/* Options of the log of such a rig. All zero: one segment, which is not synchronised. */
extern struct rig_log {
    bool sync;
    uint64_t segment_bytes;
    int segments;
} rig_log;

/* cmocka set-up and tear-down: *state is a struct rig, which is not started. Its clock shows 100 s,
 * its date is 2026-11-21T08:33:20Z. */
int rig_setup(void **state);

/* Like rig_setup, in a directory of the caller, whose name is from malloc. The tear-down removes
 * the directory with all its files, and frees the name. */
int rig_setup_in(void **state, char *directory);
int rig_teardown(void **state);

/* Starts the appliance and discards its reports. */
void rig_start(struct rig *rig);

/* Like rig_start; afterwards a client has the claim. */
void rig_start_claimed(struct rig *rig);

/* Starts the enrolment of a request, for the client that has the claim. */
void rig_start_enrolling(struct rig *rig, const struct iso_enroll_request *request);

/* Adds a person to the gallery, with one template of this face. */
void rig_enrol(struct rig *rig, const char *person, int face);

/* Shows n usable frames of a face, 33 ms apart, the first one in 33 ms. */
void rig_show(struct rig *rig, int face, int n);

/* Shows one usable frame of a face at this position, in `in_ms`. */
void rig_show_at(struct rig *rig, int face, int right_mm, int64_t in_ms);

/* Shows n frames without a usable face. */
void rig_show_unusable(struct rig *rig, enum iso_capture capture, int n);

/* Steps the appliance until this time has passed. */
void rig_run(struct rig *rig, int64_t ms);

/* Returns the reports since the last call. The text is valid until the next call. */
const char *rig_news(struct rig *rig);

bool rig_relay(const struct rig *rig);

/* Returns the last record of the audit log that has this event; "" if there is none. The text is
 * valid until the next call. */
const char *rig_record(struct rig *rig, const char *event);

/* From now on no file of this process can grow. */
void rig_fill_disk(void);

/* From now on no file of this process can be written at this offset or behind it. */
void rig_fill_disk_from(off_t bytes);

/* Ends the effect of both. */
void rig_free_disk(void);

#endif
