#include "drivers/stereo/board.h"

#include <errno.h>
#include <stdlib.h>

#include "drivers/stereo/stereo_module.h"

struct iso_board_views {
    struct iso_board board;
    int width_px, height_px;
    int n_pairs, capacity;
    float (*corners_px[ISO_EYES])[2]; /* [capacity * columns * rows] */
};

int iso_board_views_new(const struct iso_board *board, int width_px, int height_px,
                        struct iso_board_views **out, struct iso_fault *fault)
{
    if (board->columns < 3 || board->columns > 64 || board->rows < 3 || board->rows > 64) {
        return iso_fault_set(fault, -EINVAL, "board: 3 to 64 corners each way, not %d x %d",
                             board->columns, board->rows);
    }
    if (!(board->square_mm >= 1.0 && board->square_mm <= 1000.0)) {
        return iso_fault_set(fault, -EINVAL, "board: squares of 1 to 1000 mm, not %g",
                             board->square_mm);
    }
    if (width_px < 64 || width_px > 8192 || height_px < 64 || height_px > 8192) {
        return iso_fault_set(fault, -EINVAL, "board: pictures of 64 to 8192 px a side, not %d x %d",
                             width_px, height_px);
    }
    const int error = iso_stereo_module_load(fault);
    if (error) {
        return error;
    }
    struct iso_board_views *views = calloc(1, sizeof *views);
    if (!views) {
        return iso_fault_set(fault, -ENOMEM, "board: out of memory");
    }
    *views = (struct iso_board_views){
        .board = *board, .width_px = width_px, .height_px = height_px};
    *out = views;
    return 0;
}

void iso_board_views_free(struct iso_board_views *views)
{
    if (views) {
        free(views->corners_px[ISO_EYE_LEFT]);
        free(views->corners_px[ISO_EYE_RIGHT]);
        free(views);
    }
}

int iso_board_views_count(const struct iso_board_views *views)
{
    return views->n_pairs;
}

static size_t corners_of(const struct iso_board_views *views)
{
    return (size_t)views->board.columns * (size_t)views->board.rows;
}

static int reserve(struct iso_board_views *views)
{
    if (views->n_pairs < views->capacity) {
        return 0;
    }
    int capacity = 2 * views->capacity + 16;
    for (int eye = 0; eye < ISO_EYES; eye++) {
        void *corners = reallocarray(views->corners_px[eye], (size_t)capacity * corners_of(views),
                                     sizeof(float[2]));
        if (!corners) {
            return -ENOMEM;
        }
        views->corners_px[eye] = corners;
    }
    views->capacity = capacity;
    return 0;
}

int iso_board_views_add(struct iso_board_views *views, const uint8_t *left, const uint8_t *right)
{
    const struct iso_board *board = &views->board;
    const uint8_t *const images[ISO_EYES] = {left, right};
    int error = reserve(views);
    for (int eye = 0; !error && eye < ISO_EYES; eye++) {
        error = iso_board_opencv_find(
            images[eye], views->width_px, views->height_px, board->columns, board->rows,
            views->corners_px[eye] + (size_t)views->n_pairs * corners_of(views));
    }
    views->n_pairs += error == 0;
    return error;
}

static void convert(const struct iso_board_views *views,
                    const struct iso_board_opencv_solution *found,
                    struct iso_stereo_calibration *out)
{
    *out = (struct iso_stereo_calibration){.pairs = views->n_pairs, .rms_px = found->rms_px};
    for (int eye = 0; eye < ISO_EYES; eye++) {
        const struct iso_board_opencv_camera *c = &found->camera[eye];
        out->camera[eye] = (struct iso_camera){.projection = ISO_PINHOLE,
                                               .width_px = views->width_px,
                                               .height_px = views->height_px,
                                               .fx_px = c->fx_px,
                                               .fy_px = c->fy_px,
                                               .cx_px = c->cx_px,
                                               .cy_px = c->cy_px,
                                               .k1 = c->k1,
                                               .k2 = c->k2,
                                               .p1 = c->p1,
                                               .p2 = c->p2};
    }
    for (int i = 0; i < 9; i++) {
        out->right_from_left.rotation.m[i / 3][i % 3] = found->rotation[i];
    }
    out->right_from_left.translation_mm = iso_vec3(
        found->translation_mm[0], found->translation_mm[1], found->translation_mm[2]);
}

int iso_board_calibrate(const struct iso_board_views *views, struct iso_stereo_calibration *out,
                        struct iso_fault *fault)
{
    const struct iso_board_opencv_problem problem = {
        .columns = views->board.columns,
        .rows = views->board.rows,
        .n_pairs = views->n_pairs,
        .width_px = views->width_px,
        .height_px = views->height_px,
        .square_mm = views->board.square_mm,
        .corners_px = {(const float(*)[2])views->corners_px[ISO_EYE_LEFT],
                       (const float(*)[2])views->corners_px[ISO_EYE_RIGHT]},
    };
    struct iso_board_opencv_solution found;
    struct iso_stereo_calibration calibration;
    const char *what = "";
    if (views->n_pairs < ISO_BOARD_PAIRS_MIN) {
        return iso_fault_set(fault, -ENODATA,
                             "calibration: %d pairs show the whole board, %d are needed",
                             views->n_pairs, ISO_BOARD_PAIRS_MIN);
    }
    int error = iso_board_opencv_solve(&problem, &found);
    if (error) {
        return iso_fault_set(fault, error, "calibration: %s",
                             error == -ENOMEM ? "out of memory" : "the solver gave up");
    }
    convert(views, &found, &calibration);
    if (iso_stereo_calibration_check(&calibration, &what)) {
        return iso_fault_set(fault, -ENODATA, "calibration: %s", what);
    }
    *out = calibration;
    return 0;
}
