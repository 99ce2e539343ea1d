#include "sim/lab/match/method_match.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "sim/lab/match/latency.h"
#include "sim/lab/match/parallel.h"

struct matching {
    const struct sim_method *method;
    const void *knowledge;
    const struct sim_gallery *gallery;
    const struct sim_scans *faces;
    void **descriptions; /* [n_samples]; NULL: none */
    struct sim_matches *matches;
};

static int describe(void *context, int worker, size_t sample)
{
    (void)worker;
    const struct matching *work = context;
    const struct sim_scan *face = work->faces->of_sample[sample];
    if (!face) {
        return 0;
    }
    const int error = work->method->describe(work->knowledge, face, &work->descriptions[sample]);
    return error == -ENODATA ? 0 : error;
}

static int search(void *context, int worker, size_t probe)
{
    (void)worker;
    const struct matching *work = context;
    const struct sim_gallery *gallery = work->gallery;
    struct sim_matches *m = work->matches;
    const void *description = work->descriptions[m->sample[probe]];
    double *nearest = m->distance_mm + probe * m->n_people;
    const int64_t wall_ns = sim_wall_ns(NULL), cpu_ns = sim_thread_cpu_ns(NULL);
    for (size_t i = 0; description && i < gallery->n_templates; i++) {
        const void *enrolled = work->descriptions[gallery->sample[i]];
        double d;
        const int error = enrolled
                              ? work->method->distance(work->knowledge, description, enrolled, &d)
                              : -ENODATA;
        if (error && error != -ENODATA) {
            return error;
        }
        const size_t person = gallery->person[i];
        nearest[person] = error ? nearest[person] : fmin(nearest[person], d);
    }
    for (size_t p = 0; p < m->n_people; p++) {
        m->score[probe * m->n_people + p] = -nearest[p];
    }
    m->cpu_ns[probe] = sim_thread_cpu_ns(NULL) - cpu_ns;
    m->wall_ns[probe] = sim_wall_ns(NULL) - wall_ns;
    return 0;
}

int sim_method_match(const struct sim_method *method, const void *knowledge,
                     const struct sim_corpus *corpus, const struct sim_acquisition *acquisition,
                     const struct sim_gallery *gallery, const struct sim_scans *faces, int threads,
                     struct sim_matches **out)
{
    struct matching work = {method, knowledge, gallery, faces, NULL, NULL};
    work.descriptions = calloc(acquisition->n_samples, sizeof *work.descriptions);
    int error = work.descriptions ? 0 : -ENOMEM;
    if (!error) {
        error = sim_matches_new(corpus, acquisition, gallery->n_people, &work.matches);
    }
    if (!error) {
        error = sim_parallel(threads, "describing faces", acquisition->n_samples, describe, &work);
    }
    if (!error) {
        error = sim_parallel(threads, "searching", work.matches->n_probes, search, &work);
    }
    for (size_t i = 0; work.descriptions && i < acquisition->n_samples; i++) {
        method->discard(work.descriptions[i]);
    }
    free(work.descriptions);
    if (error) {
        sim_matches_free(work.matches);
        return error;
    }
    *out = work.matches;
    return 0;
}
