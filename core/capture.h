/* What became of a frame: a usable face, or the reason why not, which is also the hint to the
 * person. A numerical outcome, never an error code and never a verdict. Zero is "no face". */
#ifndef ISO_CORE_CAPTURE_H
#define ISO_CORE_CAPTURE_H

enum iso_capture {
    ISO_CAPTURE_NO_FACE = 0,
    ISO_CAPTURE_OK,
    ISO_CAPTURE_TOO_FAR,
    ISO_CAPTURE_TOO_CLOSE,
    ISO_CAPTURE_OFF_CENTRE, /* the face is cut by the image border */
    ISO_CAPTURE_TURN_LEFT,  /* not frontal: the subject should turn to his or her left */
    ISO_CAPTURE_TURN_RIGHT,
    ISO_CAPTURE_LOOK_UP,
    ISO_CAPTURE_LOOK_DOWN,
    ISO_CAPTURE_TOO_FEW_POINTS, /* holes: hair, hands, sunlight */
    ISO_CAPTURE_NOT_A_FACE,     /* something is there, it does not fit a head */
    ISO_CAPTURE_FLAT,           /* a picture; extract.h has no gate that says so yet */
    ISO_CAPTURE_MOVING,
    ISO_CAPTURES
};

/* "no-face", "ok", "too-far", ...: the words of the CLI, the bus and scores.csv; NULL outside the
 * range. */
const char *iso_capture_name(enum iso_capture capture);

#endif
