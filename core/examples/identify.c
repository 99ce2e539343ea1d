/* Enrols people from recordings, then says who is in other recordings.
 *
 *     identify DATA ENROL_RECORDING... -- VISIT_RECORDING...
 *
 * DATA is the directory of the trained files, /usr/share/isotherm. The name of an enrolled person
 * is the path of the recording. The steps are those of the appliance:
 *
 *     frame -> template    iso_extractor_run: find the face, fit the head model, trace isotherms
 *     template -> vector   iso_metric_project: what the learned metric sees of a template
 *     vector -> people     iso_index_search: the people with the best scores
 */
#include <isotherm/isotherm.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "recording.h"

/* Among strangers who look alike, one in 10^s has a score of s or more. Choose the threshold by the
 * number of enrolled people: each of them is one more chance for a stranger to be accepted. */
static const double threshold = 4.0;

/* The objects that the steps need. They are made once and used for all frames. */
struct recogniser {
    struct iso_head_model *model;
    struct iso_metric *metric;
    struct iso_extractor *extractor;
    struct iso_index *index;
};

/* Called for each usable frame of a recording with the vector of its template. */
typedef int use_vector(struct recogniser *recogniser, const struct iso_metric_vector *vector,
                       int person, char **names);

static int load(const char *data, struct recogniser *out)
{
    char path[1024];
    void *bytes = NULL;
    size_t size = 0;
    struct iso_fault fault = {.text = ""};

    snprintf(path, sizeof path, "%s/head.model", data);
    if (file_read(path, &bytes, &size)) {
        return -1;
    }
    int error = iso_head_model_parse(bytes, size, &out->model, &fault);
    free(bytes);
    if (error) {
        fprintf(stderr, "%s: %s\n", path, fault.text);
        return -1;
    }
    snprintf(path, sizeof path, "%s/face.metric", data);
    if (file_read(path, &bytes, &size)) {
        return -1;
    }
    error = iso_metric_parse(bytes, size, &out->metric, &fault);
    free(bytes);
    if (error) {
        fprintf(stderr, "%s: %s\n", path, fault.text);
        return -1;
    }
    return 0;
}

static int prepare(const char *data, size_t n_people, struct recogniser *out)
{
    const struct iso_extract_options options = iso_extract_options_default();
    if (load(data, out) || iso_extractor_new(out->model, &options, &out->extractor) ||
        iso_index_new(out->metric, &out->index) || iso_index_reserve(out->index, n_people)) {
        fprintf(stderr, "the recogniser cannot be made\n");
        return -1;
    }
    return 0;
}

static void release(struct recogniser *recogniser)
{
    iso_index_free(recogniser->index);
    iso_extractor_free(recogniser->extractor);
    iso_metric_free(recogniser->metric);
    iso_head_model_free(recogniser->model);
}

/* Makes a template of each frame of a recording and hands on its vector. */
static int each_frame(struct recogniser *recogniser, const char *directory, use_vector *use,
                      int person, char **names)
{
    static struct iso_extraction extraction; /* 36 kB: better not on the stack */
    struct recording recording;
    struct iso_frame *frame = NULL;
    int more = recording_open(directory, &recording);

    for (int i = 0; more >= 0 && (more = recording_read(&recording, i, &frame)) > 0; i++) {
        struct iso_metric_vector vector;
        int error = iso_extractor_run(recogniser->extractor, frame, &extraction);
        iso_frame_free(frame);
        if (!error && extraction.outcome != ISO_CAPTURE_OK) {
            printf("%s, frame %d: %s\n", directory, i, iso_capture_name(extraction.outcome));
            continue; /* no usable face: the word says why, such as "too-far" */
        }
        if (!error) {
            error = iso_metric_project(recogniser->metric, &extraction.tmpl, &vector);
        }
        if (error) {
            fprintf(stderr, "%s, frame %d: %s\n", directory, i, strerror(-error));
            return -1;
        }
        printf("%s, frame %d: ", directory, i);
        if (use(recogniser, &vector, person, names)) {
            return -1;
        }
    }
    return more;
}

static int enrol(struct recogniser *recogniser, const struct iso_metric_vector *vector, int person,
                 char **names)
{
    printf("enrolled as %s\n", names[person]);
    return iso_index_add(recogniser->index, person, vector);
}

static int identify(struct recogniser *recogniser, const struct iso_metric_vector *vector,
                    int person, char **names)
{
    (void)person;
    struct iso_search_hit best;
    int n = 0;
    const int error = iso_index_search(recogniser->index, vector, &best, 1, &n);
    if (!error && n > 0) {
        printf("%s (%s has the best score, %.1f)\n",
               best.score >= threshold ? names[best.person] : "nobody", names[best.person],
               best.score);
    }
    return error;
}

int main(int argc, char **argv)
{
    int dashes = 2;
    while (dashes < argc && strcmp(argv[dashes], "--") != 0) {
        dashes++;
    }
    if (dashes == 2 || dashes + 1 >= argc) {
        fprintf(stderr, "usage: %s DATA ENROL_RECORDING... -- VISIT_RECORDING...\n", argv[0]);
        return 2;
    }

    struct recogniser recogniser = {0};
    int error = prepare(argv[1], (size_t)(dashes - 2), &recogniser);
    for (int i = 2; !error && i < dashes; i++) {
        error = each_frame(&recogniser, argv[i], enrol, i, argv);
    }
    for (int i = dashes + 1; !error && i < argc; i++) {
        error = each_frame(&recogniser, argv[i], identify, 0, argv);
    }
    release(&recogniser);
    return error ? 1 : 0;
}
