#include "sim/lab/eval/curve.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const struct {
    const char *name, *label;
} factors[SIM_FACTORS] = {
    [SIM_FACTOR_LANDMARK_ERROR] = {"landmark-error", "landmark error, mm"},
    [SIM_FACTOR_NOISE] = {"noise", "residual of the fitted head, mm"},
    [SIM_FACTOR_DISTANCE] = {"distance", "distance, mm"},
    [SIM_FACTOR_POSE] = {"pose", "angle between face and camera, degrees"},
    [SIM_FACTOR_EXPRESSION] = {"expression", "strength of expression, standard deviations"},
    [SIM_FACTOR_FUSED] = {"fused", "frames fused"},
    [SIM_FACTOR_AGE] = {"age", "sessions since enrolment"},
};

const char *sim_factor_name(enum sim_factor factor)
{
    return factors[factor].name;
}

const char *sim_factor_label(enum sim_factor factor)
{
    return factors[factor].label;
}

/* The number at the end of a session's name; NaN if there is none. */
static double session_number(const char *session)
{
    size_t end = strlen(session), begin = end;
    while (begin > 0 && isdigit((unsigned char)session[begin - 1])) {
        begin--;
    }
    return begin < end ? strtod(session + begin, NULL) : NAN;
}

static double age_of(const struct sim_corpus *corpus, const struct sim_corpus_row *probe)
{
    for (size_t i = 0; i < corpus->n_rows; i++) {
        const struct sim_corpus_row *row = &corpus->rows[i];
        if (row->role == SIM_ROLE_GALLERY && strcmp(row->subject, probe->subject) == 0) {
            return session_number(probe->session) - session_number(row->session);
        }
    }
    return NAN;
}

void sim_factors_measure(const struct sim_corpus *corpus, const struct sim_acquisition *acquisition,
                         const struct sim_matches *matches, const double *landmark_error_mm,
                         double (*factor)[SIM_FACTORS])
{
    const double degrees = 57.29577951308232;
    for (size_t i = 0; i < matches->n_probes; i++) {
        const struct sim_sample *sample = &acquisition->samples[matches->sample[i]];
        const struct iso_extraction *e = &acquisition->captures[sample->first_capture].extraction;
        for (int f = 0; f < SIM_FACTORS; f++) {
            factor[i][f] = NAN;
        }
        if (!sample->acquired || e->outcome != ISO_CAPTURE_OK) {
            continue;
        }
        factor[i][SIM_FACTOR_LANDMARK_ERROR] = landmark_error_mm[sample->first_capture];
        factor[i][SIM_FACTOR_NOISE] = e->residual_mm;
        factor[i][SIM_FACTOR_DISTANCE] = e->distance_mm;
        factor[i][SIM_FACTOR_POSE] = degrees * acos(cos(e->yaw_rad) * cos(e->pitch_rad));
        factor[i][SIM_FACTOR_EXPRESSION] = e->expression_norm;
        factor[i][SIM_FACTOR_FUSED] = sample->tmpl.n_frames;
        factor[i][SIM_FACTOR_AGE] = age_of(corpus, &corpus->rows[sample->row]);
    }
}

struct search {
    double value;
    bool not_rank_1, non_match;
};

static int by_value(const void *a, const void *b)
{
    const double x = ((const struct search *)a)->value, y = ((const struct search *)b)->value;
    return (x > y) - (x < y);
}

static void add_to(struct sim_curve_bin *bin, const struct search *search)
{
    const size_t n = bin->non_match.trials;
    bin->low = n == 0 ? search->value : bin->low;
    bin->high = search->value;
    bin->mean += (search->value - bin->mean) / (double)(n + 1);
    bin->not_rank_1.events += search->not_rank_1;
    bin->non_match.events += search->non_match;
    bin->not_rank_1.trials = bin->non_match.trials = n + 1;
}

/* Cuts searches, which are sorted by value, into bins at changes of the value. */
static struct sim_curve cut(const struct search *searches, size_t n)
{
    struct sim_curve curve = {0};
    for (size_t i = 0; i < n; i++) {
        const size_t due = i * SIM_CURVE_BINS /
                           n; /* the bin by index alone, without regard to equal values */
        const bool fresh = i == 0 || searches[i].value > searches[i - 1].value;
        if (i == 0 || (fresh && due >= curve.n_bins)) {
            curve.n_bins++;
        }
        add_to(&curve.bins[curve.n_bins - 1], &searches[i]);
    }
    return curve;
}

int sim_curves_of(const struct sim_analysis *analysis, const struct sim_matches *matches,
                  const double (*factor)[SIM_FACTORS], double threshold,
                  struct sim_curve out[SIM_FACTORS])
{
    const struct sim_identification *id = &analysis->identification;
    struct search *searches = calloc(id->n_searches + 1, sizeof *searches);
    if (!searches) {
        return -ENOMEM;
    }
    for (int f = 0; f < SIM_FACTORS; f++) {
        size_t n = 0, mated = 0;
        for (size_t i = 0; i < matches->n_probes; i++) {
            if (analysis->kind[i] != SIM_PROBE_MATED) {
                continue;
            }
            const struct sim_mated_search *s = &id->searches[mated++];
            if (s->rank > 0 && !isnan(factor[i][f])) {
                searches[n++] = (struct search){factor[i][f], s->rank != 1,
                                                s->mate_score < threshold};
            }
        }
        qsort(searches, n, sizeof *searches, by_value);
        out[f] = cut(searches, n);
    }
    free(searches);
    return 0;
}
