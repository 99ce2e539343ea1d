/** @file
 * The template: the isotherms and the upper face of one person, in the face frame, and where they
 * come from.
 *
 * A template has a fixed size and no pointers: it can be copied, compared and wiped as a whole. It
 * is biometric data. Points of weight 0 are missing (the isotherm is open, or the surface was
 * filled in rather than measured). */
#ifndef ISOTHERM_TEMPLATE_H
#define ISOTHERM_TEMPLATE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "isotherm/landmark.h"

/** Distance of the nodes of the upper face, mm. */
#define ISO_UPPER_SPACING_MM 3.0
/** Height of the uppermost row of the upper face, mm. */
#define ISO_UPPER_TOP_MM 87.0

enum {
    ISO_UPPER_COLUMNS = 49, /**< Columns of the upper face. */
    ISO_UPPER_MIDDLE = 24,  /**< The column at x = 0. */
    ISO_UPPER_ROWS = 37,    /**< Rows of the upper face, from y = 87 to y = -21 mm. */
    ISO_UPPER_NODES = ISO_UPPER_COLUMNS * ISO_UPPER_ROWS, /**< Nodes of the upper face. */
    /** Bytes of the kinds of all nodes in a serialised template: two bits a node. */
    ISO_UPPER_KIND_BYTES = (ISO_UPPER_NODES + 3) / 4,
    /** Most bytes of a serialised upper face: the kinds, then int16, 1/64 mm, for each node with a
     * surface. */
    ISO_UPPER_BYTES_MAX = ISO_UPPER_KIND_BYTES + 2 * ISO_UPPER_NODES,
};

/** What a node of the upper face is. The comparison of two surfaces uses measured nodes only; the
 * metric uses filled-in ones as well. */
enum iso_upper_kind {
    ISO_UPPER_NONE = 0, /**< No surface; its height is 0. */
    ISO_UPPER_FILLED,   /**< Filled in: it carries the slope of its neighbours. */
    ISO_UPPER_MEASURED, /**< Measured. */
};

/** The upper face as heights over a grid in the face frame: what expressions move least (Chang,
 * Bowyer and Flynn 2006). Column c lies at x = (c - ISO_UPPER_MIDDLE) * ISO_UPPER_SPACING_MM, row r
 * at y = ISO_UPPER_TOP_MM - r * ISO_UPPER_SPACING_MM. All zero: there is none. */
struct iso_upper_face {
    float z_mm[ISO_UPPER_ROWS][ISO_UPPER_COLUMNS];   /**< Heights, mm. */
    uint8_t kind[ISO_UPPER_ROWS][ISO_UPPER_COLUMNS]; /**< enum iso_upper_kind. */
};

enum {
    ISO_TEMPLATE_VERSION = 2,         /**< Version of the serialised form. */
    ISO_TEMPLATE_RADII_MAX = 4,       /**< Most isotherms of a landmark. */
    ISO_TEMPLATE_POINTS_MAX = 32,     /**< Most points of an isotherm. */
    ISO_TEMPLATE_SENSOR_MAX = 16,     /**< Bytes of the sensor's name, with its end. */
    ISO_TEMPLATE_FRAMES_MAX = 0x7fff, /**< Most frames of a template. */
    /** Most bytes of a serialised template. */
    ISO_TEMPLATE_BYTES_MAX = 64 +
                             ISO_TEMPLATE_RADII_MAX * ISO_LANDMARKS * ISO_TEMPLATE_POINTS_MAX * 7 +
                             ISO_UPPER_BYTES_MAX,
};

/** A template. */
struct iso_template {
    uint32_t algorithm; /**< Identifies all that shapes the points (iso_extractor_algorithm()). */
    char sensor[ISO_TEMPLATE_SENSOR_MAX];    /**< Kind of sensor, such as "astra"; ends with NUL. */
    uint16_t n_radii;                        /**< Isotherms of each landmark. */
    uint16_t n_points;                       /**< Points of each isotherm. */
    uint16_t n_frames;                       /**< How many frames it was made of. */
    bool learned;                            /**< Learned at a visit; else made by an enrolment. */
    float quality;                           /**< Weighted share of measured points, 0..1. */
    float radius_mm[ISO_TEMPLATE_RADII_MAX]; /**< [n_radii]: radii of the isotherms, mm. */
    /** [n_radii][landmark][n_points]: points of the isotherms, face frame, mm. */
    float points_mm[ISO_TEMPLATE_RADII_MAX][ISO_LANDMARKS][ISO_TEMPLATE_POINTS_MAX][3];
    /** [n_radii][landmark][n_points]: weights of the points, 0..1. */
    float weight[ISO_TEMPLATE_RADII_MAX][ISO_LANDMARKS][ISO_TEMPLATE_POINTS_MAX];
    struct iso_upper_face upper; /**< The upper face; all zero: none. */
};

/** Writes a template as bytes; some 8 kB with 4 x 16 points.
 *
 * All numbers are little endian. The bytes are, in this order:
 *
 *  - the magic "ISOT"; u16 version, n_radii, n_points, and n_frames, whose bit 15 is `learned`;
 *  - u32 algorithm, 16 bytes sensor, f32 quality, f32 radius_mm[n_radii];
 *  - for each point: i16[3], its coordinates in units of 1/64 mm, and u8, its weight in units of
 *    1/255;
 *  - u16, the size of the upper face in bytes (0 if the template has none), and the upper face;
 *  - a CRC-32 of all bytes before it.
 *
 * @param tmpl   The template.
 * @param bytes  The buffer to write to.
 * @param size   Its size, bytes; ISO_TEMPLATE_BYTES_MAX is always enough.
 * @return The bytes written; -EINVAL for a template out of range (also a point beyond +-511 mm or
 *         not finite); -ENOSPC if they do not fit. */
int iso_template_serialise(const struct iso_template *tmpl, void *bytes, size_t size)
    __attribute__((warn_unused_result));

/** Reads what iso_template_serialise() wrote.
 *
 * @param bytes  The serialised template.
 * @param size   Its size, bytes.
 * @param out    Receives the template.
 * @return 0; -EBADMSG if it is truncated or damaged; -EPROTONOSUPPORT for another version. (Version
 *         1 had no upper face. Its templates were of other algorithms, so that they could not be
 *         compared with templates of this version.) */
int iso_template_parse(const void *bytes, size_t size, struct iso_template *out)
    __attribute__((warn_unused_result));

/** The main members of a serialised template. */
struct iso_template_facts {
    uint32_t algorithm; /**< As in struct iso_template. */
    uint16_t n_radii;   /**< As in struct iso_template. */
    uint16_t n_points;  /**< As in struct iso_template. */
    uint16_t n_frames;  /**< As in struct iso_template. */
    bool learned;       /**< As in struct iso_template. */
};

/** Checks whether iso_template_parse() would read these bytes. The caller needs no memory for a
 * template.
 *
 * @param bytes  The serialised template.
 * @param size   Its size, bytes.
 * @param out    Receives the main members of the template.
 * @return As iso_template_parse(). */
int iso_template_check(const void *bytes, size_t size, struct iso_template_facts *out)
    __attribute__((warn_unused_result));

/** Overwrites a template with zeros in a way that the compiler may not leave out.
 *
 * @param tmpl  The template. */
void iso_template_wipe(struct iso_template *tmpl);

#endif
