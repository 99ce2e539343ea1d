#include "sim/lab/match/acquire.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "core/match/template_fuse.h"
#include "core/registration/icp.h"

static void keep(void *context, size_t number, const struct sim_capture *capture)
{
    struct sim_acquisition *a = context;
    a->captures[number] = *capture;
}

/* Fuses the usable frames of a sample. */
static int make_sample(const struct sim_capture *captures, struct sim_sample *sample)
{
    const struct iso_template *usable[SIM_SAMPLE_CAPTURES_MAX];
    int n = 0;
    for (size_t i = 0; i < sample->n_captures && n < SIM_SAMPLE_CAPTURES_MAX; i++) {
        const struct iso_extraction *e = &captures[sample->first_capture + i].extraction;
        if (e->outcome == ISO_CAPTURE_OK) {
            usable[n++] = &e->tmpl;
        }
    }
    if (n == 0) {
        sample->reason = sim_capture_reason(&captures[sample->first_capture]);
        return 0;
    }
    sample->acquired = true;
    sample->reason = ISO_CAPTURE_OK;
    if (n == 1) {
        sample->tmpl = *usable[0];
        return 0;
    }
    struct iso_icp_workspace *work = malloc(sizeof *work);
    const int error = work ? iso_template_fuse(work, usable, n, &sample->tmpl) : -ENOMEM;
    free(work);
    return error;
}

static size_t group_size(const struct sim_corpus_row *row, size_t fuse)
{
    const size_t size = fuse > 0 && fuse < row->count ? fuse : row->count;
    return size < SIM_SAMPLE_CAPTURES_MAX ? size : SIM_SAMPLE_CAPTURES_MAX;
}

static int make_samples(const struct sim_corpus *corpus, size_t fuse, struct sim_acquisition *a,
                        struct iso_fault *fault)
{
    size_t first_of_row = 0;
    for (size_t row = 0; row < corpus->n_rows; row++) {
        const size_t count = corpus->rows[row].count;
        const size_t size = group_size(&corpus->rows[row], fuse);
        for (size_t first = 0; first < count; first += size) {
            struct sim_sample *sample = &a->samples[a->n_samples++];
            *sample = (struct sim_sample){
                .row = row,
                .first_capture = first_of_row + first,
                .n_captures = count - first < size ? count - first : size,
            };
            const int error = make_sample(a->captures, sample);
            if (error) {
                return iso_fault_set(fault, error, "%s: frames cannot be fused: %s",
                                     corpus->rows[row].recording, strerror(-error));
            }
        }
        first_of_row += count;
    }
    return 0;
}

static int new_acquisition(const struct sim_corpus *corpus, size_t fuse,
                           struct sim_acquisition **out)
{
    struct sim_acquisition *a = calloc(1, sizeof *a);
    *out = a;
    if (!a) {
        return -ENOMEM;
    }
    size_t n_samples = 0;
    for (size_t row = 0; row < corpus->n_rows; row++) {
        const size_t size = group_size(&corpus->rows[row], fuse);
        n_samples += (corpus->rows[row].count + size - 1) / size;
    }
    a->n_captures = sim_corpus_frames(corpus);
    a->captures = calloc(a->n_captures, sizeof *a->captures);
    a->samples = calloc(n_samples, sizeof *a->samples);
    return a->captures && a->samples ? 0 : -ENOMEM;
}

int sim_acquire(const char *directory, const struct sim_corpus *corpus,
                const struct sim_capture_options *options, size_t fuse,
                struct sim_acquisition **out, struct iso_fault *fault)
{
    struct sim_acquisition *a = NULL;
    int error = new_acquisition(corpus, fuse, &a);
    if (error) {
        (void)iso_fault_set(fault, error, "%s: out of memory", directory);
    } else {
        error = sim_capture_all(directory, corpus, options, keep, a, &a->origin, fault);
    }
    if (!error) {
        error = make_samples(corpus, fuse, a, fault);
    }
    if (error) {
        sim_acquisition_free(a);
        return error;
    }
    *out = a;
    return 0;
}

static void wipe_and_free(void *memory, size_t bytes)
{
    if (memory) {
        explicit_bzero(memory, bytes); /* templates */
        free(memory);
    }
}

void sim_acquisition_free(struct sim_acquisition *a)
{
    if (a) {
        wipe_and_free(a->captures, a->n_captures * sizeof *a->captures);
        wipe_and_free(a->samples, a->n_samples * sizeof *a->samples);
        free(a);
    }
}
