#include "core/find/scene_motion.h"

#include <math.h>

/* The least change of a mean over half a second that counts. Noise changes it less, sway more. */
static const float change_mm = 100.0F;
static const int64_t window_ns = 500000000;
/* A face of 160 x 230 mm at 1.5 m covers 21 cells of an Astra and 9 of a D435. Some cells at the
 * edges of objects are measured in one frame and not in the next one. */
enum { CELLS_MIN = 4, APPEARED_MIN = 8, FRAMES_MIN = 3, STEP_PX = 2 };

/* The mean depth of the measured pixels of a cell, of which every second one in each direction is
 * read. 0 unless more than half of these are measured. */
static float mean_depth_mm(const struct iso_frame *frame, int row, int column)
{
    const int top = row * frame->height_px / ISO_SCENE_ROWS;
    const int bottom = (row + 1) * frame->height_px / ISO_SCENE_ROWS;
    const int left = column * frame->width_px / ISO_SCENE_COLUMNS;
    const int right = (column + 1) * frame->width_px / ISO_SCENE_COLUMNS;
    float sum_mm = 0.0F;
    int n = 0, all = 0;
    for (int y = top; y < bottom; y += STEP_PX) {
        for (int x = left; x < right; x += STEP_PX) {
            const float depth_mm = iso_frame_depth_at(frame, x, y);
            sum_mm += depth_mm;
            n += depth_mm > 0.0F;
            all++;
        }
    }
    return 2 * n > all ? sum_mm / (float)n : 0.0F;
}

/* Whether the depth of a cell changed. Only cells count that were measured both times and were
 * within reach at one of them. */
static bool is_changed(float was_mm, float is_mm, float reach_mm)
{
    return was_mm > 0.0F && is_mm > 0.0F && fminf(was_mm, is_mm) <= reach_mm &&
           fabsf(was_mm - is_mm) > change_mm;
}

static void add_frame(struct iso_scene_motion *scene, const struct iso_frame *frame, float reach_mm)
{
    scene->n_changed = scene->n_appeared = 0;
    for (int row = 0; row < ISO_SCENE_ROWS; row++) {
        for (int column = 0; column < ISO_SCENE_COLUMNS; column++) {
            struct iso_scene_cell *cell = &scene->cells[row][column];
            const float depth_mm = mean_depth_mm(frame, row, column);
            scene->n_changed += is_changed(cell->before_mm, depth_mm, reach_mm);
            scene->n_appeared += !(cell->before_mm > 0.0F) && depth_mm > 0.0F &&
                                 depth_mm <= reach_mm;
            cell->sum_mm += depth_mm;
            cell->n += depth_mm > 0.0F;
        }
    }
    scene->frames++;
    scene->latest_ns = frame->t_ns;
}

/* Ends a half second. Returns how many cells changed. */
static int end_window(struct iso_scene_motion *scene, float reach_mm)
{
    int n_changed = 0;
    for (int i = 0; i < ISO_SCENE_ROWS * ISO_SCENE_COLUMNS; i++) {
        struct iso_scene_cell *cell = &scene->cells[i / ISO_SCENE_COLUMNS][i % ISO_SCENE_COLUMNS];
        const float is_mm = 2 * cell->n > scene->frames ? cell->sum_mm / (float)cell->n : 0.0F;
        n_changed += is_changed(cell->before_mm, is_mm, reach_mm);
        *cell = (struct iso_scene_cell){.before_mm = is_mm};
    }
    scene->frames = 0;
    return n_changed;
}

bool iso_scene_motion_feed(struct iso_scene_motion *scene, const struct iso_frame *frame,
                           double reach_mm, int64_t quiet_ns)
{
    if (scene->width_px != frame->width_px || scene->height_px != frame->height_px ||
        frame->t_ns < scene->latest_ns) {
        *scene = (struct iso_scene_motion){
            .width_px = frame->width_px, .height_px = frame->height_px, .since_ns = frame->t_ns};
    }
    add_frame(scene, frame, (float)reach_mm);
    if (frame->t_ns - scene->since_ns >= window_ns && scene->frames >= FRAMES_MIN) {
        if (end_window(scene, (float)reach_mm) >= CELLS_MIN) {
            scene->moved = true;
            scene->moved_ns = frame->t_ns;
        }
        scene->since_ns = frame->t_ns;
        scene->compared = true;
    }
    return scene->moved && frame->t_ns - scene->moved_ns <= quiet_ns;
}

bool iso_scene_motion_stirs(const struct iso_scene_motion *scene)
{
    const bool has_cells = scene->width_px >= ISO_SCENE_COLUMNS &&
                           scene->height_px >= ISO_SCENE_ROWS;
    return !has_cells || !scene->compared || scene->n_changed >= CELLS_MIN ||
           scene->n_appeared >= APPEARED_MIN;
}
