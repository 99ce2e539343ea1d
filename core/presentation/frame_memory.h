/* A memory of the frames that were evidence, by which a frame that is shown again is known.
 *
 * A camera that is stuck, or that somebody feeds with stored pictures, hands up the same buffers
 * again and again, with times that go on. A depth sensor's noise makes two frames of a living
 * person differ in most pixels, however still the person stands; a buffer that is repeated has the
 * same depths in almost all of them. So each frame leaves a fingerprint, and a new frame is
 * compared with all fingerprints of the last `span_ns`.
 *
 * The fingerprint. The surroundings of the face are divided into tiles that are fixed in the
 * camera's image. Of each tile 16 pixels are read; the 15 differences between neighbours are
 * hashed, with the tile's place. Differences do not change when a constant is added to all depths.
 * The tiles' hashes are divided into 32 classes, and of each class the smallest hash is kept, as
 * one byte: one-permutation hashing (Li, Owen and Zhang, NIPS 2012), by which the share of classes
 * that two fingerprints have in common estimates the share of tiles that two frames have in common.
 * A pixel that flickers changes one tile at most.
 *
 * What is not recognised as repeated: a stored frame that is moved, scaled or overlaid with noise
 * in most tiles, frames older than the span, and everything from before a restart. */
#ifndef ISO_CORE_PRESENTATION_FRAME_MEMORY_H
#define ISO_CORE_PRESENTATION_FRAME_MEMORY_H

#include <stdbool.h>
#include <stdint.h>

#include "isotherm/frame.h"

enum { ISO_FINGERPRINT_CLASSES = 32 };

/* A value of its own: copied freely, nothing to be freed. */
struct iso_fingerprint {
    uint8_t of[ISO_FINGERPRINT_CLASSES]; /* 0: no tile of that class had enough content */
    int filled;                          /* classes that are not 0 */
};

/* The fingerprint of what is as far from the camera as the face, in the whole frame as the sensor
 * delivered it. A frame too small or too empty to be told from another has `filled` below
 * ISO_FINGERPRINT_MIN. nose_mm: the nose tip in the camera frame, in mm. Reads at most 7,056
 * pixels, whatever the frame's size. */
enum { ISO_FINGERPRINT_MIN = 8 };
struct iso_fingerprint iso_fingerprint_of(const struct iso_frame *frame, struct iso_vec3 nose_mm);

/* The share of filled classes that two fingerprints have in common, 0..1. */
double iso_fingerprint_likeness(const struct iso_fingerprint *a, const struct iso_fingerprint *b);

/* Above this likeness two frames are one. Measured by tests/sim/door/test_repeated_frames.c: what a
 * sensor sees of a head that does not move at all stays well below it. */
#define ISO_FINGERPRINT_SAME 0.4

struct iso_frame_memory_options {
    int64_t span_ns; /* a frame is remembered for so long, > 0 */
    int capacity;    /* so many frames at most, >= 1; the oldest is forgotten for a new one */
};

/* 10 minutes, and the 18,000 frames that a camera of 30 frames a second delivers in them: 720 kB.
 */
struct iso_frame_memory_options iso_frame_memory_options_default(void);

struct iso_frame_memory;

/* All memory that it will ever need. -EINVAL for options outside their ranges, -ENOMEM. */
int iso_frame_memory_new(const struct iso_frame_memory_options *options,
                         struct iso_frame_memory **out) __attribute__((warn_unused_result));
/* Wipes it; NULL is fine. */
void iso_frame_memory_free(struct iso_frame_memory *memory);

/* Whether the frame of this fingerprint, exposed at t_ns (monotonic), repeats one that is
 * remembered. Remembers it in either case, so that what is repeated without an end stays known. A
 * fingerprint below ISO_FINGERPRINT_MIN repeats nothing and is not remembered. */
bool iso_frame_memory_repeats(struct iso_frame_memory *memory,
                              const struct iso_fingerprint *fingerprint, int64_t t_ns);

#endif
