#include "firmware/recognise/pipeline.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/file/data_file.h"
#include "firmware/recognise/method/reranker.h"

enum { COHORT_BYTES_MAX = 64 + ISO_COHORT_MAX * (4 + ISO_TEMPLATE_BYTES_MAX) };

struct pipeline {
    struct iso_head_model *head;
    struct iso_metric *metric;     /* NULL: by cohort */
    struct iso_reranker *reranker; /* NULL: by cohort */
    struct iso_cohort *cohort;
    struct iso_icp_workspace *registration; /* NULL: by metric */
    struct iso_extractor *extractor;
    struct iso_match_options match;
    enum iso_image_check image;
    struct iso_fault image_lacks; /* why there is no face_check; "" if there is, or need not be */
    struct iso_face_check *face_check; /* NULL: images are not checked */
    enum iso_face_seen seen;           /* of the last frame */
};

/* Asks the image about a usable face. One that contradicts costs the frame its template; so does
 * one that cannot be asked, if it has a veto. */
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

/* One person of an index: verification. */
static int score_one(const struct pipeline *pipeline, const struct iso_candidate_list *among,
                     const struct iso_metric_vector *probe, struct iso_search_hit *hits,
                     int capacity, int *n_hits)
{
    struct iso_metric_vector person;
    const bool known = capacity > 0 && iso_index_find(among->index, among->person, &person) == 0;
    if (known) {
        hits[0] = (struct iso_search_hit){
            .person = among->person,
            .distance_mm = NAN,
            .score = iso_metric_score(pipeline->metric, &person, probe),
        };
        explicit_bzero(&person, sizeof person);
    }
    *n_hits = known;
    return 0;
}

/* The best by the metric, then the best of those after reranking. */
static int search_index(const struct pipeline *pipeline, const struct iso_candidate_list *among,
                        const struct iso_template *tmpl, struct iso_search_hit *hits, int capacity,
                        int *n_hits)
{
    enum { SHORTLIST = ISO_RERANK_CANDIDATES };
    struct iso_search_hit best[SHORTLIST];
    struct iso_metric_vector probe;
    int n = 0;
    int error = iso_metric_project(pipeline->metric, tmpl, &probe);
    if (error) {
        return error;
    }
    error = among->person ? score_one(pipeline, among, &probe, best, SHORTLIST, &n)
                          : iso_index_search(among->index, &probe, best, SHORTLIST, &n);
    explicit_bzero(&probe, sizeof probe);
    if (!error && among->templates) {
        error = iso_reranker_take(pipeline->reranker, pipeline->metric, among, tmpl, best, n);
    }
    if (error) {
        return error;
    }
    *n_hits = n < capacity ? n : capacity;
    for (int i = 0; i < *n_hits; i++) {
        hits[i] = best[i];
    }
    return 0;
}

static int pipeline_search(void *self, const struct iso_candidate_list *among,
                           const struct iso_template *probe, struct iso_search_hit *hits,
                           int capacity, int *n_hits)
{
    const struct pipeline *pipeline = self;
    if (among->index) {
        return search_index(pipeline, among, probe, hits, capacity, n_hits);
    }
    if (pipeline->metric) {
        return iso_search_by_metric(iso_reranker_workspace(pipeline->reranker), among->entries,
                                    among->n_entries, probe, pipeline->metric, hits, capacity,
                                    n_hits);
    }
    const int error = iso_search(pipeline->registration, among->entries, among->n_entries, probe,
                                 pipeline->cohort, &pipeline->match, hits, capacity, n_hits);
    explicit_bzero(pipeline->registration, sizeof *pipeline->registration);
    return error;
}

static const struct iso_metric *pipeline_metric(const void *self)
{
    return ((const struct pipeline *)self)->metric;
}

static uint32_t pipeline_algorithm(const void *self)
{
    return iso_extractor_algorithm(((const struct pipeline *)self)->extractor);
}

static uint32_t pipeline_model(const void *self)
{
    return ((const struct pipeline *)self)->head->crc32;
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
    iso_reranker_free(pipeline->reranker);
    iso_metric_free(pipeline->metric);
    iso_cohort_free(pipeline->cohort);
    free(pipeline->registration);
    iso_head_model_free(pipeline->head);
    free(pipeline);
}

