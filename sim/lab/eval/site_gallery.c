#include "sim/lab/eval/site_gallery.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

int sim_option_site(const char *text, void *field)
{
    static const char *const names[] = {"none", "gallery", "sensor", "split"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        if (strcmp(text, names[i]) == 0) {
            *(enum sim_site *)field = (enum sim_site)i;
            return 0;
        }
    }
    return -EINVAL;
}

/* Collects the first captures of a person's enrolment; `captures` is room for them. */
static int collect_captures(const struct sim_gallery *gallery, size_t person,
                            const struct iso_metric *metric, struct iso_metric_vector *captures,
                            int *n)
{
    int error = 0;
    *n = 0;
    for (size_t i = 0; i < gallery->n_templates && *n < ISO_SITE_CAPTURES && !error; i++) {
        const struct iso_template *tmpl = gallery->templates[i];
        if (gallery->person[i] != person ||
            (gallery->teaching && strcmp(tmpl->sensor, gallery->teaching) != 0)) {
            continue;
        }
        error = iso_metric_project(metric, tmpl, &captures[*n]);
        *n += error == 0;
        error = error == -ENODATA ? 0 : error;
    }
    return error;
}

/* Shows all people to the statistics, in the first pass or in the second one. */
static int pass_people(const struct sim_gallery *gallery, const struct iso_metric *metric,
                       bool second, struct iso_metric_vector *captures, struct iso_site *site)
{
    int error = 0, n = 0;
    for (size_t p = 0; p < gallery->n_people && !error; p++) {
        error = collect_captures(gallery, p, metric, captures, &n);
        if (!error && n > 0) {
            error = second ? iso_site_review(site, captures, n)
                           : iso_site_add(site, (int64_t)p, captures, n);
        }
    }
    return error;
}

const char *sim_site_searching_sensor(const struct sim_corpus *corpus,
                                      const struct sim_acquisition *acquisition)
{
    for (size_t i = 0; i < acquisition->n_samples; i++) {
        const struct sim_sample *sample = &acquisition->samples[i];
        if (sample->acquired && corpus->rows[sample->row].role != SIM_ROLE_GALLERY) {
            return sample->tmpl.sensor;
        }
    }
    return NULL;
}

int sim_site_adapt(const struct sim_gallery *gallery, const struct iso_metric *metric,
                   struct iso_site_metric *out)
{
    struct iso_site *site = NULL;
    struct iso_metric_vector *captures = calloc(ISO_SITE_CAPTURES, sizeof *captures);
    int error = captures ? iso_site_new(metric, &site) : -ENOMEM;
    if (!error) {
        error = pass_people(gallery, metric, false, captures, site);
    }
    if (!error) {
        error = iso_site_find_directions(site);
    }
    if (!error) {
        error = pass_people(gallery, metric, true, captures, site);
    }
    if (!error) {
        error = iso_site_adapt(site, metric, out);
    }
    iso_site_free(site);
    free(captures);
    return error;
}

/* ---- enrolled visitors as strangers ---- */

struct judging {
    const struct sim_corpus *corpus;
    struct sim_acquisition *acquisition;
    const struct sim_gallery *gallery;
    const struct iso_metric *metric;
    const struct sim_scoring *scoring;
    int threads;
    struct sim_matches *matches;
    bool *wanted; /* [n_samples]: searches of the visitor */
    bool *keep;   /* [n_people]: everybody but the visitor */
};

/* Marks the searches of a visitor and the people of the site without this visitor. Returns whether
 * there is anything to compare. */
static bool mark_visitor(const struct judging *j, size_t visitor)
{
    bool any = false, others = false;
    for (size_t i = 0; i < j->acquisition->n_samples; i++) {
        const struct sim_corpus_row *row = &j->corpus->rows[j->acquisition->samples[i].row];
        j->wanted[i] = row->role != SIM_ROLE_GALLERY &&
                       strcmp(row->subject, j->gallery->names[visitor]) == 0;
        any = any || j->wanted[i];
    }
    for (size_t p = 0; p < j->gallery->n_people; p++) {
        j->keep[p] = p != visitor;
        others = others || (p != visitor && j->gallery->n_templates_of[p] > 0);
    }
    return any && others;
}

/* Copies the scores of the visitor's searches, whose columns lack the visitor. */
static void take_scores(const struct judging *j, size_t visitor, const struct sim_matches *alone)
{
    const size_t n = j->gallery->n_people;
    for (size_t i = 0; i < alone->n_probes; i++) {
        const double *from = &alone->score[i * alone->n_people];
        double *to = &j->matches->stranger_score[i * n];
        for (size_t p = 0; p < n && j->wanted[alone->sample[i]]; p++) {
            to[p] = p == visitor ? -INFINITY : from[p - (p > visitor)];
        }
    }
}

static int judge_visitor(const struct judging *j, size_t visitor)
{
    struct iso_site_metric adapted = {.n = 0};
    struct sim_gallery *others = NULL;
    struct sim_matches *alone = NULL;
    struct sim_scoring scoring = *j->scoring;
    int error = sim_gallery_part(j->gallery, j->keep, &others);
    if (!error) {
        error = sim_site_adapt(others, j->metric, &adapted);
    }
    if (!error) {
        scoring.metric = adapted.metric;
        scoring.site = &adapted;
        scoring.wanted = j->wanted;
        error = sim_match(j->corpus, j->acquisition, others, &scoring, j->threads, &alone);
    }
    if (!error) {
        take_scores(j, visitor, alone);
    }
    sim_matches_free(alone);
    sim_gallery_free(others);
    iso_site_metric_free(&adapted);
    return error;
}

int sim_site_judge_strangers(const struct sim_corpus *corpus, struct sim_acquisition *acquisition,
                             const struct sim_gallery *gallery, const struct iso_metric *metric,
                             const struct sim_scoring *scoring, int threads,
                             struct sim_matches *matches)
{
    struct judging j = {.corpus = corpus,
                        .acquisition = acquisition,
                        .gallery = gallery,
                        .metric = metric,
                        .scoring = scoring,
                        .threads = threads,
                        .matches = matches};
    const size_t n_scores = matches->n_probes * matches->n_people;
    matches->stranger_score = calloc(n_scores + 1, sizeof *matches->stranger_score);
    j.wanted = calloc(acquisition->n_samples + 1, sizeof *j.wanted);
    j.keep = calloc(gallery->n_people + 1, sizeof *j.keep);
    int error = matches->stranger_score && j.wanted && j.keep ? 0 : -ENOMEM;
    for (size_t i = 0; i < n_scores && !error; i++) {
        matches->stranger_score[i] = -INFINITY;
    }
    for (size_t p = 0; p < gallery->n_people && !error; p++) {
        error = mark_visitor(&j, p) ? judge_visitor(&j, p) : 0;
    }
    free(j.wanted);
    free(j.keep);
    return error;
}
