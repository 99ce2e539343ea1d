#include "firmware/daemon/judge_stored.h"

#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/recording/recording.h"
#include "firmware/daemon/components.h"

enum { ENROLLED = 1, OTHER = 2, PEOPLE = 2 };

struct judgement {
    const struct iso_pipeline *pipeline;
    struct iso_extraction extraction; /* of the last frame */
    struct iso_template enrolled, other, visitor;
};

/* Reads frames until one is usable, and copies its template. */
static int find_template(struct judgement *judgement, struct iso_recording *recording,
                         struct iso_frame *frame, struct iso_template *out, struct iso_fault *fault)
{
    const struct iso_pipeline *pipeline = judgement->pipeline;
    struct iso_extraction *extraction = &judgement->extraction;
    for (size_t i = 0; i < iso_recording_frames(recording); i++) {
        int error = iso_recording_read(recording, i, frame, fault);
        if (error) {
            return error;
        }
        error = pipeline->ops->extract(pipeline->self, frame, iso_recording_meta(recording)->sensor,
                                       extraction);
        if (error) {
            return iso_fault_set(fault, error, "frame %zu: %s", i, strerror(-error));
        }
        if (extraction->outcome == ISO_CAPTURE_OK) {
            *out = extraction->tmpl;
            return 0;
        }
    }
    return iso_fault_set(fault, -EBADMSG, "no frame is usable; the last one is judged as '%s'",
                         iso_capture_name(extraction->outcome));
}

/* The template of a recording. A fault names the recording. */
static int take_template(struct judgement *judgement, const char *directory, const char *name,
                         struct iso_template *out, struct iso_fault *fault)
{
    struct iso_recording *recording = NULL;
    struct iso_frame *frame = NULL;
    struct iso_fault why = {.text = ""};
    char path[PATH_MAX];
    (void)snprintf(path, sizeof path, "%s/%s", directory, name);
    int error = iso_recording_open(path, &recording, &why);
    if (!error) {
        error = iso_recording_frame_new(recording, &frame);
    }
    if (!error) {
        error = find_template(judgement, recording, frame, out, &why);
    }
    iso_frame_free(frame);
    iso_recording_close(recording);
    return error ? iso_fault_set_code(fault, why.code, error, "%.80s: %.160s", name,
                                      why.text[0] ? why.text : strerror(-error))
                 : 0;
}

static int take_templates(struct judgement *judgement, const char *directory,
                          struct iso_fault *fault)
{
    int error = take_template(judgement, directory, "enrolled", &judgement->enrolled, fault);
    if (!error) {
        error = take_template(judgement, directory, "other", &judgement->other, fault);
    }
    return error ? error
                 : take_template(judgement, directory, "visitor", &judgement->visitor, fault);
}

/* Compares the visitor with both people. score[] gets their scores. */
static int compare(const struct judgement *judgement, double score[PEOPLE], struct iso_fault *fault)
{
    const struct iso_search_entry people[PEOPLE] = {{ENROLLED, &judgement->enrolled},
                                                    {OTHER, &judgement->other}};
    const struct iso_candidate_list among = {.entries = people, .n_entries = PEOPLE};
    const struct iso_pipeline *pipeline = judgement->pipeline;
    struct iso_search_hit hits[PEOPLE];
    int n = 0;
    const int error = pipeline->ops->search(pipeline->self, &among, &judgement->visitor, hits,
                                            PEOPLE, &n);
    if (error || n != PEOPLE) {
        return iso_fault_set(fault, error ? error : -EBADMSG, "the visitor cannot be compared: %s",
                             error ? strerror(-error) : "too few points in common");
    }
    for (int i = 0; i < n; i++) {
        score[hits[i].person - ENROLLED] = hits[i].score;
    }
    return 0;
}

static int judge(const struct judgement *judgement, const struct iso_config *config, FILE *out,
                 struct iso_fault *fault)
{
    const bool calibrated = iso_method_at(config->match.method)->calibrated;
    const double needed = iso_config_threshold(config);
    double score[PEOPLE];
    const int error = compare(judgement, score, fault);
    if (error) {
        return error;
    }
    if (!(score[0] > score[1])) {
        return iso_fault_set(fault, -EBADMSG,
                             "the visitor is taken for another person: score %.2f, and %.2f for "
                             "the enrolled person",
                             score[1], score[0]);
    }
    if (calibrated && !(score[0] >= needed && score[1] < needed)) {
        return iso_fault_set(fault, -EBADMSG,
                             "the scores are wrong: %.2f for the enrolled person and %.2f for "
                             "another one, with %.2f between them",
                             score[0], score[1], needed);
    }
    fprintf(out, "the visitor is recognised: score %.2f, and %.2f for another person\n", score[0],
            score[1]);
    return 0;
}

static void free_judgement(struct judgement *judgement)
{
    iso_template_wipe(&judgement->extraction.tmpl);
    iso_template_wipe(&judgement->enrolled);
    iso_template_wipe(&judgement->other);
    iso_template_wipe(&judgement->visitor);
    free(judgement);
}

int iso_judge_stored(const struct iso_config *config, const struct iso_times *times,
                     const char *directory, FILE *out, struct iso_fault *fault)
{
    struct iso_config own = iso_config_default();
    own.model = config->model;
    own.match = config->match;
    own.recognition.intensity = ISO_IMAGE_OFF;
    struct iso_components *components = iso_components_new(&own, times);
    struct judgement *judgement = calloc(1, sizeof *judgement);
    int error = components && judgement ? iso_components_open_pipeline(components, fault)
                                        : iso_fault_set(fault, -ENOMEM, "out of memory");
    if (!error) {
        judgement->pipeline = &components->pipeline;
        error = take_templates(judgement, directory, fault);
    }
    if (!error) {
        error = judge(judgement, &own, out, fault);
    }
    if (judgement) {
        free_judgement(judgement);
    }
    iso_components_close(components);
    return error;
}