static void pipeline_forget(void *self)
{
    const struct pipeline *pipeline = self;
    iso_reranker_forget(pipeline->reranker);
}

static const struct iso_pipeline_ops ops = {
    .extract = pipeline_extract,
    .search = pipeline_search,
    .metric = pipeline_metric,
    .algorithm = pipeline_algorithm,
    .model = pipeline_model,
    .close = pipeline_close,
    .forget = pipeline_forget,
    .seen = pipeline_seen,
    .image_check = pipeline_image_check,
    .image_lacks = pipeline_image_lacks,
};

static int refuse(const char *path, int error, const char *what, struct iso_fault *fault)
{
    return iso_fault_set_code(fault,
                              error == -ENOMEM ? ISO_FAULT_OUT_OF_MEMORY : ISO_FAULT_MODEL_DAMAGED,
                              error, "%s: %s", path,
                              error == -ENOMEM ? "out of memory"
                              : what           ? what
                                               : "damaged");
}

static int load_head(struct pipeline *pipeline, const char *path, struct iso_fault *fault)
{
    void *bytes = NULL;
    size_t size = 0;
    const char *what = NULL;
    int error = iso_data_file_read(path, ISO_HEAD_BYTES_MAX, &bytes, &size, fault);
    if (error) {
        return error;
    }
    error = iso_head_model_parse(bytes, size, &pipeline->head, &what);
    free(bytes);
    return error ? refuse(path, error, what, fault) : 0;
}

/* What templates are compared with has to be of their algorithm. */
static int check_algorithm(const struct pipeline *pipeline, const char *path, uint32_t algorithm,
                           struct iso_fault *fault)
{
    const uint32_t own = iso_extractor_algorithm(pipeline->extractor);
    return algorithm == own
               ? 0
               : iso_fault_set_code(
                     fault, ISO_FAULT_MODEL_MISFIT, -EINVAL,
                     "%s: made with another head model or other options (%08x, not %08x)", path,
                     algorithm, own);
}

static int load_metric(struct pipeline *pipeline, const char *path, struct iso_fault *fault)
{
    void *bytes = NULL;
    size_t size = 0;
    const char *what = NULL;
    int error = iso_data_file_read(path, ISO_METRIC_BYTES_MAX, &bytes, &size, fault);
    if (error) {
        return error;
    }
    error = iso_metric_parse(bytes, size, &pipeline->metric, &what);
    free(bytes);
    if (error) {
        return refuse(path, error, what, fault);
    }
    error = check_algorithm(pipeline, path, pipeline->metric->algorithm, fault);
    return error || iso_reranker_new(&pipeline->reranker) == 0
               ? error
               : iso_fault_set(fault, -ENOMEM, "pipeline: out of memory");
}

static int load_cohort(struct pipeline *pipeline, const char *path, struct iso_fault *fault)
{
    void *bytes = NULL;
    size_t size = 0;
    const char *what = NULL;
    int error = iso_data_file_read(path, COHORT_BYTES_MAX, &bytes, &size, fault);
    if (error) {
        return error;
    }
    error = iso_cohort_parse(bytes, size, &pipeline->cohort, &what);
    free(bytes);
    if (error) {
        return refuse(path, error, what, fault);
    }
    pipeline->registration = calloc(1, sizeof *pipeline->registration);
    return pipeline->registration
               ? check_algorithm(pipeline, path, iso_cohort_algorithm(pipeline->cohort), fault)
               : iso_fault_set(fault, -ENOMEM, "pipeline: out of memory");
}

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

/* A cascade that is named has to be there. Without one, a machine that lacks the module or its data
 * does without the check. A module that is there and cannot be used is a fault: the check was asked
 * for. */
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
    pipeline->match = options->match;
    pipeline->image = options->image;
    int error = load_head(pipeline, options->head_path, fault);
    if (!error) {
        error = make_extractor(pipeline, options, fault);
    }
    if (!error) {
        error = options->metric_path ? load_metric(pipeline, options->metric_path, fault)
                                     : load_cohort(pipeline, options->cohort_path, fault);
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
