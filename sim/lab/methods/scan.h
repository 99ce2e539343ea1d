/* A face as every pairwise method receives it: the measured surface in the face frame, and the
 * positions of its landmarks.
 *
 * All these methods receive the same data: the extractor's face patch (core/surface/face_patch.h:
 * resampled from the front in the fitted head's frame, holes filled, smoothed by the extractor's
 * options) and the landmarks that were found. So the methods differ only in how they describe
 * and compare a face. Face frame: x to the subject's left, y up, z out of the face, mm. */
#ifndef SIM_LAB_METHODS_SCAN_H
#define SIM_LAB_METHODS_SCAN_H

#include <stdbool.h>
#include <stdint.h>

#include "isotherm/extract.h"

/* The 25 marked points of anthroface (sim/lab/methods/anthroface.h). */
enum { SIM_MARKS = 25 };

struct sim_scan {
    int side; /* columns and rows of the grid; odd, the face frame's z axis in the middle */
    double spacing_mm; /* of the grid */
    float *z_mm; /* [side * side], row 0 at the top (+y); NAN outside the domain, which is equal for
                    all faces of one extractor */
    uint8_t *measured; /* the same shape: 1 measured, 0 filled in or outside */
    /* The same shape, or NULL without infrared (sim/lab/methods/reflectance.h). */
    float *reflectance;
    struct iso_vec3 source_mm[ISO_LANDMARKS];   /* where the appliance releases heat */
    struct iso_vec3 landmark_mm[ISO_LANDMARKS]; /* on the fitted head, expression included */
    bool mark_known[SIM_MARKS];                 /* only few corpora have marks */
    struct iso_vec3 mark_mm[SIM_MARKS];
};

static inline size_t sim_scan_pixels(const struct sim_scan *face)
{
    return (size_t)face->side * (size_t)face->side;
}

/* Fractional column and row of a place. */
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

/* Makes an empty grid: NAN everywhere. -EINVAL for an even side, a side outside 3..1023 or a
 * spacing that is not positive; -ENOMEM. */
int sim_scan_new(int side, double spacing_mm, struct sim_scan **out)
    __attribute__((warn_unused_result));

/* Copies the face that the extractor holds after `frame` with ISO_CAPTURE_OK; no marks. -ENOMEM. */
int sim_scan_of(const struct iso_extractor *extractor, const struct iso_frame *frame,
                const struct iso_extraction *extraction, struct sim_scan **out)
    __attribute__((warn_unused_result));

/* Joins n >= 1 faces of the same person and grid: for each pixel the mean of the measured values
 * (of the filled ones if none was measured), and the mean of each point. A mark is the mean over
 * the faces that have it. Reflectance is known if all faces have it. Each face uses the face frame
 * of its own fit. -EINVAL for no face or for different grids, -ENOMEM. */
int sim_scan_fuse(const struct sim_scan *const *faces, size_t n, struct sim_scan **out)
    __attribute__((warn_unused_result));

/* Wipes and frees it and what it holds. NULL is accepted. */
void sim_scan_free(struct sim_scan *face);

/* Interpolates the surface between pixels, bilinearly. *share is the measured share, 0..1; it may
 * be NULL. Returns false outside the domain; *z_mm and *share are then unchanged. */
bool sim_scan_height(const struct sim_scan *face, double x_mm, double y_mm, double *z_mm,
                     double *share);

#endif
