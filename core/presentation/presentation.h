/* Cues of a presentation attack (ISO/IEC 30107-1) in a single depth frame.
 *
 *   relief   a picture of a face has no nose             -> flat, bent
 *   size     a print that is too small or too large      -> wrong-size
 *   eyes     a print with its eyes cut out               -> eyes-cut
 *   sheet    without a face: a picture that is held up   -> flat, bent, screen
 *
 * liveness.h has the cues that need several frames. A print of true size that somebody wears, with
 * whole eyes, shows none of these cues.
 *
 * The bounds were chosen on rendered presentations (sim/world/generate, seeds 31 and 33: people of
 * the ICT space, sensors astra and kinect2) and checked on 374 real frames of Kinect v2. Seed 35 of
 * the preset `attacks`, astra, was used for nothing else. Of 150 presentations each of photo-flat
 * and photo-bent and 100 each of screen, mask-small and mask-large, none was taken for a usable
 * face (95 %: below 2.4 and 3.6 %). Of 1000 frames of living people none was refused (below 0.4 %),
 * nor of 600 with strong expressions (seed 4); none of 378 real frames is called an attack. Of 300
 * print-eyes-cut of seed 91, which was used for nothing else either, 25 were accepted (95 %: 5.5 to
 * 12.1 %). All of these had a wearer 9 to 19 mm behind the print, which the sensor's windows level
 * out. About 1 ms a face, 0.8 ms a scene without one, on one x86 core. */
#ifndef ISO_CORE_PRESENTATION_PRESENTATION_H
#define ISO_CORE_PRESENTATION_PRESENTATION_H

#include <stdbool.h>

#include "core/presentation/eyes.h"
#include "core/presentation/relief.h"
#include "core/presentation/sheet.h"
#include "core/presentation/size.h"
#include "isotherm/capture.h"

/* The measured values. A cue that could not be measured is absent and does not count. */
struct iso_presentation_cues {
    bool has_relief, has_size, has_eyes, has_sheet;
    struct iso_relief relief;
    struct iso_size size;
    double fitted_scale;  /* iso_size_of_fit */
    double identity_norm; /* of the fit: how unlike the mean the fitted head is */
    struct iso_eye eyes[ISO_EYES];
    struct iso_sheet sheet;
};

/* The bounds of the cues. Each comment begins with the default. */
struct iso_presentation_options {
    /* 0.83. If the relief has at least this share on one sheet, it is no face. Faces have at most
     * 0.76; pictures that were taken for a face have at least 0.89. For bent sheets the bound is
     * lower, the more unusual the head is that was fitted to them. */
    double sheet_share;
    /* 0.152 and 0.128: the limits of iso_presentation_oversize below and above 0. Of 1,678 genuine
     * frames (strong, astra and kinect2) 3 lie beyond them, of 376 real ones none. 2 of 800 masks
     * lie within them. */
    double too_small, too_large;
    /* 7. If the mean face fits worse than this at every size, the size is wrong. Hair in
     * front of the forehead does not count (size.h). Rendered people reach 5.5, real ones 4.1. */
    double no_size_cost_mm2;
    /* 3. Eyes are cut out if both lie at least this far behind their lids. Genuine frames
     * reach 1.4. */
    double eye_behind_mm;
    /* 0.9. An eye of which at least this share is not measured counts as cut out, too. With a value
     * above 1 holes do not count: for sensors that often do not measure eyes (active stereo). */
    double eye_hole_share;
    double held_flat_share; /* 0.55. An object with this share on one plane is a flat picture. */
    double held_bent_share; /* 0.8. An object with this share on one bent sheet: a bent picture. */
    double held_area_max_mm2; /* 130000. A larger object (A3) is a wall, a table or a chair. */
    double screen_hole_share; /* 0.08. A flat picture with this share of holes is a screen: its
                                 glass does not reflect light back to the sensor. */
};

/* The default bounds. */
struct iso_presentation_options iso_presentation_options_default(void);

/* How much too large a face is (> 0), or too small (< 0), roughly as the logarithm of its size. It
 * is the mean of both measures of scale; the one that the shapes of people do not explain (size.h)
 * counts twice as much as that of the fitted head. It depends on the head model and on the
 * stiffness of the fit: the bounds must be measured anew when either changes. The sizes of people
 * vary by 5 %. A person with an unusual head is therefore refused, and a print of a large head at
 * 0.8 of its size is the same as a small head. */
double iso_presentation_oversize(const struct iso_presentation_cues *cues);

/* ISO_CAPTURE_OK if no cue is above its bound, else the outcome of that cue: the first of relief,
 * size and eyes. The sheet is judged only if none of them is present. */
enum iso_capture iso_presentation_judge(const struct iso_presentation_cues *cues,
                                        const struct iso_presentation_options *options);

/* Workspace of the measures. Belongs to one thread. */
struct iso_presentation;

/* For scenes (coarse frames) of at most capacity_px pixels. The model must outlive it. -EINVAL,
 * -ENOMEM. */
int iso_presentation_new(const struct iso_head_model *model, size_t capacity_px,
                         struct iso_presentation **out) __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void iso_presentation_free(struct iso_presentation *presentation);

/* For a frame with a fitted head: relief, size and eyes. `frame` is the original frame, `cleaned`
 * its part about the face, to which `fit` and `head` were fitted. */
void iso_presentation_measure_face(const struct iso_presentation *presentation,
                                   const struct iso_frame *frame, const struct iso_frame *cleaned,
                                   const struct iso_shape_fit *fit,
                                   const struct iso_shape_residuals *head,
                                   struct iso_presentation_cues *out);

/* For a frame without a face: the nearest object between two depths. Of an object larger than
 * options->held_area_max_mm2, only what iso_presentation_judge() looks at is measured. */
void iso_presentation_measure_scene(struct iso_presentation *presentation,
                                    const struct iso_frame *coarse, double near_mm, double far_mm,
                                    const struct iso_presentation_options *options,
                                    struct iso_presentation_cues *out);

#endif
