/* The frame in hand: the face in it, and whether it counts as evidence. */
#include <errno.h>
#include <limits.h>
#include <string.h>

#include "firmware/appliance/appliance_calls.h"
#include "firmware/appliance/appliance_claim.h"

/* A check that is turned off gets a limit that is never reached. */
static void init_liveness(struct iso_appliance *appliance)
{
    const struct iso_config_motion *motion = &appliance->borrowed.config->motion;
    struct iso_liveness_options options = iso_liveness_options_default();
    options.still_ns = motion->lifeless_ms > 0 ? motion->lifeless_ms * ISO_NS_PER_MS : INT64_MAX;
    options.frozen_frames = motion->frozen_frames > 0 ? motion->frozen_frames : INT_MAX;
    iso_liveness_init(&options, &appliance->face.liveness);
}

void iso__appliance_init_face(struct iso_appliance *appliance)
{
    const struct iso_config *config = appliance->borrowed.config;
    const struct iso_track_options track = {
        .lost_ns = config->decision.gap_ms * ISO_NS_PER_MS,
        .jump_mm_s = config->motion.jump_mm_s,
        .jump_rad_s = config->motion.jump_deg_s * ISO_RAD_PER_DEG,
        .still_mm_s = config->motion.still_mm_s,
        .still_rad_s = config->motion.still_deg_s * ISO_RAD_PER_DEG,
    };
    /* A later track has another number than all before, also if the settings change. */
    const uint64_t number = appliance->face.track.number;
    iso_track_init(&appliance->face.track, &track);
    appliance->face.track.number = number;
    init_liveness(appliance);
}

void iso__appliance_forget_face(struct iso_appliance *appliance)
{
    iso__appliance_decide_anew(appliance);
    iso_track_reset(&appliance->face.track);
}

void iso__appliance_complain(struct iso_appliance *appliance, const struct iso_fault *fault)
{
    if (!appliance->face.complaining) {
        iso__appliance_warn(appliance, fault);
    }
    appliance->face.complaining = true;
}

void iso__appliance_end_complaints(struct iso_appliance *appliance)
{
    appliance->face.complaining = false;
}

void iso__appliance_wipe_template(struct iso_appliance *appliance)
{
    iso_template_wipe(&appliance->face.extraction.tmpl);
}

int iso__appliance_extract(struct iso_appliance *appliance, const struct iso_frame *frame)
{
    const struct iso_pipeline *pipeline = &appliance->borrowed.pipeline;
    const int error = pipeline->ops->extract(
        pipeline->self, frame, appliance->sensor.supervisor.model, &appliance->face.extraction);
    if (error) {
        struct iso_fault fault;
        (void)iso_fault_set(&fault, error, "frame %llu: no template: %s",
                            (unsigned long long)frame->sequence, strerror(-error));
        iso__appliance_complain(appliance, &fault);
    }
    return error;
}

/* Whether a fitted face does not move as living ones do. A face that has not been seen for long
 * enough counts as living. */
static bool is_lifeless(struct iso_appliance *appliance, const struct iso_frame *frame)
{
    const struct iso_extraction *extraction = &appliance->face.extraction;
    if (appliance->face.motion.track != appliance->face.liveness_track) { /* another face */
        const struct iso_liveness_options options = appliance->face.liveness.options;
        iso_liveness_init(&options, &appliance->face.liveness);
        appliance->face.liveness_track = appliance->face.motion.track;
    }
    const struct iso_liveness_frame seen = {
        .t_ns = frame->t_ns,
        .camera_from_face = extraction->camera_from_face,
        .sigma_mm = extraction->sigma_mm[ISO_LM_NASION],
        .digest = iso_liveness_digest(frame, extraction->camera_from_face.translation_mm),
    };
    return iso_liveness_feed(&appliance->face.liveness, &seen) == ISO_LIVENESS_STILL;
}

enum iso_capture iso__appliance_judge(struct iso_appliance *appliance,
                                      const struct iso_frame *frame)
{
    const int64_t t_ns = frame->t_ns;
    const struct iso_extraction *extraction = &appliance->face.extraction;
    appliance->face.motion = (struct iso_track_motion){0};
    if (extraction->fitted) {
        appliance->face.motion = iso_track_pose(&appliance->face.track, t_ns,
                                                &extraction->camera_from_face);
    }
    if (extraction->outcome != ISO_CAPTURE_OK) {
        return extraction->outcome;
    }
    if (is_lifeless(appliance, frame)) {
        return ISO_CAPTURE_STILL;
    }
    if (appliance->face.motion.moving) {
        return ISO_CAPTURE_MOVING;
    }
    return appliance->mode == ISO_APPLIANCE_ENROLL ? iso__appliance_enroll_gate(appliance)
                                                   : ISO_CAPTURE_OK;
}

