/* Whether the face moves as living people do, over the frames of a visit.
 *
 * Nobody stands still: the head of a standing adult travels 368 +- 80 mm a minute, mostly at 0.3 to
 * 0.4 Hz (20 healthy adults, a light on a helmet: "Head movement recording and significance", a
 * study of head movement as a righting reflex). That is 6 mm a second. The best of a championship
 * of standing still for 7 minutes reached 4.7 mm/s on average (University of Oslo, Nordic
 * Championship of Standstill, 2019). A print on a stand does not move, but noise moves its measured
 * pose. The amount of noise is not known beforehand, but unlike sway it has no memory: von
 * Neumann's ratio (1941) of the mean square of successive differences, halved, to the variance is 1
 * +- 1/sqrt(n) for n independent values, and near 0 for slow motion.
 *
 *   NOT_YET -> ALIVE      something moved, in one of the six coordinates of the pose
 *   NOT_YET -> STILL      nothing moved for `still_ns`; or frames are the same to the bit
 *   ALIVE  <-> STILL      the same, judged anew over the last frames
 *   any    -> NOT_YET     a gap in time, or iso_liveness_init
 *
 * Rendered visits of 1.5 s (seed 34; astra, kinect2, d435, truedepth; sway of a tenth to all of the
 * generator's), with still_ns of 1.2 s: of 48 people 47 were alive and none still; of 48 prints on
 * stands and 48 frozen recordings all were still. The default has become longer since then, because
 * a slow sway hardly moves for that long at its turning point.
 *
 * A visit that ends before the answer is known stays NOT_YET; the policy of the caller decides
 * whether that is enough. A print in a hand moves: ALIVE is no proof of life. Pure: the time is an
 * argument. */
#ifndef ISO_CORE_PRESENTATION_LIVENESS_H
#define ISO_CORE_PRESENTATION_LIVENESS_H

#include <stdint.h>

#include "isotherm/frame.h"

enum { ISO_LIVENESS_FRAMES = 64, ISO_LIVENESS_COORDINATES = 6 };

enum iso_liveness_answer {
    ISO_LIVENESS_NOT_YET = 0,
    ISO_LIVENESS_ALIVE,
    ISO_LIVENESS_STILL,
};

struct iso_liveness_options {
    int64_t still_ns;  /* no living person stands still for this time */
    int64_t gap_ns;    /* frames further apart in time do not belong to one visit */
    int frames_min;    /* the answer needs this many frames, 8..ISO_LIVENESS_FRAMES */
    int frozen_frames; /* so many equal frames in a row count as still, >= 2 */
    double moved_mm;   /* a larger standard deviation, without noise, is motion */
    double doubt;      /* how many standard deviations von Neumann's ratio must lie below 1 */
};

/* 1.8 s, 0.5 s, 20 frames, 3 frozen, 0.12 mm, 3.5. */
struct iso_liveness_options iso_liveness_options_default(void);

/* A frame in which a face was fitted. */
struct iso_liveness_frame {
    int64_t t_ns;
    struct iso_rigid camera_from_face;
    double sigma_mm; /* of the pose; above 6 mm only the digest of the frame is used */
    uint32_t digest; /* iso_liveness_digest */
};

/* The frames of a visit. A plain value: it can be copied and is not freed. */
struct iso_liveness {
    struct iso_liveness_options options;
    int n, next; /* frames held, and where the next one goes */
    int64_t t_ns[ISO_LIVENESS_FRAMES];
    double x_mm[ISO_LIVENESS_FRAMES][ISO_LIVENESS_COORDINATES]; /* shift, and turn at 80 mm */
    struct iso_rigid first; /* turns are counted from its attitude */
    int64_t last_ns;        /* time of the last frame */
    uint32_t digest;        /* of the last frame */
    int repeated;           /* how many of the last frames in a row equal the frame before them */
    enum iso_liveness_answer answer;
};

/* Begins a visit without frames. The options are copied. */
void iso_liveness_init(const struct iso_liveness_options *options, struct iso_liveness *out);

/* Adds the next frame and returns the answer. A frame that is not later than the last one, or later
 * by more than gap_ns, begins a new visit. */
enum iso_liveness_answer iso_liveness_feed(struct iso_liveness *liveness,
                                           const struct iso_liveness_frame *frame);

/* A checksum of the depths about a face, 80 mm to each side, in every fourth row of the original
 * frame. The noise of a sensor makes the checksums of two frames of the same scene differ. 0 if the
 * nose lies behind the camera. */
uint32_t iso_liveness_digest(const struct iso_frame *frame, struct iso_vec3 nose_mm);

#endif
