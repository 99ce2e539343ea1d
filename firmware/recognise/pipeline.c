#include "firmware/recognise/pipeline.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/model/model_file.h"

struct pipeline {
    struct iso_head_model *head;
    struct iso_extractor *extractor;
    const struct iso_method_ops *method;
    void *comparison; /* the state of the method; NULL: it is not open */
    enum iso_image_check image;
    struct iso_fault image_lacks; /* why face_check is missing; "" if it is there or not needed */
    struct iso_face_check *face_check; /* NULL: images are not checked */
    enum iso_face_seen seen;           /* the result for the image of the last frame */
};

/* Checks a usable face in the image. If the check has a veto, the frame loses its template when the
 * image contradicts or cannot be checked. */
static int check_image(struct pipeline *pipeline, const struct iso_frame *frame,
                       struct iso_extraction *out)
{
    struct iso_face_checked checked = {.seen = ISO_FACE_NOT_CHECKED};
    const bool veto = pipeline->image == ISO_IMAGE_VETO;
    const int error = iso_face_check_run(pipeline->face_check, frame, &out->camera_from_face,
                                         out->landmark_mm, &checked);
    pipeline->seen = checked.seen;
    if (veto && (error || iso_face_seen_disagrees(checked.seen))) {
        out->outcome = ISO_CAPTURE_NO_FACE_IN_IMAGE;
        iso_template_wipe(&out->tmpl);
    }
    return veto ? error : 0;
}

static int pipeline_extract(void *self, const struct iso_frame *frame, const char *sensor,
                            struct iso_extraction *out)
{
    struct pipeline *pipeline = self;
    int error = iso_extractor_run(pipeline->extractor, frame, out);
    pipeline->seen = ISO_FACE_NOT_CHECKED;
    if (!error && out->outcome == ISO_CAPTURE_OK && pipeline->face_check) {
        error = check_image(pipeline, frame, out);
    }
    if (!error && out->outcome == ISO_CAPTURE_OK && *sensor) {
        (void)snprintf(out->tmpl.sensor, sizeof out->tmpl.sensor, "%s", sensor);
    }
    return error;
}

static int pipeline_search(void *self, const struct iso_candidate_list *among,
                           const struct iso_template *probe, struct iso_search_hit *hits,
                           int capacity, int *n_hits)
{
    const struct pipeline *pipeline = self;
    return pipeline->method->search(pipeline->comparison, among, probe, hits, capacity, n_hits);
}

static const struct iso_metric *pipeline_metric(const void *self)
{
    const struct pipeline *pipeline = self;
    return pipeline->method->metric ? pipeline->method->metric(pipeline->comparison) : NULL;
}

static uint32_t pipeline_algorithm(const void *self)
{
    return iso_extractor_algorithm(((const struct pipeline *)self)->extractor);
}

static uint32_t pipeline_model(const void *self)
{
    return ((const struct pipeline *)self)->head->crc32;
}

static const struct iso_head_model *pipeline_head(const void *self)
{
    return ((const struct pipeline *)self)->head;
}

static enum iso_face_seen pipeline_seen(const void *self)
{
    return ((const struct pipeline *)self)->seen;
}

static const char *pipeline_image_check(const void *self)
{
    static const char *const words[] = {"off", "flag", "veto"};
    const struct pipeline *pipeline = self;
    const bool absent = pipeline->image != ISO_IMAGE_OFF && !pipeline->face_check;
    return absent ? "absent" : words[pipeline->image];
}

static const char *pipeline_image_lacks(const void *self)
{
    return ((const struct pipeline *)self)->image_lacks.text;
}

static void pipeline_close(void *self)
{
    struct pipeline *pipeline = self;
    iso_face_check_free(pipeline->face_check);
    iso_extractor_free(pipeline->extractor);
    if (pipeline->comparison) {
        pipeline->method->close(pipeline->comparison);
    }
    iso_head_model_free(pipeline->head);
    free(pipeline);
}

static void pipeline_forget(void *self)
{
    const struct pipeline *pipeline = self;
    if (pipeline->method->forget) {
        pipeline->method->forget(pipeline->comparison);
    }
}

static const struct iso_pipeline_ops ops = {
    .extract = pipeline_extract,
    .search = pipeline_search,
    .metric = pipeline_metric,
    .algorithm = pipeline_algorithm,
    .model = pipeline_model,
    .head = pipeline_head,
    .close = pipeline_close,
    .forget = pipeline_forget,
    .seen = pipeline_seen,
    .image_check = pipeline_image_check,
    .image_lacks = pipeline_image_lacks,
};

static int make_extractor(struct pipeline *pipeline, const struct iso_pipeline_options *options,
                          struct iso_fault *fault)
{
    struct iso_extract_options extract = options->extract;
    extract.now_ns = options->clock.now_ns;
    extract.now_context = options->clock.context;
    const int error = iso_extractor_new(pipeline->head, &extract, &pipeline->extractor);
    return error ? iso_fault_set(fault, error, "extractor: %s",
                                 error == -EINVAL ? "options out of range" : "out of memory")
                 : 0;
}

static int open_method(struct pipeline *pipeline, const struct iso_pipeline_options *options,
                       struct iso_fault *fault)
{
    const struct iso_method_setup setup = {
        .data_path = options->data_path ? options->data_path : "",
        .algorithm = iso_extractor_algorithm(pipeline->extractor),
        .match = options->match,
    };
    pipeline->method = iso_method_at(options->method);
    return pipeline->method->open(&setup, &pipeline->comparison, fault);
}

/* A cascade that the configuration names must exist. Without a name, a machine that lacks the
 * module or its data runs without the check. A module that is installed but cannot be used is a
 * fault, because the configuration asked for the check. */
static int make_face_check(struct pipeline *pipeline, const struct iso_pipeline_options *options,
                           struct iso_fault *fault)
{
    const char *path = options->cascade_path ? options->cascade_path : "";
    struct iso_fault reason = {.text = ""};
    if (options->image == ISO_IMAGE_OFF) {
        return 0;
    }
    const int error = iso_face_check_new(path, &pipeline->face_check, &reason);
    pipeline->image_lacks = reason;
    return !error || (error == -ENOENT && !*path)
               ? 0
               : iso_fault_set_code(fault, reason.code, error, "%s", reason.text);
}

int iso_pipeline_open(const struct iso_pipeline_options *options, struct iso_pipeline *out,
                      struct iso_fault *fault)
{
    struct pipeline *pipeline = calloc(1, sizeof *pipeline);
    if (!pipeline) {
        return iso_fault_set(fault, -ENOMEM, "pipeline: out of memory");
    }
    pipeline->image = options->image;
    int error = iso_head_model_load(options->head_path, &pipeline->head, fault);
    if (!error) {
        error = make_extractor(pipeline, options, fault);
    }
    if (!error) {
        error = open_method(pipeline, options, fault);
    }
    if (!error) {
        error = make_face_check(pipeline, options, fault);
    }
    if (error) {
        pipeline_close(pipeline);
        return error;
    }
    *out = (struct iso_pipeline){.ops = &ops, .self = pipeline};
    return 0;
}

void iso_pipeline_close(struct iso_pipeline *pipeline)
{
    if (pipeline->ops) {
        pipeline->ops->close(pipeline->self);
        *pipeline = (struct iso_pipeline){0};
    }
}
