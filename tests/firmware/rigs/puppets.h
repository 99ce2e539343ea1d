/* A sensor and a pipeline that a test moves by strings: frames that carry who is on them, and a
 * matcher that reads it.
 *
 * A face is a whole number. Two templates have the score 10 - |difference of their faces|. */
#ifndef TESTS_FIRMWARE_RIGS_PUPPETS_H
#define TESTS_FIRMWARE_RIGS_PUPPETS_H

#include <stdbool.h>
#include <stdint.h>

#include "core/base/clock.h"
#include "firmware/recognise/pipeline.h"
#include "firmware/sensor/sensor_supervisor.h"
#include "isotherm/template.h"

enum { PUPPET_ALGORITHM = 0x51, PUPPET_MODEL = 0xabc, PUPPET_FRAMES_MAX = 128 };

/* A template of that face, by that algorithm; it can be serialised and fused. */
struct iso_template puppet_template(int face, uint32_t algorithm);
int puppet_face_of(const struct iso_template *tmpl);

struct puppet_sensor {
    struct iso_clock clock;
    /* Frames to come; those whose time is not reached are not there yet. */
    struct {
        int64_t t_ns;
        enum iso_capture capture;
        int face;
        int right_mm; /* where the face is; -999..999 */
    } frames[PUPPET_FRAMES_MAX];
    int n_frames, next;
    uint64_t forgotten;                      /* frames before those, all of them fetched */
    int open_error, start_error, wait_error; /* what the next call of each fails with; stays */
    const char *text;                        /* what it says then; NULL: something */
    double rate_hz;                          /* nominal; 0: it does not say */
    bool scene_moves;                        /* something but the face, every second */
    bool streams;                            /* it has no next_due_ns: silence is a fault */
    int descriptor;                          /* streams: its poll_fd; 0: it has none */
    int opened, closed;                      /* how often it was */
};

/* Opens this sensor whenever it is asked to; `sensor` must outlive it. */
struct iso_sensor_source puppet_sensor_source(struct puppet_sensor *sensor);

/* One more frame: a usable face, or (face 0) what else the extraction shall find. */
void puppet_sensor_add(struct puppet_sensor *sensor, int64_t t_ns, int face,
                       enum iso_capture capture);

/* The same, of a face so far to the right. */
void puppet_sensor_add_at(struct puppet_sensor *sensor, int64_t t_ns, int face,
                          enum iso_capture capture, int right_mm);

/* A frame with a face (not 0) has a fitted head, 700 mm from the sensor, whatever the outcome;
 * coverage and expression of a good enrolment, unless they are set here. */
struct puppet_pipeline {
    int extract_error, search_error;
    bool raving; /* searches find people that there are not, with scores that are no numbers */
    double yaw_rad, expression, uncovered;
    char sensor[32];         /* as the last extraction was told */
    enum iso_face_seen seen; /* what the image says of every frame */
};

struct iso_pipeline puppet_pipeline(struct puppet_pipeline *pipeline);

#endif
