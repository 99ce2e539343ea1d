#include "sim/world/sensor/sensor.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

const struct sim_sensor *const sim_sensors[] = {
    &sim_sensor_astra,
    &sim_sensor_kinect2,
    &sim_sensor_kinect2_coarse,
    &sim_sensor_d435,
    &sim_sensor_truedepth,
    &sim_sensor_texas,
#ifdef ISOTHERM_STEREO
    &sim_sensor_stereo,
    &sim_sensor_stereo_passive,
#endif
    NULL,
};

const struct sim_sensor *sim_sensor_find(const char *name)
{
    for (int i = 0; sim_sensors[i]; i++) {
        if (strcmp(sim_sensors[i]->name, name) == 0) {
            return sim_sensors[i];
        }
    }
    return NULL;
}

int sim_sensor_load(const struct sim_sensor *sensor, struct iso_fault *fault)
{
    struct iso_fault why = {.text = ""};
    const int error = sensor->load ? sensor->load(&why) : 0;
    return error ? iso_fault_set(fault, error, "sensor %s: %s", sensor->name, why.text) : 0;
}

int sim_sensor_workspace_new(const struct sim_sensor *sensor, struct sim_sensor_workspace **out)
{
    struct sim_sensor_workspace *workspace = calloc(1, sizeof *workspace);
    if (!workspace) {
        return -ENOMEM;
    }
    workspace->n_pixels = (size_t)sensor->camera.width_px * (size_t)sensor->camera.height_px;
    for (int i = 0; i < SIM_SENSOR_PLANES; i++) {
        workspace->plane[i] = malloc(workspace->n_pixels * sizeof(float));
        if (!workspace->plane[i]) {
            sim_sensor_workspace_free(workspace);
            return -ENOMEM;
        }
    }
    workspace->sensor = sensor;
    const int error = sensor->own_new ? sensor->own_new(&workspace->own) : 0;
    if (error) {
        sim_sensor_workspace_free(workspace);
        return error;
    }
    *out = workspace;
    return 0;
}

void sim_sensor_workspace_free(struct sim_sensor_workspace *workspace)
{
    if (!workspace) {
        return;
    }
    for (int i = 0; i < SIM_SENSOR_PLANES; i++) {
        free(workspace->plane[i]);
    }
    if (workspace->own) {
        workspace->sensor->own_free(workspace->own);
    }
    free(workspace);
}

void sim_sensor_attach(struct sim_sensor_workspace *workspace, struct sim_view *view)
{
    if (workspace->sensor->attach) {
        workspace->sensor->attach(workspace->own, view);
    }
}

void sim_sensor_begin(struct sim_sensor_workspace *workspace, struct sim_random *random)
{
    if (workspace->sensor->session) {
        workspace->sensor->session(workspace->own, random);
    }
}

void sim_sensor_measure(const struct sim_sensor *sensor, const struct sim_view *view,
                        double noise_scale, struct sim_random *random,
                        struct sim_sensor_workspace *workspace, struct iso_frame *frame)
{
    sensor->measure(view, noise_scale, random, workspace, frame->depth_mm);
    for (size_t i = 0; i < workspace->n_pixels; i++) {
        const double counts = nearbyint((double)frame->depth_mm[i] / sensor->unit_mm);
        frame->depth_mm[i] = counts >= 1.0 && counts <= 65535.0 ? (float)(counts * sensor->unit_mm)
                                                                : 0.0f;
    }
}
