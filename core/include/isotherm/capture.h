/* What became of a frame: a usable face, or the reason why not, which is also the hint to the
 * person. A numerical outcome, never an error code and never a verdict. Zero is "no face":
 * something is there, and nothing about it is like a face.
 *
 * Directions are the SUBJECT's: "move-left" asks the person to step to his or her own left. */
#ifndef ISOTHERM_CAPTURE_H
#define ISOTHERM_CAPTURE_H

#include <stdbool.h>

enum iso_capture {
    ISO_CAPTURE_NO_FACE = 0,
    ISO_CAPTURE_OK,
    ISO_CAPTURE_TOO_FAR,
    ISO_CAPTURE_TOO_CLOSE,
    ISO_CAPTURE_MOVE_LEFT, /* off centre: the face is cut by the image border */
    ISO_CAPTURE_MOVE_RIGHT,
    ISO_CAPTURE_MOVE_UP,
    ISO_CAPTURE_MOVE_DOWN,
    ISO_CAPTURE_TURN_LEFT, /* not frontal */
    ISO_CAPTURE_TURN_RIGHT,
    ISO_CAPTURE_LOOK_UP,
    ISO_CAPTURE_LOOK_DOWN,
    ISO_CAPTURE_TOO_FEW_POINTS, /* holes all over: sunlight, dark hair, a smeared lens */
    ISO_CAPTURE_COVERED_BROW,   /* occluded: something is before that part, or it is a hole */
    ISO_CAPTURE_COVERED_EYES,
    ISO_CAPTURE_COVERED_NOSE,
    ISO_CAPTURE_COVERED_MOUTH,
    ISO_CAPTURE_COVERED_LEFT, /* the left half of the face */
    ISO_CAPTURE_COVERED_RIGHT,
    ISO_CAPTURE_SEVERAL_FACES, /* two about as near: whose door is it? */
    ISO_CAPTURE_NOT_A_FACE,    /* something is there, it does not fit a head */
    ISO_CAPTURE_MOVING,
    ISO_CAPTURE_EXPRESSION, /* too strong for the purpose: an enrolment wants a neutral face */
    ISO_CAPTURE_NOBODY,     /* the scene is empty, but for what lies behind: a hint to no one */
    /* Cues of a presentation attack (ISO/IEC 30107-1). */
    ISO_CAPTURE_FLAT,             /* a flat picture */
    ISO_CAPTURE_BENT,             /* a bent picture */
    ISO_CAPTURE_SCREEN,           /* a flat thing with holes where it shines */
    ISO_CAPTURE_WRONG_SIZE,       /* a face too small or too large for its distance */
    ISO_CAPTURE_EYES_CUT,         /* a mask with holes for eyes */
    ISO_CAPTURE_STILL,            /* nothing about it moves, as nobody can hold still */
    ISO_CAPTURE_NO_FACE_IN_IMAGE, /* depth says face, the infrared or grey image does not */
    ISO_CAPTURES
};

/* Whether the outcome is a cue of a presentation attack. */
bool iso_capture_is_attack(enum iso_capture capture);

/* "no-face", "ok", "too-far", ...: the words of the CLI, the bus and scores.csv; NULL outside the
 * range. */
const char *iso_capture_name(enum iso_capture capture);

#endif