/* For so long after a movement, a scene counts as one with a person in it. */
static const int64_t scene_quiet_ns = 2 * ISO_NS_PER_S;

/* With fewer frames a shorter pause_ms or silence_ms would take the interval for a fault of the
 * sensor. */
enum { REST_FAULT_MIN_MS = 500 };

/* 0: the appliance never rests. */
static int64_t rest_after_ns(const struct iso_config_sensor *config)
{
    const bool faulty = config->pause_ms < REST_FAULT_MIN_MS ||
                        config->silence_ms < REST_FAULT_MIN_MS;
    return faulty ? 0 : config->rest_s * ISO_NS_PER_S;
}

/* Asks the sensor for fewer frames, or for all of them. */
static void follow_rest(struct iso_appliance *appliance)
{
    const bool rests = appliance->face.rest.resting;
    if (rests != appliance->face.slowed && appliance->sensor.supervisor.sensor) {
        iso_sensor_supervisor_set_interval(&appliance->sensor.supervisor,
                                           rests ? ISO_REST_INTERVAL_NS : 0);
        appliance->face.slowed = rests;
    }
}

void iso__appliance_end_rest(struct iso_appliance *appliance)
{
    iso_rest_end(&appliance->face.rest);
    follow_rest(appliance);
}

bool iso__appliance_rests(struct iso_appliance *appliance, const struct iso_frame *frame)
{
    struct iso_scene_motion *scene = &appliance->face.scene_motion;
    const double reach_mm = appliance->borrowed.config->sensor.distance_max_mm;
    appliance->face.moves = iso_scene_motion_feed(scene, frame, reach_mm, scene_quiet_ns);
    const struct iso_rest_frame seen = {
        .t_ns = frame->t_ns,
        .stirs = iso_scene_motion_stirs(scene),
        .wanted = appliance->mode != ISO_APPLIANCE_WATCH || iso_appliance_is_aimed(appliance) ||
                  appliance->visit.decision.state != ISO_DECISION_IDLE,
    };
    const bool skips = iso_rest_skips(&appliance->face.rest, &seen);
    follow_rest(appliance);
    return skips;
}

enum iso_capture iso__appliance_tell_of(struct iso_appliance *appliance,
                                        const struct iso_frame *frame, enum iso_capture capture)
{
    const int64_t after_ns = rest_after_ns(&appliance->borrowed.config->sensor);
    const bool moves = appliance->face.moves;
    const enum iso_capture word = capture == ISO_CAPTURE_NOT_A_FACE && !moves ? ISO_CAPTURE_NOBODY
                                                                              : capture;
    const bool somebody = word != ISO_CAPTURE_NOBODY && word != ISO_CAPTURE_NO_FACE;
    iso_rest_note(&appliance->face.rest, frame->t_ns, moves || somebody, after_ns);
    follow_rest(appliance);
    return word;
}

bool iso__appliance_is_stale(struct iso_appliance *appliance, const struct iso_frame *frame,
                             int64_t arrival_ns)
{
    const int64_t stale_ns = appliance->borrowed.config->sensor.stale_ms * ISO_NS_PER_MS;
    struct iso_fault fault;
    if (frame->t_ns < appliance->suspension.awake_ns) {
        return true;
    }
    if (arrival_ns - frame->t_ns < stale_ns) {
        return false;
    }
    (void)iso_fault_set(&fault, -ESTALE, "frame %llu is %lld ms late",
                        (unsigned long long)frame->sequence,
                        (long long)((arrival_ns - frame->t_ns) / ISO_NS_PER_MS));
    iso__appliance_complain(appliance, &fault);
    return true;
}

/* Whether a frame is identical to the one before it. Such a frame must not agree with itself. (More
 * of them in a row are an attack: see is_lifeless.) */
static bool is_echo(const struct iso_appliance *appliance)
{
    return appliance->borrowed.config->motion.frozen_frames > 0 &&
           appliance->face.liveness.repeated > 0;
}

bool iso__appliance_is_evidence(struct iso_appliance *appliance, const struct iso_frame *frame)
{
    const bool repeats = appliance->face.extraction.outcome == ISO_CAPTURE_OK &&
                         iso__appliance_repeats(appliance, frame);
    return !repeats && !is_echo(appliance);
}
