/* The template: the isotherms and the upper face of one person, in the face frame, and who made
 * them.
 *
 * Fixed size, no pointers: it can be copied, compared and wiped as a whole. Points of weight 0 are
 * missing (open isotherm, or surface that was filled in rather than measured). */
#ifndef ISOTHERM_TEMPLATE_H
#define ISOTHERM_TEMPLATE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "isotherm/landmark.h"

#define ISO_UPPER_SPACING_MM 3.0
#define ISO_UPPER_TOP_MM     87.0

enum {
    ISO_UPPER_COLUMNS = 49,
    ISO_UPPER_MIDDLE = 24,
    ISO_UPPER_ROWS = 37, /* y = 87 to -21 mm */
    ISO_UPPER_NODES = ISO_UPPER_COLUMNS * ISO_UPPER_ROWS,
    /* Serialised: for each node two bits, its kind, rounded up to a byte; then for each node with a
     * surface int16, 1/64 mm. */
    ISO_UPPER_KIND_BYTES = (ISO_UPPER_NODES + 3) / 4,
    ISO_UPPER_BYTES_MAX = ISO_UPPER_KIND_BYTES + 2 * ISO_UPPER_NODES,
};

enum iso_upper_kind {
    ISO_UPPER_NONE = 0, /* z_mm is 0 */
    ISO_UPPER_FILLED,
    ISO_UPPER_MEASURED,
};

struct iso_upper_face {
    float z_mm[ISO_UPPER_ROWS][ISO_UPPER_COLUMNS];
    uint8_t kind[ISO_UPPER_ROWS][ISO_UPPER_COLUMNS]; /* enum iso_upper_kind */
};

enum {
    ISO_TEMPLATE_VERSION = 2,
    ISO_TEMPLATE_RADII_MAX = 4,
    ISO_TEMPLATE_POINTS_MAX = 32,
    ISO_TEMPLATE_SENSOR_MAX = 16,
    ISO_TEMPLATE_FRAMES_MAX = 0x7fff,
    /* Largest serialised template. */
    ISO_TEMPLATE_BYTES_MAX = 64 +
                             ISO_TEMPLATE_RADII_MAX * ISO_LANDMARKS * ISO_TEMPLATE_POINTS_MAX * 7 +
                             ISO_UPPER_BYTES_MAX,
};

struct iso_template {
    uint32_t algorithm; /* hash of everything that shapes the points: model, radii, t, ... */
    char sensor[ISO_TEMPLATE_SENSOR_MAX]; /* sensor class, NUL-terminated: "astra", "kinect2" */
    uint16_t n_radii, n_points, n_frames; /* frames fused into it */
    bool learned;                         /* at a visit, by nobody's order; else by an enrolment */
    float quality;                        /* 0..1: weighted share of measured points */
    float radius_mm[ISO_TEMPLATE_RADII_MAX];
    float points_mm[ISO_TEMPLATE_RADII_MAX][ISO_LANDMARKS][ISO_TEMPLATE_POINTS_MAX][3];
    float weight[ISO_TEMPLATE_RADII_MAX][ISO_LANDMARKS][ISO_TEMPLATE_POINTS_MAX]; /* 0..1 */
    struct iso_upper_face upper; /* all zero: none */
};

/* Serialised, little endian: magic "ISOT", version u16, n_radii u16, n_points u16, n_frames u16
 * (of which bit 15 says learned), algorithm u32, sensor[16], quality f32, radius f32[n_radii], then
 * per point int16[3] (1/64 mm) and uint8 weight (1/255), u16 bytes of the upper face (0: none) and
 * those (upper_face.h), at the end a CRC-32 of all before it. Some 8 KB with 4 x 16 points. Returns
 * the bytes written; -EINVAL for a template out of range (also a point beyond +-511 mm or not
 * finite), -ENOSPC if they do not fit. */
int iso_template_serialise(const struct iso_template *tmpl, void *bytes, size_t size)
    __attribute__((warn_unused_result));

/* -EBADMSG truncated or damaged, -EPROTONOSUPPORT another version. Version 1, which had no upper
 * face, is one: its templates were of other algorithms, so that nothing here compares with them. */
int iso_template_parse(const void *bytes, size_t size, struct iso_template *out)
    __attribute__((warn_unused_result));

/* What a serialised template says of itself. */
struct iso_template_facts {
    uint32_t algorithm;
    uint16_t n_radii, n_points, n_frames;
    bool learned;
};

/* Whether iso_template_parse() would read these bytes, with its errors, without a template to read
 * them into. */
int iso_template_check(const void *bytes, size_t size, struct iso_template_facts *out)
    __attribute__((warn_unused_result));

/* Overwrites it so that the compiler may not leave it out (biometric data). */
void iso_template_wipe(struct iso_template *tmpl);

#endif
