/* A face as every method sees it: the measured surface in the face frame, and where its landmarks
 * are.
 *
 * All methods are given the same: the extractor's face patch (core/surface/face_patch.h: resampled
 * from the front in the fitted head's frame, holes filled, smoothed by the extractor's options) and
 * the landmarks that were found, so that they differ by how they describe and compare a face and by
 * nothing else. Face frame: x to the subject's left, y up, z out of the face, mm. */
#ifndef SIM_LAB_METHODS_SCAN_H
#define SIM_LAB_METHODS_SCAN_H

#include <stdbool.h>
#include <stdint.h>

#include "isotherm/extract.h"

/* The 25 points of anthroface that somebody has marked (sim/lab/methods/anthroface.h). */
enum { SIM_MARKS = 25 };

struct sim_scan {
    int side; /* columns and rows of the grid; odd, the face frame's z axis in the middle */
    double spacing_mm; /* of the grid */
    float *z_mm;       /* [side * side], row 0 at the top (+y); NAN outside the domain, which is the
                          same for all faces of one extractor */
    uint8_t *measured; /* the same shape: 1 measured, 0 filled in or outside */
    float
        *reflectance; /* the same shape, or NULL without infrared: sim/lab/methods/reflectance.h */
    struct iso_vec3 source_mm[ISO_LANDMARKS];   /* where the appliance releases heat */
    struct iso_vec3 landmark_mm[ISO_LANDMARKS]; /* on the fitted head, its expression on */
    bool mark_known[SIM_MARKS];                 /* marks are known of few corpora */
    struct iso_vec3 mark_mm[SIM_MARKS];
};

static inline size_t sim_scan_pixels(const struct sim_scan *face)
{
    return (size_t)face->side * (size_t)face->side;
}

/* Column and row, in fractions, of a place. */
static inline double sim_scan_column(const struct sim_scan *face, double x_mm)
{
    return (face->side - 1) / 2.0 + x_mm / face->spacing_mm;
}
static inline double sim_scan_row(const struct sim_scan *face, double y_mm)
{
    return (face->side - 1) / 2.0 - y_mm / face->spacing_mm;
}

/* The surface point at a pixel; z is NAN outside the domain. */
static inline struct iso_vec3 sim_scan_point(const struct sim_scan *face, int column, int row)
{
    double middle = (face->side - 1) / 2.0;
    return iso_vec3((column - middle) * face->spacing_mm, (middle - row) * face->spacing_mm,
                    (double)face->z_mm[row * face->side + column]);
}

/* An empty grid: NAN everywhere. -EINVAL for an even or too small side or a bad spacing, -ENOMEM.
 */
int sim_scan_new(int side, double spacing_mm, struct sim_scan **out)
    __attribute__((warn_unused_result));

/* What the extractor holds after `frame` with ISO_CAPTURE_OK; no marks. -ENOMEM. */
int sim_scan_of(const struct iso_extractor *extractor, const struct iso_frame *frame,
                const struct iso_extraction *extraction, struct sim_scan **out)
    __attribute__((warn_unused_result));

/* One face from n >= 1 of the same person and grid: the mean of what was measured, pixel by pixel
 * (of what was filled in where none was), and the mean of the points. Reflectance is known if all
 * know it. Face frames are those of each frame's fit. -EINVAL for none or grids that differ,
 * -ENOMEM. */
int sim_scan_fuse(const struct sim_scan *const *faces, size_t n, struct sim_scan **out)
    __attribute__((warn_unused_result));

/* Wipes and frees. */
void sim_scan_free(struct sim_scan *face);

/* The surface between pixels, bilinear: false outside the domain, z and *share (measured, 0..1; may
 * be NULL) then untouched. */
bool sim_scan_height(const struct sim_scan *face, double x_mm, double y_mm, double *z_mm,
                     double *share);

#endif
