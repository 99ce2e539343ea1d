#include "sim/eval/match.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sim/eval/latency.h"
#include "sim/eval/parallel.h"

struct matching {
    struct sim_acquisition *acquisition;
    const struct sim_gallery *gallery;
    const struct iso_cohort *cohort;
    const struct iso_match_options *options;
    struct sim_matches *matches;
};

/* Distance to the nearest template of every person. */
static int measure(const struct matching *work, const struct iso_template *probe,
                   double *distance_mm)
{
    const struct sim_gallery *gallery = work->gallery;
    for (size_t i = 0; i < gallery->n_templates; i++) {
        double d;
        int error = iso_match_distance(probe, gallery->templates[i], work->options, &d);
        if (error == -ENODATA) {
            continue; /* too few points in common: as far away as can be */
        }
        if (error) {
            return error;
        }
        double *nearest = &distance_mm[gallery->person[i]];
        *nearest = fmin(*nearest, d);
    }
    return 0;
}

static int search(const struct matching *work, struct sim_sample *sample, double *distance_mm,
                  double *score)
{
    struct iso_cohort_norm norm = {0};
    if (work->cohort) {
        int error = iso_cohort_normalise(work->cohort, &sample->tmpl, work->options, &norm);
        if (error == -ENODATA) {
            sample->acquired = false;
            sample->reason = ISO_CAPTURE_TOO_FEW_POINTS;
            return 0;
        }
        if (error) {
            return error;
        }
    }
    int error = measure(work, &sample->tmpl, distance_mm);
    for (size_t p = 0; !error && p < work->gallery->n_people; p++) {
        score[p] = work->cohort ? iso_cohort_score(norm, distance_mm[p]) : -distance_mm[p];
    }
    return error;
}

static int match_probe(void *context, int worker, size_t probe)
{
    (void)worker;
    const struct matching *work = context;
    struct sim_matches *m = work->matches;
    double *distance_mm = m->distance_mm + probe * m->n_people;
    double *score = m->score + probe * m->n_people;
    for (size_t p = 0; p < m->n_people; p++) {
        distance_mm[p] = INFINITY;
        score[p] = -INFINITY;
    }
    struct sim_sample *sample = &work->acquisition->samples[m->sample[probe]];
    if (!sample->acquired) {
        return 0;
    }
    int64_t wall_ns = sim_wall_ns(NULL), cpu_ns = sim_thread_cpu_ns(NULL);
    int error = search(work, sample, distance_mm, score);
    m->cpu_ns[probe] = sim_thread_cpu_ns(NULL) - cpu_ns;
    m->wall_ns[probe] = sim_wall_ns(NULL) - wall_ns;
    return error;
}

int sim_match(const struct sim_corpus *corpus, struct sim_acquisition *acquisition,
              const struct sim_gallery *gallery, const struct iso_cohort *cohort,
              const struct iso_match_options *options, int threads, struct sim_matches **out)
{
    size_t n_samples = acquisition->n_samples, n_people = gallery->n_people;
    struct sim_matches *m = calloc(1, sizeof *m);
    if (!m) {
        return -ENOMEM;
    }
    m->n_people = n_people;
    m->sample = calloc(n_samples, sizeof *m->sample);
    m->distance_mm = calloc(n_samples * n_people + 1, sizeof *m->distance_mm);
    m->score = calloc(n_samples * n_people + 1, sizeof *m->score);
    m->wall_ns = calloc(n_samples, sizeof *m->wall_ns);
    m->cpu_ns = calloc(n_samples, sizeof *m->cpu_ns);
    int error = m->sample && m->distance_mm && m->score && m->wall_ns && m->cpu_ns ? 0 : -ENOMEM;
    for (size_t i = 0; !error && i < n_samples; i++) {
        if (corpus->rows[acquisition->samples[i].row].role != SIM_ROLE_GALLERY) {
            m->sample[m->n_probes++] = i;
        }
    }
    if (!error) {
        struct matching work = {acquisition, gallery, cohort, options, m};
        error = sim_parallel(threads, m->n_probes, match_probe, &work);
    }
    if (error) {
        sim_matches_free(m);
        return error;
    }
    *out = m;
    return 0;
}

void sim_matches_free(struct sim_matches *m)
{
    if (m) {
        free(m->sample);
        free(m->distance_mm);
        free(m->score);
        free(m->wall_ns);
        free(m->cpu_ns);
        free(m);
    }
}
