/* What a user sees of the fit of the head model to a frame: its options, and which parts of the
 * face are covered. */
#ifndef ISOTHERM_HEAD_FIT_H
#define ISOTHERM_HEAD_FIT_H

enum { ISO_SHAPE_FIT_JAWS_MAX = 3 };

struct iso_shape_fit_options {
    int rigid_iterations, iterations; /* 1..64 each */
    int jaws;                         /* starts: 1 mouth shut, 2 also half, 3 also wide open */
    int vertices;                     /* compared at most; 0: all of the face */
    double cutoff_first_mm, cutoff_last_mm; /* Tukey's, over the iterations with modes */
    double soft_weight;                     /* of vertices that are not ISO_HEAD_RIGID, 0..1 */
    double identity_stiffness_mm2;          /* prior's weight beside a vertex's squared residual */
    double expression_stiffness_mm2;
};

enum iso_face_part {
    ISO_PART_BROW,
    ISO_PART_EYES,
    ISO_PART_NOSE,
    ISO_PART_MOUTH,
    ISO_PART_LEFT, /* the subject's left side, without nose and mouth */
    ISO_PART_RIGHT,
    ISO_FACE_PARTS
};

/* "brow", "eyes", ...; NULL outside the range. */
const char *iso_face_part_name(enum iso_face_part part);

struct iso_occlusion {
    /* Of the part's vertices that the camera should see, the share that it does not: something lies
     * more than 10 mm before them, or nothing was measured. 0 for a part that is turned away. */
    double covered[ISO_FACE_PARTS];
    double rest_mm2; /* how well the rest fits: mean of min(r^2, 36) of what is measured and bare */
};

#endif
