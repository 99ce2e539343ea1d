#include "sim/eval/landmark_error.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/recording/recording.h"

/* The true landmarks of one recording; one is kept, since rows mostly follow each other. */
struct truth {
    const char *recording;
    struct iso_recording_landmark *rows;
    size_t n_rows;
};

/* Errors of one landmark over the captures. */
struct errors {
    size_t n;
    struct iso_vec3 *error_mm; /* [n], face frame */
    size_t *row;               /* [n], of the manifest */
};

static int load_truth(const char *directory, const char *recording, struct truth *truth,
                      struct iso_fault *fault)
{
    free(truth->rows);
    *truth = (struct truth){.recording = recording};
    char path[4096];
    int length = snprintf(path, sizeof path, "%s/%s", directory, recording);
    if (length < 0 || (size_t)length >= sizeof path) {
        return iso_fault_set(fault, -ENAMETOOLONG, "%s: path too long", recording);
    }
    struct iso_recording *opened = NULL;
    int error = iso_recording_open(path, &opened, fault);
    if (error) {
        return error;
    }
    error = iso_recording_landmarks(opened, &truth->rows, &truth->n_rows, fault);
    iso_recording_close(opened);
    return error == -ENOENT ? 0 : error;
}

static void add_errors(const struct sim_capture *capture, const struct truth *truth,
                       struct errors errors[ISO_LANDMARKS])
{
    const struct iso_extraction *x = &capture->extraction;
    struct iso_mat3 face_from_camera = iso_mat3_transpose(&x->camera_from_face.rotation);
    for (size_t i = 0; i < truth->n_rows; i++) {
        for (int l = 0; truth->rows[i].frame == capture->frame && l < ISO_LANDMARKS; l++) {
            if (strcmp(truth->rows[i].name, iso_landmark_name((enum iso_landmark)l)) == 0) {
                struct iso_vec3 e = iso_sub(x->landmark_mm[l], truth->rows[i].point_mm);
                errors[l].row[errors[l].n] = capture->row;
                errors[l].error_mm[errors[l].n++] = iso_mat3_apply(&face_from_camera, e);
            }
        }
    }
}

static int collect(const char *directory, const struct sim_corpus *corpus,
                   const struct sim_acquisition *acquisition, struct errors errors[ISO_LANDMARKS],
                   struct iso_fault *fault)
{
    struct truth truth = {.recording = NULL};
    int error = 0;
    for (size_t i = 0; !error && i < acquisition->n_captures; i++) {
        const struct sim_capture *capture = &acquisition->captures[i];
        const char *recording = corpus->rows[capture->row].recording;
        if (!truth.recording || strcmp(truth.recording, recording) != 0) {
            error = load_truth(directory, recording, &truth, fault);
        }
        if (!error && capture->extraction.outcome == ISO_CAPTURE_OK) {
            add_errors(capture, &truth, errors);
        }
    }
    free(truth.rows);
    return error;
}

static int by_value(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Mean, median and 95th percentile of n >= 1 lengths, which get sorted. */
static void summarise(double *lengths, size_t n, double *mean, double *median, double *p95)
{
    qsort(lengths, n, sizeof *lengths, by_value);
    double sum = 0.0;
    for (size_t i = 0; i < n; i++) {
        sum += lengths[i];
    }
    *mean = sum / (double)n;
    *median = lengths[n / 2];
    *p95 = lengths[(n * 95 + 99) / 100 - 1];
}

static void measure_error(const struct errors *e, double *lengths, struct sim_landmark_error *out)
{
    double unused;
    struct iso_vec3 sum = {0, 0, 0};
    for (size_t i = 0; i < e->n; i++) {
        lengths[i] = iso_norm(e->error_mm[i]);
        sum = iso_add(sum, e->error_mm[i]);
    }
    summarise(lengths, e->n, &out->mean_mm, &unused, &out->p95_mm);
    out->offset_mm = iso_scale(1.0 / (double)e->n, sum);
    for (size_t i = 0; i < e->n; i++) {
        lengths[i] = iso_norm(iso_sub(e->error_mm[i], out->offset_mm));
    }
    summarise(lengths, e->n, &out->centred_mean_mm, &unused, &out->centred_p95_mm);
}

/* `lengths` has room for `capacity` pairs; those beyond are left out. */
static void measure_slip(const struct sim_corpus *corpus, const struct errors *e, double *lengths,
                         size_t capacity, struct sim_landmark_error *out)
{
    size_t n = 0;
    for (size_t i = 0; i < e->n; i++) {
        for (size_t j = i + 1; j < e->n && n < capacity; j++) {
            if (e->row[i] != e->row[j] &&
                strcmp(corpus->rows[e->row[i]].subject, corpus->rows[e->row[j]].subject) == 0) {
                lengths[n++] = iso_norm(iso_sub(e->error_mm[i], e->error_mm[j]));
            }
        }
    }
    out->n_pairs = n;
    if (n > 0) {
        double unused;
        summarise(lengths, n, &unused, &out->slip_median_mm, &out->slip_p95_mm);
    }
}

int sim_landmark_errors(const char *directory, const struct sim_corpus *corpus,
                        const struct sim_acquisition *acquisition,
                        struct sim_landmark_error out[ISO_LANDMARKS], struct iso_fault *fault)
{
    enum { PAIRS_PER_FRAME = 64 };
    size_t capacity = acquisition->n_captures * PAIRS_PER_FRAME;
    struct errors errors[ISO_LANDMARKS] = {{0}};
    double *lengths = calloc(capacity, sizeof *lengths);
    int error = lengths ? 0 : -ENOMEM;
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        errors[l].error_mm = calloc(acquisition->n_captures, sizeof *errors[l].error_mm);
        errors[l].row = calloc(acquisition->n_captures, sizeof *errors[l].row);
        error = errors[l].error_mm && errors[l].row ? error : -ENOMEM;
    }
    if (error) {
        (void)iso_fault_set(fault, error, "%s: out of memory", directory);
    } else {
        error = collect(directory, corpus, acquisition, errors, fault);
    }
    for (int l = 0; !error && l < ISO_LANDMARKS; l++) {
        out[l] = (struct sim_landmark_error){.n = errors[l].n};
        if (errors[l].n > 0) {
            measure_error(&errors[l], lengths, &out[l]);
            measure_slip(corpus, &errors[l], lengths, capacity, &out[l]);
        }
    }
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        free(errors[l].error_mm);
        free(errors[l].row);
    }
    free(lengths);
    return error;
}
