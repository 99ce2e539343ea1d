/* A memory of the frames that were evidence. It recognises a frame that is shown again.
 *
 * A camera that is stuck, or that somebody feeds with stored pictures, delivers the same buffers
 * again and again, with times that advance. The noise of a depth sensor makes two frames of a
 * living person differ in most pixels, however still the person stands. A repeated buffer has the
 * same depths in almost all pixels. Each frame therefore leaves a fingerprint, and a new frame is
 * compared with all fingerprints of the last `span_ns`.
 *
 * The fingerprint. The surroundings of the face are divided into tiles that are fixed in the
 * camera's image. 16 pixels of each tile are read. The 15 differences between neighbours are
 * hashed, together with the place of the tile. A constant that is added to all depths does not
 * change differences. The hashes of the tiles are divided into 32 classes, and the smallest hash of
 * each class is kept, as one byte: one-permutation hashing (Li, Owen and Zhang, NIPS 2012). The
 * share of classes that two fingerprints have in common estimates the share of tiles that two
 * frames have in common. A pixel that flickers changes one tile at most.
 *
 * These frames are not recognised as repeated: a stored frame that is moved, scaled or overlaid
 * with noise in most tiles, frames older than the span, and everything from before a restart. */
#ifndef ISO_CORE_PRESENTATION_FRAME_MEMORY_H
#define ISO_CORE_PRESENTATION_FRAME_MEMORY_H

#include <stdbool.h>
#include <stdint.h>

#include "isotherm/frame.h"

enum { ISO_FINGERPRINT_CLASSES = 32 };

/* The fingerprint of a frame. A plain value: it can be copied and is not freed. */
struct iso_fingerprint {
    uint8_t of[ISO_FINGERPRINT_CLASSES]; /* for each class; 0: no tile of it has enough content */
    int filled;                          /* how many classes are not 0 */
};

/* The fingerprint of everything that is as far from the camera as the face, in the whole frame as
 * the sensor delivered it. A frame that is too small or too empty to be distinguished from others
 * has `filled` below ISO_FINGERPRINT_MIN. nose_mm: the nose tip in the camera frame, in mm. Reads
 * at most 7,056 pixels, whatever the size of the frame. */
enum { ISO_FINGERPRINT_MIN = 8 };
struct iso_fingerprint iso_fingerprint_of(const struct iso_frame *frame, struct iso_vec3 nose_mm);

/* The share of filled classes that two fingerprints have in common, 0..1. */
double iso_fingerprint_likeness(const struct iso_fingerprint *a, const struct iso_fingerprint *b);

/* Two frames of at least this likeness count as the same frame. Measured by
 * tests/sim/door/test_repeated_frames.c: two frames of a head that does not move at all stay well
 * below it. */
#define ISO_FINGERPRINT_SAME 0.4

struct iso_frame_memory_options {
    int64_t span_ns; /* how long a frame is remembered, > 0 */
    int capacity;    /* the most frames, >= 1; the oldest one is overwritten by a new one */
};

/* 10 minutes, and the 18,000 frames that a camera of 30 frames a second delivers in this time: 720
 * kB. */
struct iso_frame_memory_options iso_frame_memory_options_default(void);

struct iso_frame_memory;

/* Makes an empty memory and allocates everything that it will need. -EINVAL for options outside
 * their ranges, -ENOMEM. */
int iso_frame_memory_new(const struct iso_frame_memory_options *options,
                         struct iso_frame_memory **out) __attribute__((warn_unused_result));

/* Wipes and frees it. NULL is accepted. */
void iso_frame_memory_free(struct iso_frame_memory *memory);

/* Whether the frame of this fingerprint, exposed at t_ns (monotonic), repeats a remembered one. The
 * frame is remembered in either case, so that frames which are repeated for longer than the span
 * stay known. A fingerprint with `filled` below ISO_FINGERPRINT_MIN repeats nothing and is not
 * remembered. */
bool iso_frame_memory_repeats(struct iso_frame_memory *memory,
                              const struct iso_fingerprint *fingerprint, int64_t t_ns);

#endif
