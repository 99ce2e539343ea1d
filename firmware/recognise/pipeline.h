/* Finds the people of the gallery who look most like the face in a frame. The appliance uses a
 * class of functions, so that a test can replace it; this header also has the real one.
 *
 * The real one owns extractor, head model, an open recognition method (method/method.h), and
 * options. One pipeline is used by one thread; nothing is allocated for a frame. */
#ifndef ISO_FIRMWARE_RECOGNISE_PIPELINE_H
#define ISO_FIRMWARE_RECOGNISE_PIPELINE_H

#include <stdint.h>

#include "core/base/clock.h"
#include "core/base/fault.h"
#include "drivers/vision/face_check.h"
#include "firmware/recognise/method/method.h"
#include "isotherm/extract.h"

struct iso_pipeline_ops {
    /* The template of a frame, or the reason why there is none: out->outcome. `sensor` is the model
     * of the sensor ("" if unknown). -EINVAL a frame that cannot be processed, -EDOM, -ENOMEM. */
    int (*extract)(void *self, const struct iso_frame *frame, const char *sensor,
                   struct iso_extraction *out);

    /* Finds the best people among these for a probe: `search` of the recognition method, with its
     * errors (method/method.h). */
    int (*search)(void *self, const struct iso_candidate_list *among,
                  const struct iso_template *probe, struct iso_search_hit *hits, int capacity,
                  int *n_hits);

    /* OPTIONAL: the metric with which an index of people has to be made. NULL: people are compared
     * by their templates. */
    const struct iso_metric *(*metric)(const void *self);

    /* The algorithm of the templates that can be compared, and the head model. */
    uint32_t (*algorithm)(const void *self);
    uint32_t (*model)(const void *self);

    /* OPTIONAL: the head model itself, which the pipeline owns. NULL: no outline of a head is shown
     * to those who watch. */
    const struct iso_head_model *(*head)(const void *self);

    /* Frees the pipeline. NULL is not passed. */
    void (*close)(void *self);

    /* OPTIONAL: wipes the data of people that is kept, because a person was removed. */
    void (*forget)(void *self);

    /* OPTIONAL: the result of the image check for the face in the frame extracted last. */
    enum iso_face_seen (*seen)(const void *self);

    /* OPTIONAL: the use of that result: "off", "flag", "veto", or "absent" if the check was asked
     * for and the machine lacks something for it. */
    const char *(*image_check)(const void *self);

    /* OPTIONAL: what is missing for the check, and the package that contains it; "" if nothing. */
    const char *(*image_lacks)(const void *self);
};

/* The effect of a frame's infrared or grey image if it does not show the face that depth found. */
enum iso_image_check {
    ISO_IMAGE_OFF = 0, /* the image is not checked */
    ISO_IMAGE_FLAG,    /* the result is recorded */
    ISO_IMAGE_VETO,    /* also, the frame is not used: ISO_CAPTURE_NO_FACE_IN_IMAGE */
};

struct iso_pipeline {
    const struct iso_pipeline_ops *ops;
    void *self;
};

struct iso_pipeline_options {
    const char *head_path;
    enum iso_method method;             /* the method that compares templates */
    const char *data_path;              /* the method's data file; NULL or "": none */
    struct iso_extract_options extract; /* the pipeline sets the clock */
    struct iso_match_options match;     /* for methods that register templates */
    struct iso_clock clock;             /* measures the times of the stages */
    enum iso_image_check image;
    const char *cascade_path; /* NULL or "": the one that the build found */
};

/* Reads the head model and the method's data file, and prepares everything. -ENOENT and other
 * errors of reading the files, -EBADMSG one of them is damaged, -EINVAL options out of range or a
 * data file that was made with another model or other options, -ENOMEM; each with a fault. A
 * cascade that is named has to be usable: errors of iso_face_check_new. Without a name, the module
 * `vision` or the build's own cascade may be missing (-ENOENT); then images are not checked. What
 * options->clock points to must outlive the pipeline. */
int iso_pipeline_open(const struct iso_pipeline_options *options, struct iso_pipeline *out,
                      struct iso_fault *fault) __attribute__((warn_unused_result));

/* Closes and clears a pipeline. It may be all zero. */
void iso_pipeline_close(struct iso_pipeline *pipeline);

#endif
