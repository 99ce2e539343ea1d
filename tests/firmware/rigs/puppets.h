/* A sensor and a pipeline that a test controls. The frames of the sensor carry the number of the
 * face in them, and the pipeline reads this number.
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

/* Makes a template of that face, by that algorithm. It can be serialised and fused. */
struct iso_template puppet_template(int face, uint32_t algorithm);
int puppet_face_of(const struct iso_template *tmpl);

struct puppet_sensor {
    struct iso_clock clock;
    /* All frames, in the order of their times. A frame is available from its time on. frames[next]
     * is the next one that is fetched. */
    struct {
        int64_t t_ns;
        enum iso_capture capture;
        int face;
        int right_mm; /* position of the face, -999..999 */
    } frames[PUPPET_FRAMES_MAX];
    int n_frames, next;
    uint64_t forgotten; /* number of frames before these; all of them were fetched */
    int open_error, start_error, wait_error; /* error of every next call of each operation */
    const char *text;    /* text of an open_error or a wait_error; NULL: a text of the puppet */
    double rate_hz;      /* nominal rate; 0: unknown */
    bool scene_moves;    /* the scene around the face moves every second */
    bool has_room;       /* frames are 40 x 30: a room, half of which a face covers */
    int64_t interval_ns; /* at most one frame in this time is wanted; 0, as after a start: all */
    int64_t handed_ns;   /* time of the last frame that was fetched */
    bool streams;        /* it has no next_due_ns; silence is a fault */
    int descriptor;      /* if it streams: its poll_fd; 0: it has none */
    int opened, closed;  /* how often it was opened and closed */
};

/* A source that opens this sensor at every request. `sensor` must outlive it. */
struct iso_sensor_source puppet_sensor_source(struct puppet_sensor *sensor);

/* Adds a frame: a usable face, or (face 0) the other outcome that the extraction shall return. */
void puppet_sensor_add(struct puppet_sensor *sensor, int64_t t_ns, int face,
                       enum iso_capture capture);

/* Like puppet_sensor_add, with the face this far to the right. */
void puppet_sensor_add_at(struct puppet_sensor *sensor, int64_t t_ns, int face,
                          enum iso_capture capture, int right_mm);

/* The extraction of a frame with a face (not 0) returns a fitted head 700 mm from the sensor,
 * whatever the outcome. Coverage and expression are those of a good enrolment, unless they are set
 * here. */
struct puppet_pipeline {
    int extract_error, search_error;
    int extracted; /* number of extractions */
    bool raving;   /* searches find people who do not exist, with an infinite score */
    double yaw_rad, pitch_rad, expression, uncovered;
    enum iso_capture cue;    /* of every frame that is not usable */
    char sensor[32];         /* name of the sensor, as the last extraction got it */
    enum iso_face_seen seen; /* result of the image check for every frame */
};

struct iso_pipeline puppet_pipeline(struct puppet_pipeline *pipeline);

#endif
