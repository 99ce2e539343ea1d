/* The sensor back end `replay`: plays stored frames (drivers/recording/recording.h).
 *
 * Options:
 *   path   required: a recording's directory, or a symbolic link to one, which may be replaced
 *   pace   realtime (default): frames are due by the recording's time stamps; asap: at once
 *   loop   no (default) | yes: begin again after the last frame
 *   repeats  no (default) | yes: frames that were played before may count as evidence again. It is
 *          for tests that play a recording more than once; no camera has this option
 *
 * It plays the frames in order, from the first one at each start. When the link is replaced,
 * appears or disappears, the sensor plays the new recording from its first frame. The path may be
 * empty at first. If there is nothing to play, wait returns -ETIMEDOUT, and next_due_ns asks the
 * caller to look at the path again after 50 ms, or after 100 ms while few frames are wanted. A
 * recording that is refused, and every damaged frame, is reported once as -EBADMSG; a damaged frame
 * leaves a gap in the sequence.
 *
 * The sensor never sleeps. A frame's t_ns is the time at which it was due, on the injected clock;
 * frames that are fetched late are not dropped. t_ns and the sequence go on rising from recording
 * to recording and from start to start. */
#ifndef ISO_DRIVERS_SENSOR_REPLAY_SENSOR_REPLAY_H
#define ISO_DRIVERS_SENSOR_REPLAY_SENSOR_REPLAY_H

#include "drivers/sensor/contract/sensor.h"

enum { ISO_SENSOR_REPLAY_LOOK_MS = 50, ISO_SENSOR_REPLAY_SELDOM_LOOK_MS = 100 };

extern const struct iso_sensor_ops iso_sensor_replay_ops;

#endif
