#include "sim/lab/match/truth.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "sim/lab/match/capture.h"

/* The frames of one recording. The last recording is kept, because its rows mostly follow each
 * other. */
struct known {
    const char *recording;
    struct sim_truth *frames;
};

static int landmark_of(const char *name)
{
    int l = 0;
    while (l < ISO_LANDMARKS && strcmp(name, iso_landmark_name((enum iso_landmark)l)) != 0) {
        l++;
    }
    return l;
}

int sim_truth_of_recording(const struct iso_recording *recording, struct sim_truth **out,
                           struct iso_fault *fault)
{
    struct iso_recording_landmark *rows = NULL;
    size_t n_rows = 0;
    struct sim_truth *frames = calloc(iso_recording_frames(recording), sizeof *frames);
    if (!frames) {
        return iso_fault_set(fault, -ENOMEM, "landmarks: out of memory");
    }
    const int error = iso_recording_landmarks(recording, &rows, &n_rows, fault);
    if (error && error != -ENOENT) {
        free(frames);
        return error;
    }
    for (size_t i = 0; i < n_rows; i++) {
        const int l = landmark_of(rows[i].name);
        if (l < ISO_LANDMARKS) {
            frames[rows[i].frame].known[l] = true;
            frames[rows[i].frame].point_mm[l] = rows[i].point_mm;
        }
    }
    free(rows);
    *out = frames;
    return 0;
}

static int read_recording(const char *directory, const char *name, struct known *known,
                          struct iso_fault *fault)
{
    struct iso_recording *recording = NULL;
    free(known->frames);
    *known = (struct known){.recording = name};
    int error = sim_recording_open(directory, name, &recording, fault);
    if (!error) {
        error = sim_truth_of_recording(recording, &known->frames, fault);
    }
    iso_recording_close(recording);
    return error;
}

int sim_truth_read(const char *directory, const struct sim_corpus *corpus, struct sim_truth **out,
                   struct iso_fault *fault)
{
    struct known known = {NULL, NULL};
    struct sim_truth *truth = calloc(sim_corpus_frames(corpus), sizeof *truth);
    int error = truth ? 0 : iso_fault_set(fault, -ENOMEM, "%s: out of memory", directory);
    size_t number = 0;
    for (size_t r = 0; !error && r < corpus->n_rows; r++) {
        const struct sim_corpus_row *row = &corpus->rows[r];
        if (!known.recording || strcmp(known.recording, row->recording) != 0) {
            error = read_recording(directory, row->recording, &known, fault);
        }
        if (!error) {
            memcpy(&truth[number], &known.frames[row->first], row->count * sizeof *truth);
            number += row->count;
        }
    }
    free(known.frames);
    if (error) {
        free(truth);
        return error;
    }
    *out = truth;
    return 0;
}
