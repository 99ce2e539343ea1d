/* From a frame to those in the gallery who look most like it: the class that the appliance sees, so
 * that a test can put something else in its place, and the real one.
 *
 * The real one owns extractor, head model, an open recognition method (method/method.h), and
 * options. One pipeline is used by
 * one thread; nothing is allocated per frame. */
#ifndef ISO_FIRMWARE_RECOGNISE_PIPELINE_H
#define ISO_FIRMWARE_RECOGNISE_PIPELINE_H

#include <stdint.h>

#include "core/base/clock.h"
#include "core/base/fault.h"
#include "drivers/vision/face_check.h"
#include "firmware/recognise/method/method.h"
#include "isotherm/extract.h"

struct iso_pipeline_ops {
    /* The template of a frame, or why there is none: out->outcome. `sensor` is the model of the
     * sensor ("" if unknown). -EINVAL a frame that cannot be worked on, -EDOM, -ENOMEM. */
    int (*extract)(void *self, const struct iso_frame *frame, const char *sensor,
                   struct iso_extraction *out);

    /* The best people among these for a probe: `search` of the recognition method, with its errors
     * (method/method.h). */
    int (*search)(void *self, const struct iso_candidate_list *among,
                  const struct iso_template *probe, struct iso_search_hit *hits, int capacity,
                  int *n_hits);

    /* OPTIONAL: what an index of people has to be made by; NULL: there is none, people are compared
     * by their templates. */
    const struct iso_metric *(*metric)(const void *self);

    /* Whose templates can be compared, and which head model they come from. */
    uint32_t (*algorithm)(const void *self);
    uint32_t (*model)(const void *self);

    /* NULL is not passed. */
    void (*close)(void *self);

    /* OPTIONAL: wipes what is kept of people, of whom somebody was removed. */
    void (*forget)(void *self);

    /* OPTIONAL: what the image said of the face in the frame extracted last. */
    enum iso_face_seen (*seen)(const void *self);

    /* OPTIONAL: what is done with that: "off", "flag", "veto", or "absent" if it was asked for and
     * the machine lacks what it needs. */
    const char *(*image_check)(const void *self);

    /* OPTIONAL: what it lacks, and the package that has it; "" if nothing. */
    const char *(*image_lacks)(const void *self);
};

/* What a frame's infrared or grey image may do that does not show the face that depth found. */
enum iso_image_check {
    ISO_IMAGE_OFF = 0, /* it is not looked at */
    ISO_IMAGE_FLAG,    /* it is put on record */
    ISO_IMAGE_VETO,    /* and the frame is not used: ISO_CAPTURE_NO_FACE_IN_IMAGE */
};

struct iso_pipeline {
    const struct iso_pipeline_ops *ops;
    void *self;
};

struct iso_pipeline_options {
    const char *head_path;
    enum iso_method method;             /* what compares templates */
    const char *data_path;              /* the method's data file; NULL or "": none */
    struct iso_extract_options extract; /* sensor and clock are set by the pipeline */
    struct iso_match_options match;     /* for methods that register templates */
    struct iso_clock clock;             /* for the times of the stages */
    enum iso_image_check image;
    const char *cascade_path; /* NULL or "": the one that the build found */
};

/* Reads the head model and the method's data file, and makes everything ready. -ENOENT and other
 * errors of reading the files, -EBADMSG one of them is damaged, -EINVAL options out of range or a
 * data file that was made with another model or other options, -ENOMEM; each with a fault. A
 * cascade that is named has to be good: errors of iso_face_check_new; without one, the module
 * `vision` or the build's own cascade may be missing (-ENOENT): images are then not checked. What
 * options->clock points to must outlive the pipeline. */
int iso_pipeline_open(const struct iso_pipeline_options *options, struct iso_pipeline *out,
                      struct iso_fault *fault) __attribute__((warn_unused_result));

/* Closes and clears it; one that is all zero is fine. */
void iso_pipeline_close(struct iso_pipeline *pipeline);

#endif
