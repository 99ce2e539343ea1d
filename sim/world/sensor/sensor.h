/* Models of depth sensors: from the true scene (a finished view) to what a sensor reports.
 *
 * Every model states its constants and where they were published at the top of its .c file, and its
 * measured noise is checked against them by tests/sim/world/test_sensor_noise.c. */
#ifndef SIM_WORLD_SENSOR_SENSOR_H
#define SIM_WORLD_SENSOR_SENSOR_H

#include <stdbool.h>

#include "core/base/fault.h"
#include "isotherm/frame.h"
#include "sim/base/random.h"
#include "sim/world/sensor/infrared.h"
#include "sim/world/view/view.h"

/* Planes of the sensor's size for a model's own use. */
enum { SIM_SENSOR_PLANES = 6 };

struct sim_sensor_workspace {
    size_t n_pixels;
    float *plane[SIM_SENSOR_PLANES]; /* [n_pixels] each */
    const struct sim_sensor *sensor;
    void *own; /* what the model makes for itself */
};

struct sim_sensor {
    const char *name, *summary;
    struct iso_camera camera;
    double unit_mm;  /* of a count in its recordings */
    int supersample; /* of the view that the model needs */
    bool face_only; /* it is used for faces without surroundings: nothing but the head is in view */
    double distance_min_mm, distance_max_mm; /* where people stand before it, nose tip */
    struct sim_infrared infrared;            /* its image beside the depth */
    /* Fills depth_mm, 0 where nothing is measured. noise_scale multiplies every random error (1: as
     * published). */
    void (*measure)(const struct sim_view *view, double noise_scale, struct sim_random *random,
                    struct sim_sensor_workspace *workspace, float *depth_mm);
    /* The following may be NULL: loads the module that the model needs (drivers/base/module.h);
     * what the model makes for itself, once; how it gives a view the other eyes that it looks
     * through. */
    int (*load)(struct iso_fault *fault);
    int (*own_new)(void **own);
    void (*own_free)(void *own);
    void (*attach)(void *own, struct sim_view *view);
    /* The picture that belongs to the depths measured last, 0..1, of sensors that take one; of the
     * others `infrared` says what theirs is like. */
    void (*picture)(const void *own, float *intensity);
};

extern const struct sim_sensor sim_sensor_astra, sim_sensor_kinect2, sim_sensor_d435,
    sim_sensor_truedepth, sim_sensor_texas;
#ifdef ISOTHERM_STEREO
extern const struct sim_sensor sim_sensor_stereo, sim_sensor_stereo_passive;
#endif

/* All of them, ended by NULL. */
extern const struct sim_sensor *const sim_sensors[];

/* By name, or NULL. */
const struct sim_sensor *sim_sensor_find(const char *name);

/* Loads what a sensor needs beside the program, so that a missing module is reported before
 * anything is rendered. The errors of iso_module_load. */
int sim_sensor_load(const struct sim_sensor *sensor, struct iso_fault *fault)
    __attribute__((warn_unused_result));

int sim_sensor_workspace_new(const struct sim_sensor *sensor, struct sim_sensor_workspace **out)
    __attribute__((warn_unused_result));
void sim_sensor_workspace_free(struct sim_sensor_workspace *workspace);

/* Prepares a view for a sensor that sees with more than one eye: to be called before anything is
 * drawn that the sensor shall measure. The workspace must outlive the view. */
void sim_sensor_attach(struct sim_sensor_workspace *workspace, struct sim_view *view);

/* One frame: measures a finished view of this sensor (sim_view_new with its camera and
 * supersample; sim_sensor_attach), as the sensor's recordings would hold it, i.e. rounded to
 * unit_mm. The frame has the sensor's size. */
void sim_sensor_measure(const struct sim_sensor *sensor, const struct sim_view *view,
                        double noise_scale, struct sim_random *random,
                        struct sim_sensor_workspace *workspace, struct iso_frame *frame);

#endif
