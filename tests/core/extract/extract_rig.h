/* An extractor with the shipped head model, and a frame in which the mean head is rendered. */
#ifndef TESTS_CORE_EXTRACT_EXTRACT_RIG_H
#define TESTS_CORE_EXTRACT_EXTRACT_RIG_H

#include "isotherm/extract.h"

struct extract_rig {
    struct iso_head_model *model;
    struct iso_extract_options options; /* the defaults at first */
    struct iso_extractor *extractor;
    struct iso_frame *frame;
    struct iso_extraction out; /* the result of the last run */
};

/* The set-up and the tear-down of a cmocka test whose state is the rig. */
int extract_rig_new(void **state);
int extract_rig_free(void **state);

/* Replaces the extractor of the rig by a new one with the present options of the rig. */
void extract_rig_renew(struct extract_rig *rig);

/* Draws the mean head alone into the frame, with its nose tip at nose_mm in the camera frame. */
void extract_rig_draw(struct extract_rig *rig, double yaw_deg, double pitch_deg,
                      struct iso_vec3 nose_mm);

/* Runs the extractor on the frame and returns the outcome. An error fails the test. */
enum iso_capture extract_rig_run(struct extract_rig *rig);

/* Draws the mean head, then runs the extractor and returns the outcome. */
enum iso_capture extract_rig_outcome(struct extract_rig *rig, double yaw_deg, double pitch_deg,
                                     struct iso_vec3 nose_mm);

#endif
