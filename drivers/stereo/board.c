#include "drivers/stereo/board.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
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

static int reserve_view(struct iso_board_views *views)
{
    if (views->n_pairs < views->capacity) {
        return 0;
    }
    const int capacity = 2 * views->capacity + 16;
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
    int error = reserve_view(views);
    for (int eye = 0; !error && eye < ISO_EYES; eye++) {
        error = iso_board_opencv_find(
            images[eye], views->width_px, views->height_px, board->columns, board->rows,
            views->corners_px[eye] + (size_t)views->n_pairs * corners_of(views));
    }
    views->n_pairs += error == 0;
    return error;
}

static struct iso_camera camera_of(const struct iso_board_views *views,
                                   const struct iso_board_opencv_camera *found)
{
    return (struct iso_camera){.projection = ISO_PINHOLE,
                               .width_px = views->width_px,
                               .height_px = views->height_px,
                               .fx_px = found->fx_px,
                               .fy_px = found->fy_px,
                               .cx_px = found->cx_px,
                               .cy_px = found->cy_px,
                               .k1 = found->k1,
                               .k2 = found->k2,
                               .p1 = found->p1,
                               .p2 = found->p2};
}

static void convert_solution(const struct iso_board_views *views,
                             const struct iso_board_opencv_solution *found,
                             struct iso_stereo_calibration *out)
{
    *out = (struct iso_stereo_calibration){.pairs = views->n_pairs, .rms_px = found->rms_px};
    for (int eye = 0; eye < ISO_EYES; eye++) {
        out->camera[eye] = camera_of(views, &found->camera[eye]);
    }
    for (int i = 0; i < 9; i++) {
        out->right_from_left.rotation.m[i / 3][i % 3] = found->rotation[i];
    }
    out->right_from_left.translation_mm = iso_vec3(
        found->translation_mm[0], found->translation_mm[1], found->translation_mm[2]);
}

static struct iso_board_opencv_problem problem_of(const struct iso_board_views *views)
{
    return (struct iso_board_opencv_problem){
        .columns = views->board.columns,
        .rows = views->board.rows,
        .n_pairs = views->n_pairs,
        .width_px = views->width_px,
        .height_px = views->height_px,
        .square_mm = views->board.square_mm,
        .corners_px = {(const float(*)[2])views->corners_px[ISO_EYE_LEFT],
                       (const float(*)[2])views->corners_px[ISO_EYE_RIGHT]},
    };
}

int iso_board_calibrate(const struct iso_board_views *views, void (*solved)(void *context),
                        void *context, struct iso_stereo_calibration *out, struct iso_fault *fault)
{
    struct iso_board_opencv_problem problem = problem_of(views);
    problem.solved = solved;
    problem.context = context;
    struct iso_board_opencv_solution found;
    struct iso_stereo_calibration calibration;
    struct iso_fault why;
    if (views->n_pairs < ISO_BOARD_PAIRS_MIN) {
        return iso_fault_set(fault, -ENODATA,
                             "calibration: %d pairs show the whole board, %d are needed",
                             views->n_pairs, ISO_BOARD_PAIRS_MIN);
    }
    const int error = iso_board_opencv_solve(&problem, &found);
    if (error) {
        return iso_fault_set(fault, error, "calibration: %s",
                             error == -ENOMEM ? "out of memory" : "the solver gave up");
    }
    convert_solution(views, &found, &calibration);
    if (iso_stereo_calibration_check(&calibration, &why)) {
        return iso_fault_set_code(fault, why.code, -ENODATA, "calibration: %s", why.text);
    }
    *out = calibration;
    return 0;
}

/* ---- one camera ---- */

/* Two pictures whose corners are closer than this share of the width count as one view. */
static const double same_share = 0.01;
/* The share of the picture that all boards together have to cover. */
static const double cover_share = 0.6;
/* The least angle between the two boards that differ most. */
static const double turn_min_deg = 20.0;
/* With a larger error the corners do not belong to such a board, or are blurred. */
static const double rms_max_px = 1.0;

int iso_board_views_add_single(struct iso_board_views *views, const uint8_t *image)
{
    int error = reserve_view(views);
    if (!error) {
        error = iso_board_opencv_find(
            image, views->width_px, views->height_px, views->board.columns, views->board.rows,
            views->corners_px[ISO_EYE_LEFT] + (size_t)views->n_pairs * corners_of(views));
    }
    views->n_pairs += error == 0;
    return error;
}

static const float (*corners_at(const struct iso_board_views *views, int view))[2]
{
    return (const float(*)[2])views->corners_px[ISO_EYE_LEFT] + (size_t)view * corners_of(views);
}

