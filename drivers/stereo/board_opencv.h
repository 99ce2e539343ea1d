/* The functions of OpenCV that the calibration (board.h) uses: finding checkerboards, and solving
 * for cameras. The .cc file is C++, this header is C; no exception leaves it. The code is in the
 * module `stereo` (stereo_module.h); all functions also return the errors of
 * iso_stereo_module_load. */
#ifndef ISO_DRIVERS_STEREO_BOARD_OPENCV_H
#define ISO_DRIVERS_STEREO_BOARD_OPENCV_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The inner corners of a checkerboard in an 8-bit picture, row by row, to a fraction of a pixel:
 * corners_px[columns * rows][2]. -ENOENT if no whole board is seen, -ENOMEM, -EIO. */
int iso_board_opencv_find(const uint8_t *image, int width_px, int height_px, int columns, int rows,
                          float (*corners_px)[2]) __attribute__((warn_unused_result));

struct iso_board_opencv_problem {
    int columns, rows, n_pairs, width_px, height_px;
    double square_mm;
    const float (*corners_px[2])[2]; /* of each eye: [n_pairs * columns * rows] */
    void (*solved)(void *context);   /* called after each of the three solutions; NULL: no call */
    void *context;
};

struct iso_board_opencv_camera {
    double fx_px, fy_px, cx_px, cy_px, k1, k2, p1, p2;
};

struct iso_board_opencv_solution {
    struct iso_board_opencv_camera camera[2];
    double rotation[9], translation_mm[3]; /* right from left */
    double rms_px;
};

/* Each camera by itself, then both together. -ENOMEM; -EIO if the solver gave up. */
int iso_board_opencv_solve(const struct iso_board_opencv_problem *problem,
                           struct iso_board_opencv_solution *out)
    __attribute__((warn_unused_result));

struct iso_board_opencv_single {
    struct iso_board_opencv_camera camera;
    double rms_px;
};

/* One camera by itself, from corners_px[0]; corners_px[1] is not read. `normals` gets the direction
 * of each board's normal in the camera's frame, [n_pairs][3]. -ENOMEM; -EIO if the solver gave up.
 */
int iso_board_opencv_solve_single(const struct iso_board_opencv_problem *problem,
                                  struct iso_board_opencv_single *out, double (*normals)[3])
    __attribute__((warn_unused_result));

#ifdef __cplusplus
}
#endif
#endif
