#include "sim/world/scene/portrait.h"

#include "sim/world/sensor/infrared.h"
#include "sim/world/sensor/sensor.h"

/* An ideal camera in a lit room. */
static const struct sim_sensor camera = {
    .name = "portrait",
    .camera = {.projection = ISO_ORTHOGRAPHIC,
               .width_px = SIM_PORTRAIT_COLUMNS,
               .height_px = SIM_PORTRAIT_ROWS,
               .pitch_mm = 1.0,
               .cx_px = 0.5 * (SIM_PORTRAIT_COLUMNS - 1),
               .cy_px = 0.5 * (SIM_PORTRAIT_ROWS - 1)},
    .supersample = 2,
    .infrared = {.level = 1.2, .bits = 8, .ambient = true},
};

static const double distance_mm = 600.0, nose_below_mm = 10.0;
/* The darkest and the lightest albedo of a print. */
static const float ink = 0.05F, paper = 0.8F;

int sim_portrait(struct sim_sitter *sitter, float *albedo)
{
    const struct sim_stance ahead = {.nose_mm = {0.0, nose_below_mm, distance_mm}};
    struct sim_random unused = sim_random_seeded(0, 0, 0);
    struct sim_sensor_workspace *workspace = NULL;
    struct sim_view *view = NULL;
    int error = sim_view_new(&camera.camera, camera.supersample, &view);
    if (error == 0) {
        error = sim_sensor_workspace_new(&camera, &workspace);
    }
    if (error == 0) {
        error = sim_sitter_draw(sitter, &ahead, view, NULL);
    }
    if (error == 0) {
        sim_view_finish(view);
        sim_infrared_measure(&camera, view, 0.0, &unused, workspace, albedo);
        for (int i = 0; i < SIM_PORTRAIT_COLUMNS * SIM_PORTRAIT_ROWS; i++) {
            albedo[i] = ink + (paper - ink) * albedo[i];
        }
    }
    sim_sensor_workspace_free(workspace);
    sim_view_free(view);
    return error;
}
