/* The part of the module `stereo` that is linked into the program. */
#include "drivers/stereo/stereo_module.h"

static struct iso_module_slot slot = {.name = ISO_STEREO_MODULE_NAME,
                                      .size_bytes = sizeof(struct iso_stereo_module)};

/* May be called only after iso_stereo_module_load. */
static const struct iso_stereo_module *module(void)
{
    return (const struct iso_stereo_module *)slot.table;
}

int iso_stereo_module_load(struct iso_fault *fault)
{
    return iso_module_load(&slot, fault);
}

int iso_stereo_opencv_new(const struct iso_stereo_opencv_options *options,
                          struct iso_stereo_opencv **out)
{
    const int error = iso_stereo_module_load(NULL);
    return error ? error : module()->create(options, out);
}

void iso_stereo_opencv_free(struct iso_stereo_opencv *stereo)
{
    if (stereo) {
        module()->release(stereo);
    }
}

int iso_stereo_opencv_rectify(struct iso_stereo_opencv *stereo, int eye, const uint8_t *image,
                              uint8_t *rectified)
{
    return module()->rectify(stereo, eye, image, rectified);
}

int iso_stereo_opencv_match(struct iso_stereo_opencv *stereo, const uint8_t *left,
                            const uint8_t *right, float *disparity_px)
{
    return module()->match(stereo, left, right, disparity_px);
}

int iso_board_opencv_find(const uint8_t *image, int width_px, int height_px, int columns, int rows,
                          float (*corners_px)[2])
{
    const int error = iso_stereo_module_load(NULL);
    return error ? error
                 : module()->find_board(image, width_px, height_px, columns, rows, corners_px);
}

int iso_board_opencv_solve(const struct iso_board_opencv_problem *problem,
                           struct iso_board_opencv_solution *out)
{
    const int error = iso_stereo_module_load(NULL);
    return error ? error : module()->solve_board(problem, out);
}

int iso_board_opencv_solve_single(const struct iso_board_opencv_problem *problem,
                                  struct iso_board_opencv_single *out, double (*normals)[3])
{
    const int error = iso_stereo_module_load(NULL);
    return error ? error : module()->solve_board_single(problem, out, normals);
}
