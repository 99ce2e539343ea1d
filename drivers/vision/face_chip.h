/* The picture of a face as it would look from straight ahead: the intensity of a frame, resampled
 * in the face frame over the surface that was measured with it.
 *
 * A detector of frontal faces then meets one size and one attitude only, however far away, turned
 * or tilted the head is (pose normalisation by measured shape: Chang, Bowyer and Flynn, "An
 * evaluation of multimodal 2D+3D face biometrics", PAMI 27, 2005). The light of a lamp beside the
 * sensor falls off with the square of the distance: intensities are multiplied by it. Then they are
 * scaled to the middle of the face.
 *
 * The chip is a plain struct of some 100 KB that is used again for every frame; nothing is
 * allocated. */
#ifndef ISO_DRIVERS_VISION_FACE_CHIP_H
#define ISO_DRIVERS_VISION_FACE_CHIP_H

#include <stdint.h>

#include "isotherm/frame.h"

enum {
    ISO_FACE_CHIP_SIDE = 128, /* pixels */
    ISO_FACE_CHIP_CELL = 2,   /* pixels of a cell of the surface, each way */
    ISO_FACE_CHIP_CELLS = ISO_FACE_CHIP_SIDE / ISO_FACE_CHIP_CELL,
    ISO_FACE_CHIP_MIDDLE = 30, /* side of the part that is looked at below */
};

/* Millimetres a pixel, and the face-frame y of the middle; its x is 0. */
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

    /* Between the steps: z in the face frame, how many points made it (0: empty), corrected
     * intensities (negative: nothing there). */
    float surface_mm[ISO_FACE_CHIP_CELLS * ISO_FACE_CHIP_CELLS];
    uint16_t weight[ISO_FACE_CHIP_CELLS * ISO_FACE_CHIP_CELLS];
    float light[ISO_FACE_CHIP_SIDE * ISO_FACE_CHIP_SIDE];
};

/* Draws the chip of a frame that has an intensity and that iso_frame_check passes. -ENODATA if less
 * than a quarter of the middle is there: the chip is then of no use. */
int iso_face_chip_draw(struct iso_face_chip *chip, const struct iso_frame *frame,
                       const struct iso_rigid *camera_from_face)
    __attribute__((warn_unused_result));

/* Where in the face frame (x, y) a point of the picture is. */
struct iso_vec3 iso_face_chip_place(double column_px, double row_px);

#endif
