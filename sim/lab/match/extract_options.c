#include "sim/lab/match/extract_options.h"

#include <errno.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "drivers/file/text.h"
#include "sim/lab/match/landmark_choice.h"

/* The field is the whole options struct. */
static int parse_radii(const char *text, void *field)
{
    struct iso_extract_options *options = field;
    char copy[64];
    char *words[ISO_TEMPLATE_RADII_MAX];
    double radius_mm[ISO_TEMPLATE_RADII_MAX];
    if ((size_t)snprintf(copy, sizeof copy, "%s", text) >= sizeof copy) {
        return -EINVAL;
    }
    const size_t n = iso_text_split(copy, ',', words, ISO_TEMPLATE_RADII_MAX);
    if (n > ISO_TEMPLATE_RADII_MAX) {
        return -EINVAL;
    }
    for (size_t i = 0; i < n; i++) {
        if (iso_text_number(words[i], &radius_mm[i])) {
            return -EINVAL;
        }
    }
    options->n_radii = (int)n;
    memcpy(options->radius_mm, radius_mm, n * sizeof *radius_mm);
    return 0;
}

static int parse_heat(const char *text, void *field)
{
    for (int m = 0; iso_heat_method_name((enum iso_heat_method)m); m++) {
        if (strcmp(text, iso_heat_method_name((enum iso_heat_method)m)) == 0) {
            *(enum iso_heat_method *)field = (enum iso_heat_method)m;
            return 0;
        }
    }
    return -EINVAL;
}

static int parse_transform(const char *text, void *field)
{
    enum iso_icp_transform *transform = field;
    if (strcmp(text, "rigid") == 0) {
        *transform = ISO_ICP_RIGID;
    } else if (strcmp(text, "affine") == 0) {
        *transform = ISO_ICP_AFFINE;
    } else {
        return -EINVAL;
    }
    return 0;
}

#define FIELD(name) offsetof(struct iso_extract_options, name)

static const struct sim_option extract_options[] = {
    {"radii", "MM,MM,...", "radii of the isotherms", parse_radii, 0},
    {"heat", "grid|direct|spectral", "how heat columns are computed", parse_heat, FIELD(heat)},
    {"t", "MM2", "time of the heat", sim_option_number, FIELD(t_mm2)},
    {"points", "N", "points of an isotherm", sim_option_int, FIELD(n_points)},
    {"crop-radius", "MM", "radius of the face patch", sim_option_number, FIELD(crop_radius_mm)},
    {"spacing", "MM", "spacing of the face patch's grid", sim_option_number, FIELD(spacing_mm)},
    {"smoothing", "MM", "sigma of the residual's filter", sim_option_number, FIELD(smoothing_mm)},
    {"outlier", "MM", "larger residuals are filled in", sim_option_number, FIELD(outlier_mm)},
    {"fit-iterations", "N", "iterations of the head model's fit", sim_option_int,
     FIELD(fit.iterations)},
    {"fit-cutoff-first", "MM", "Tukey's cut-off in the first iteration", sim_option_number,
     FIELD(fit.cutoff_first_mm)},
    {"fit-cutoff-last", "MM", "Tukey's cut-off in the last iteration", sim_option_number,
     FIELD(fit.cutoff_last_mm)},
    {"fit-soft-weight", "W", "weight of places that move with expression", sim_option_number,
     FIELD(fit.soft_weight)},
    {"fit-identity-stiffness", "MM2", "prior of the identity modes", sim_option_number,
     FIELD(fit.identity_stiffness_mm2)},
    {"fit-expression-stiffness", "MM2", "prior of the expression modes", sim_option_number,
     FIELD(fit.expression_stiffness_mm2)},
    {"distance-min", "MM", "nearest nose tip accepted", sim_option_number, FIELD(distance_min_mm)},
    {"distance-max", "MM", "farthest nose tip accepted", sim_option_number, FIELD(distance_max_mm)},
    {"yaw-max", "DEGREES", "greatest yaw of a usable face", sim_option_degrees, FIELD(yaw_max_rad)},
    {"pitch-max", "DEGREES", "greatest pitch of a usable face", sim_option_degrees,
     FIELD(pitch_max_rad)},
};

static const struct sim_option match_options[] = {
    {"trim", "SHARE", "share of the points that a distance uses", sim_option_number,
     offsetof(struct iso_match_options, trim)},
    {"icp-iterations", "N", "most iterations of a comparison", sim_option_int,
     offsetof(struct iso_match_options, icp_iterations)},
    {"transform", "rigid|affine", "kind of transform that registers two templates", parse_transform,
     offsetof(struct iso_match_options, transform)},
    {"landmarks", "NAME,...|all|upper", "landmarks that a distance uses", sim_option_landmarks,
     offsetof(struct iso_match_options, left_out)},
};

struct sim_option_set sim_extract_option_set(struct iso_extract_options *options)
{
    return (struct sim_option_set){extract_options,
                                   sizeof extract_options / sizeof *extract_options, options};
}

struct sim_option_set sim_match_option_set(struct iso_match_options *options)
{
    return (struct sim_option_set){match_options, sizeof match_options / sizeof *match_options,
                                   options};
}

int sim_option_threads(const char *text, void *field)
{
    int threads;
    if (sim_option_int(text, &threads) || threads < 1 || threads > SIM_THREADS_MAX) {
        return -EINVAL;
    }
    *(int *)field = threads;
    return 0;
}

int sim_threads_default(enum iso_heat_method heat)
{
    const long processors = sysconf(_SC_NPROCESSORS_ONLN);
    if (heat == ISO_HEAT_SPECTRAL || processors < 1) {
        return 1;
    }
    return processors < SIM_THREADS_MAX ? (int)processors : SIM_THREADS_MAX;
}

int sim_threads_check(int threads, enum iso_heat_method heat, struct iso_fault *fault)
{
    if (threads < 1 || threads > SIM_THREADS_MAX) {
        return iso_fault_set(fault, -EINVAL, "%d threads: must be 1..%d", threads, SIM_THREADS_MAX);
    }
    return heat == ISO_HEAT_SPECTRAL && threads > 1
               ? iso_fault_set(fault, -EINVAL, "%d threads: must be 1 with spectral heat", threads)
               : 0;
}
