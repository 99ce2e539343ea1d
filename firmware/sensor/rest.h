/* Rest: an appliance before which nobody is examines fewer frames.
 *
 *   AWAKE    every frame is examined
 *            for after_ns nobody was seen, nothing moved and no client waited  -> RESTING
 *   RESTING  the sensor is asked for one frame in ISO_REST_INTERVAL_NS (iso_sensor_set_interval).
 *            Such a frame is only compared with the frames before it (core/find/scene_motion.h),
 *            which takes a hundredth of the time of an examination. One frame in
 *            ISO_REST_EXAMINE_NS is examined
 *            something stirs in a frame, or a client waits: it is examined      -> AWAKE
 *            an examined frame shows somebody, or a movement                    -> AWAKE
 *
 * Somebody who comes stirs, and is examined in the first frame that the sensor gives: after the
 * interval and one frame of the camera at the latest, which is 113 ms at 30 frames a second.
 * Somebody who does not stir (a head alone that rises slowly before a near wall) is examined
 * ISO_REST_EXAMINE_NS later at the latest. Rest never lets anybody in: a frame that is not examined
 * counts as one in which nobody is. Pure: the only clock is the time stamps of the frames. */
#ifndef ISO_FIRMWARE_SENSOR_REST_H
#define ISO_FIRMWARE_SENSOR_REST_H

#include <stdbool.h>
#include <stdint.h>

/* A camera of 30 frames a second gives every third frame. */
#define ISO_REST_INTERVAL_NS INT64_C(80000000)
#define ISO_REST_EXAMINE_NS  INT64_C(1000000000)

/* All zero at first: awake. A plain value. */
struct iso_rest {
    bool resting;
    bool has_busy, has_examined;
    int64_t busy_ns;     /* the last frame with somebody or with a movement */
    int64_t examined_ns; /* the last frame that was examined */
};

/* What a frame shows before it is examined. */
struct iso_rest_frame {
    int64_t t_ns; /* its time */
    bool stirs;   /* something stirs in it */
    bool wanted;  /* somebody waits for its result, for example a client */
};

/* Whether the frame needs no examination. If it stirs or is wanted, rest ends, or its time begins
 * anew. */
bool iso_rest_skips(struct iso_rest *rest, const struct iso_rest_frame *frame);

/* Takes the result of an examined frame: whether there is somebody, or a movement. Rest begins
 * after_ns after the last such frame (or after the first frame); 0: never. */
void iso_rest_note(struct iso_rest *rest, int64_t t_ns, bool busy, int64_t after_ns);

/* Ends rest, and its time begins anew. */
void iso_rest_end(struct iso_rest *rest);

#endif