/* The mean distance between the corners of two views. */
static double distance_px(const struct iso_board_views *views, int a, int b)
{
    const float(*of_a)[2] = corners_at(views, a), (*of_b)[2] = corners_at(views, b);
    double sum = 0.0;
    for (size_t i = 0; i < corners_of(views); i++) {
        sum += hypot((double)(of_a[i][0] - of_b[i][0]), (double)(of_a[i][1] - of_b[i][1]));
    }
    return sum / (double)corners_of(views);
}

/* Counts the views that differ from all views before them. */
static int count_different(const struct iso_board_views *views)
{
    int different = 0;
    for (int i = 0; i < views->n_pairs; i++) {
        bool same = false;
        for (int j = 0; j < i && !same; j++) {
            same = distance_px(views, i, j) < same_share * views->width_px;
        }
        different += !same;
    }
    return different;
}

/* The share of the picture's width (axis 0) or height (axis 1) over which corners were seen. */
static double cover_picture(const struct iso_board_views *views, int axis)
{
    const float(*corner)[2] = corners_at(views, 0);
    float low = corner[0][axis], high = low;
    for (size_t i = 0; i < (size_t)views->n_pairs * corners_of(views); i++) {
        low = fminf(low, corner[i][axis]);
        high = fmaxf(high, corner[i][axis]);
    }
    return (double)(high - low) / (axis == 0 ? views->width_px : views->height_px);
}

/* Checks before the calibration whether there are enough views. */
static int check_views(const struct iso_board_views *views, struct iso_fault *fault)
{
    static const char *const sides[2] = {"width", "height"};
    const int different = count_different(views);
    if (views->n_pairs < ISO_BOARD_VIEWS_MIN) {
        return iso_fault_set(fault, -ENODATA,
                             "calibration: %d pictures show the whole board, %d are needed",
                             views->n_pairs, ISO_BOARD_VIEWS_MIN);
    }
    if (different < ISO_BOARD_VIEWS_MIN) {
        return iso_fault_set(fault, -ENODATA,
                             "calibration: only %d of %d pictures differ, %d are needed: move and "
                             "turn the board between the pictures",
                             different, views->n_pairs, ISO_BOARD_VIEWS_MIN);
    }
    for (int axis = 0; axis < 2; axis++) {
        const double share = cover_picture(views, axis);
        if (share < cover_share) {
            return iso_fault_set(fault, -ENODATA,
                                 "calibration: the board was seen over %.0f %% of the picture's "
                                 "%s, %.0f %% are needed: show it near the borders, too",
                                 100.0 * share, sides[axis], 100.0 * cover_share);
        }
    }
    return 0;
}

/* The largest angle between two boards. */
static double largest_turn_deg(double (*normals)[3], int n)
{
    double least = 1.0;
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < i; j++) {
            least = fmin(least, normals[i][0] * normals[j][0] + normals[i][1] * normals[j][1] +
                                    normals[i][2] * normals[j][2]);
        }
    }
    return acos(fmax(least, -1.0)) * 180.0 / M_PI;
}

/* Checks after the calibration whether the result is credible. */
static int check_lens(const struct iso_board_lens *lens, double turn_deg, struct iso_fault *fault)
{
    struct iso_fault why;
    if (turn_deg < turn_min_deg) {
        return iso_fault_set(fault, -ENODATA,
                             "calibration: the board is turned by at most %.0f degrees between the "
                             "pictures, %.0f are needed: tilt it to all sides",
                             turn_deg, turn_min_deg);
    }
    if (!(lens->rms_px <= rms_max_px)) {
        return iso_fault_set(
            fault, -ENODATA,
            "calibration: corners and model differ by %.2f px, more than %.0f: are "
            "--columns, --rows and the pictures right?",
            lens->rms_px, rms_max_px);
    }
    return iso_camera_check(&lens->camera, &why)
               ? iso_fault_set_code(fault, why.code, -ENODATA, "calibration: %s", why.text)
               : 0;
}

int iso_board_calibrate_single(const struct iso_board_views *views, struct iso_board_lens *out,
                               struct iso_fault *fault)
{
    const struct iso_board_opencv_problem problem = problem_of(views);
    struct iso_board_opencv_single found;
    int error = check_views(views, fault);
    if (error) {
        return error;
    }
    double(*normals)[3] = calloc((size_t)views->n_pairs, sizeof *normals);
    if (!normals) {
        return iso_fault_set(fault, -ENOMEM, "calibration: out of memory");
    }
    error = iso_board_opencv_solve_single(&problem, &found, normals);
    const double turn_deg = error ? 0.0 : largest_turn_deg(normals, views->n_pairs);
    free(normals);
    if (error) {
        return iso_fault_set(fault, error, "calibration: %s",
                             error == -ENOMEM ? "out of memory" : "the solver gave up");
    }
    const struct iso_board_lens lens = {camera_of(views, &found.camera), views->n_pairs,
                                        found.rms_px};
    error = check_lens(&lens, turn_deg, fault);
    if (!error) {
        *out = lens;
    }
    return error;
}
