/* The picture of a face as it would look from straight ahead: the intensity of a frame, resampled
 * in the face frame over the surface that was measured with it.
 *
 * The picture has the same size and pose for a detector of frontal faces, however far away, turned
 * or tilted the head is (pose normalisation by measured shape: Chang, Bowyer and Flynn, "An
 * evaluation of multimodal 2D+3D face biometrics", PAMI 27, 2005). The light of a lamp beside the
 * sensor falls off with the square of the distance, so the intensities of a pinhole camera are
 * multiplied by that square. Then they are scaled so that the middle of the face has a fixed grey
 * level.
 *
 * The chip is a plain struct of some 100 KB that is used again for every frame; the functions here
 * allocate nothing else. */
#ifndef ISO_DRIVERS_VISION_FACE_CHIP_H
#define ISO_DRIVERS_VISION_FACE_CHIP_H

#include <stdint.h>

#include "isotherm/frame.h"

enum {
    ISO_FACE_CHIP_SIDE = 128, /* pixels */
    ISO_FACE_CHIP_CELL = 2,   /* pixels of a cell of the surface, each way */
    ISO_FACE_CHIP_CELLS = ISO_FACE_CHIP_SIDE / ISO_FACE_CHIP_CELL,
    ISO_FACE_CHIP_MIDDLE = 30, /* side of the square in the middle, pixels */
};

/* Millimetres per pixel, and the y of the picture's middle in the face frame; its x is 0. */
#define ISO_FACE_CHIP_PITCH_MM 2.0
#define ISO_FACE_CHIP_Y_MM     10.0

struct iso_face_chip {
    uint8_t picture[ISO_FACE_CHIP_SIDE * ISO_FACE_CHIP_SIDE]; /* rows from the top; 0 also where
                                                                 there is nothing */
    /* Of the square of ISO_FACE_CHIP_MIDDLE pixels in the middle, from brow to lip: */
    double measured;  /* share of it that lies on measured surface and in the image, 0..1 */
    double level;     /* median of the intensity as the sensor gave it, 0..1 */
    double saturated; /* share at the sensor's upper limit, 0..1 */
    double grain;     /* mean difference of a pixel from the mean of its four neighbours / mean */

    /* Intermediate results. The surface is a grid of cells in the face frame: surface_mm is the z
     * of each cell, and weight is the number of measured points in it (0: the cell is empty). light
     * contains the corrected intensities; a negative value means that there is none. */
    float surface_mm[ISO_FACE_CHIP_CELLS * ISO_FACE_CHIP_CELLS];
    uint16_t weight[ISO_FACE_CHIP_CELLS * ISO_FACE_CHIP_CELLS];
    float light[ISO_FACE_CHIP_SIDE * ISO_FACE_CHIP_SIDE];
};

/* Draws the chip of a frame that has an intensity and that iso_frame_check accepts. -ENODATA if
 * less than a quarter of the middle is measured; the chip must not be used then. */
int iso_face_chip_draw(struct iso_face_chip *chip, const struct iso_frame *frame,
                       const struct iso_rigid *camera_from_face)
    __attribute__((warn_unused_result));

/* The place of a point of the picture in the face frame: x and y in millimetres; z is 0. */
struct iso_vec3 iso_face_chip_place(double column_px, double row_px);

#endif
