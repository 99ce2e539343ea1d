/* Whether anything within reach moves. In a single frame a chair or a door leaf in front of the
 * camera looks like a visitor without a face. But people never stand quite still (liveness.h has
 * the figures), and furniture does.
 *
 * The frame is divided into a grid of cells. The mean depth of each cell over half a second is
 * compared with that of the half second before. At a silhouette a sway of a few millimetres changes
 * it by some hundred millimetres, because near pixels replace far ones. The noise of a
 * structured-light sensor changes it by more than 100 mm in one or two cells at edges, even from
 * one frame to the next. A change therefore counts only if at least four cells change at once. The
 * scene counts as moving from the first change until `quiet_ns` after the last one. Until the first
 * change it counts as still. Pure: the only clock is the time stamps of the frames.
 *
 * Whether something stirs is told from one frame, compared with the half second before it. This is
 * sooner and less certain: noise may look like it. */
#ifndef ISO_CORE_FIND_SCENE_MOTION_H
#define ISO_CORE_FIND_SCENE_MOTION_H

#include <stdbool.h>
#include <stdint.h>

#include "isotherm/frame.h"

enum { ISO_SCENE_COLUMNS = 40, ISO_SCENE_ROWS = 30 };

/* A part of the image over a time. */
struct iso_scene_cell {
    float before_mm; /* its mean depth in the last half second that is over; 0: not measured */
    float sum_mm;    /* of its mean depths in the frames of this half second */
    int n;           /* frames of this half second in which it was measured */
};

/* What was seen so far; all zero at first. A plain value: it can be copied and is not freed. */
struct iso_scene_motion {
    struct iso_scene_cell cells[ISO_SCENE_ROWS][ISO_SCENE_COLUMNS];
    int width_px, height_px;     /* of the frames compared; 0: there was none */
    int frames;                  /* of this half second */
    int n_changed, n_appeared;   /* cells of the last frame that differ from the half second before,
                                    and cells within reach that were not measured then */
    int64_t since_ns, latest_ns; /* when it began, and the time of the last frame */
    int64_t moved_ns;            /* when something moved last, if `moved` */
    bool moved;
    bool compared; /* a half second is over, with which frames are compared */
};

/* Adds the next frame. Returns whether something at a depth of at most reach_mm moved within the
 * last quiet_ns. A frame of another size, or with an earlier time, starts from the beginning. Takes
 * some 0.1 ms for a frame of 640 x 480. */
bool iso_scene_motion_feed(struct iso_scene_motion *scene, const struct iso_frame *frame,
                           double reach_mm, int64_t quiet_ns);

/* Whether something stirs in the last frame: the depth of four cells has changed, or eight cells
 * are measured that were not measured before. True also while that cannot be told: during the first
 * half second, and for frames with fewer pixels than cells. */
bool iso_scene_motion_stirs(const struct iso_scene_motion *scene);

#endif
