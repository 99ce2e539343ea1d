#include "sim/lab/match/scans.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "sim/lab/methods/anthroface.h"

int sim_scans_new(const struct sim_corpus *corpus, struct sim_scans **out)
{
    struct sim_scans *faces = calloc(1, sizeof *faces);
    if (!faces) {
        return -ENOMEM;
    }
    faces->n_captures = sim_corpus_frames(corpus);
    faces->of_capture = calloc(faces->n_captures, sizeof(struct sim_scan *));
    if (!faces->of_capture) {
        free(faces);
        return -ENOMEM;
    }
    *out = faces;
    return 0;
}

void sim_scans_free(struct sim_scans *faces)
{
    if (!faces) {
        return;
    }
    for (size_t i = 0; i < faces->n_captures; i++) {
        sim_scan_free(faces->of_capture[i]);
    }
    for (size_t i = 0; i < faces->n_samples; i++) {
        sim_scan_free(faces->of_sample[i]);
    }
    free(faces->of_capture);
    free(faces->of_sample);
    free(faces);
}

int sim_scans_inspect(void *context, size_t number, const struct iso_extractor *extractor,
                      const struct iso_frame *frame, const struct sim_capture *capture)
{
    struct sim_scans *faces = context;
    return sim_scan_of(extractor, frame, &capture->extraction, &faces->of_capture[number]);
}

/* Reads the marks of the frames [first, first + count) of a recording. Their captures begin at
 * `number`. */
static int mark_row(const char *directory, const struct sim_corpus_row *row, size_t number,
                    const struct sim_acquisition *acquisition, struct sim_scans *faces,
                    struct iso_fault *fault)
{
    struct iso_recording *recording = NULL;
    struct iso_recording_landmark *marks = NULL;
    size_t n_marks = 0;
    int error = sim_recording_open(directory, row->recording, &recording, fault);
    if (!error) {
        error = iso_recording_landmarks(recording, &marks, &n_marks, fault);
        error = error == -ENOENT ? 0 : error; /* the recording has no marks */
    }
    for (size_t i = 0; !error && i < n_marks; i++) {
        const int mark = sim_mark_find(marks[i].name);
        if (mark < 0 || marks[i].frame < row->first || marks[i].frame - row->first >= row->count) {
            continue;
        }
        const size_t capture = number + marks[i].frame - row->first;
        struct sim_scan *face = faces->of_capture[capture];
        if (face) {
            struct iso_rigid face_from_camera = iso_rigid_inverse(
                &acquisition->captures[capture].extraction.camera_from_face);
            face->mark_known[mark] = true;
            face->mark_mm[mark] = iso_rigid_apply(&face_from_camera, marks[i].point_mm);
        }
    }
    free(marks);
    iso_recording_close(recording);
    return error;
}

static int fuse_sample(const struct sim_sample *sample, struct sim_scans *faces,
                       struct sim_scan **out)
{
    const struct sim_scan *usable[SIM_SAMPLE_CAPTURES_MAX];
    size_t n = 0;
    for (size_t i = 0; i < sample->n_captures && n < SIM_SAMPLE_CAPTURES_MAX; i++) {
        if (faces->of_capture[sample->first_capture + i]) {
            usable[n++] = faces->of_capture[sample->first_capture + i];
        }
    }
    const int error = sample->acquired ? sim_scan_fuse(usable, n, out) : 0;
    for (size_t i = 0; !error && i < sample->n_captures; i++) {
        sim_scan_free(faces->of_capture[sample->first_capture + i]);
        faces->of_capture[sample->first_capture + i] = NULL;
    }
    return error;
}

int sim_scans_fuse(const char *directory, const struct sim_corpus *corpus,
                   const struct sim_acquisition *acquisition, struct sim_scans *faces,
                   struct iso_fault *fault)
{
    size_t number = 0;
    int error = 0;
    for (size_t r = 0; !error && r < corpus->n_rows; r++) {
        error = mark_row(directory, &corpus->rows[r], number, acquisition, faces, fault);
        number += corpus->rows[r].count;
    }
    if (error) {
        return error;
    }
    faces->of_sample = calloc(acquisition->n_samples, sizeof(struct sim_scan *));
    faces->n_samples = faces->of_sample ? acquisition->n_samples : 0;
    error = faces->of_sample ? 0 : -ENOMEM;
    for (size_t i = 0; !error && i < acquisition->n_samples; i++) {
        error = fuse_sample(&acquisition->samples[i], faces, &faces->of_sample[i]);
    }
    return error ? iso_fault_set(fault, error, "%s: faces cannot be joined: %s", directory,
                                 strerror(-error))
                 : 0;
}

void sim_scans_marks(const struct sim_scans *faces, bool marks[SIM_MARKS])
{
    size_t n = 0;
    for (size_t i = 0; i < faces->n_samples; i++) {
        const struct sim_scan *face = faces->of_sample[i];
        for (int m = 0; face && m < SIM_MARKS; m++) {
            marks[m] = (n == 0 || marks[m]) && face->mark_known[m];
        }
        n += face != NULL;
    }
    for (int m = 0; n == 0 && m < SIM_MARKS; m++) {
        marks[m] = false;
    }
}

bool sim_scans_infrared(const struct sim_scans *faces)
{
    size_t n = 0;
    for (size_t i = 0; i < faces->n_samples; i++) {
        if (faces->of_sample[i] && !faces->of_sample[i]->reflectance) {
            return false;
        }
        n += faces->of_sample[i] != NULL;
    }
    return n > 0;
}
