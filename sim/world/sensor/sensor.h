/* Models of depth sensors: they turn the true scene (a finished view) into the frames of a sensor.
 *
 * Every model states its constants and their publications at the top of its .c file.
 * tests/sim/world/test_sensor_noise.c checks the measured noise of the models against them. */
#ifndef SIM_WORLD_SENSOR_SENSOR_H
#define SIM_WORLD_SENSOR_SENSOR_H

#include <stdbool.h>

#include "core/base/fault.h"
#include "isotherm/frame.h"
#include "sim/base/random.h"
#include "sim/world/sensor/infrared.h"
#include "sim/world/view/view.h"

/* Memory for a sensor model: planes of the sensor's size, and the model's own data. */
enum { SIM_SENSOR_PLANES = 6 };

struct sim_sensor_workspace {
    size_t n_pixels;
    float *plane[SIM_SENSOR_PLANES]; /* [n_pixels] each */
    const struct sim_sensor *sensor;
    void *own; /* the model's own data */
};

struct sim_sensor {
    const char *name, *summary;
    struct iso_camera camera;
    double unit_mm;  /* of one count in its recordings */
    int supersample; /* of the view that the model needs */
    bool face_only;  /* for faces without surroundings: only the head is in view */
    double distance_min_mm, distance_max_mm; /* usual distance of the nose tip */
    struct sim_infrared infrared;            /* its infrared image */
    /* Fills depth_mm; 0 marks a pixel without a measurement. noise_scale multiplies every random
     * error (1: as published). */
    void (*measure)(const struct sim_view *view, double noise_scale, struct sim_random *random,
                    struct sim_sensor_workspace *workspace, float *depth_mm);
    /* OPTIONAL: loads the module that the model needs (drivers/base/module.h); makes the model's
     * own data, once; gives a view the other eyes through which the model looks. */
    int (*load)(struct iso_fault *fault);
    int (*own_new)(void **own);
    void (*own_free)(void *own);
    void (*attach)(void *own, struct sim_view *view);
    /* OPTIONAL: draws what stays the same during a recording, such as the steps of the depths. */
    void (*session)(void *own, struct sim_random *random);
    /* OPTIONAL: the picture, 0..1, that belongs to the depths measured last, for sensors that
     * take one. `infrared` describes the image of the others. */
    void (*picture)(const void *own, float *intensity);
};

extern const struct sim_sensor sim_sensor_astra, sim_sensor_kinect2, sim_sensor_kinect2_coarse,
    sim_sensor_d435, sim_sensor_truedepth, sim_sensor_texas;
#ifdef ISOTHERM_STEREO
extern const struct sim_sensor sim_sensor_stereo, sim_sensor_stereo_passive;
#endif

/* All sensor models; NULL ends the list. */
extern const struct sim_sensor *const sim_sensors[];

/* The model with this name, or NULL. */
const struct sim_sensor *sim_sensor_find(const char *name);

/* Loads the modules that a sensor needs, so that a missing module is reported before any
 * rendering. The errors of iso_module_load. */
int sim_sensor_load(const struct sim_sensor *sensor, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Makes the memory that a sensor needs. The sensor must outlive it. -ENOMEM, or the error of the
 * model's own_new. */
int sim_sensor_workspace_new(const struct sim_sensor *sensor, struct sim_sensor_workspace **out)
    __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void sim_sensor_workspace_free(struct sim_sensor_workspace *workspace);

/* Prepares a view for a sensor that sees with more than one eye. Call it before you draw
 * anything that the sensor shall measure. The workspace must outlive the view. */
void sim_sensor_attach(struct sim_sensor_workspace *workspace, struct sim_view *view);

/* Begins a recording: draws the model's properties that differ between recordings and stay the same
 * during one. A model without such properties draws nothing. Before the first call the properties
 * have fixed values in the middle of their ranges. */
void sim_sensor_begin(struct sim_sensor_workspace *workspace, struct sim_random *random);

/* Measures one frame from a finished view of this sensor (sim_view_new with its camera and
 * supersample; sim_sensor_attach). Depths are rounded to unit_mm as in the sensor's recordings.
 * The frame has the sensor's size. */
void sim_sensor_measure(const struct sim_sensor *sensor, const struct sim_view *view,
                        double noise_scale, struct sim_random *random,
                        struct sim_sensor_workspace *workspace, struct iso_frame *frame);

#endif
