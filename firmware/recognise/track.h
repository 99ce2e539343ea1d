/* Follows one face over the frames: whether it is still the same, and how fast it moves. Pure:
 * fitted poses and their times come as arguments.
 *
 * A frame does not tell whose face it shows, so two faces that take turns before the camera would
 * look like one visit. But a head has inertia: a pose that is farther from the pose before than a
 * head can move belongs to another face, and begins another track. Doubtful cases count as another
 * face: this mistake costs the visitor a frame or two, while the opposite mistake would let frames
 * of two faces agree on a third person.
 *
 *   no track     a fitted pose                                    -> a new track
 *   a track      a pose within reach of the one before            -> the same track
 *                a pose out of reach, or after lost_ns            -> a new track
 *
 * The reach of a head in the time dt is slack + jump speed * dt. People who turned their heads on
 * purpose, as fast as they could, reached 780 degrees/s (median of 20; Grossman, Leigh, Abel,
 * Lanska, Thurston 1988, Experimental Brain Research 70:470); the head of a person who walks turns
 * by less than 90 degrees/s. The slack is the largest difference of two fits of a face at rest.
 * The reach is never more than a head's breadth, because a second face can be at that distance. */
#ifndef ISO_FIRMWARE_RECOGNISE_TRACK_H
#define ISO_FIRMWARE_RECOGNISE_TRACK_H

#include <stdbool.h>
#include <stdint.h>

#include "isotherm/vec.h"

#define ISO_TRACK_SLACK_MM   20.0
#define ISO_TRACK_SLACK_RAD  0.26 /* 15 degrees */
#define ISO_TRACK_BREADTH_MM 150.0

struct iso_track_options {
    int64_t lost_ns;                /* a face that is not seen for so long is lost */
    double jump_mm_s, jump_rad_s;   /* speed that no head exceeds */
    double still_mm_s, still_rad_s; /* speed that a face that is held still does not exceed */
};

/* Results for a pose, compared with the pose before. */
struct iso_track_motion {
    uint64_t track;     /* from 1; a different number means a different face */
    bool known;         /* there is an earlier pose in this track; otherwise the speeds are 0 */
    double mm_s, rad_s; /* of the origin of the face frame (the nose tip), and of the attitude */
    bool moving;        /* one of them exceeds its limit: the frame is blurred and sheared */
};

struct iso_track {
    struct iso_track_options options;
    uint64_t number; /* number of the last track; 0: there was none */
    bool has_pose;
    int64_t t_ns;
    struct iso_rigid camera_from_face;
};

/* Begins without a track. */
void iso_track_init(struct iso_track *track, const struct iso_track_options *options);

/* Makes the next pose begin a new track. */
void iso_track_reset(struct iso_track *track);

/* Handles a fitted pose; t_ns never decreases. Do not call it for frames without a fitted face. Two
 * poses of the same time give no speed. */
struct iso_track_motion iso_track_pose(struct iso_track *track, int64_t t_ns,
                                       const struct iso_rigid *camera_from_face);

#endif
