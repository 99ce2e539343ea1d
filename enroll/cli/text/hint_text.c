#include "enroll/cli/text/hint_text.h"

#include <stddef.h>
#include <string.h>

#include "isotherm/capture.h"

const char *cli_hint_text(const char *capture_word)
{
    static const char *const hints[ISO_CAPTURES] = {
        [ISO_CAPTURE_NO_FACE] = "no face to be seen: stand in front of the camera",
        [ISO_CAPTURE_NOBODY] = "nobody is there",
        [ISO_CAPTURE_OK] = "good, hold still",
        [ISO_CAPTURE_TOO_FAR] = "come closer",
        [ISO_CAPTURE_TOO_CLOSE] = "step back a little",
        [ISO_CAPTURE_MOVE_LEFT] = "move a little to your left",
        [ISO_CAPTURE_MOVE_RIGHT] = "move a little to your right",
        [ISO_CAPTURE_MOVE_UP] = "come up a little: the camera looks over your face",
        [ISO_CAPTURE_MOVE_DOWN] =
            "come down a little, or step back: the camera sees only part of your face",
        [ISO_CAPTURE_TURN_LEFT] = "turn a little to your left",
        [ISO_CAPTURE_TURN_RIGHT] = "turn a little to your right",
        [ISO_CAPTURE_LOOK_UP] = "lift your chin a little",
        [ISO_CAPTURE_LOOK_DOWN] = "lower your chin a little",
        [ISO_CAPTURE_TOO_FEW_POINTS] = "keep hair and hands off your face, and avoid direct sun",
        [ISO_CAPTURE_COVERED_BROW] = "push your hair, cap or hood back from your forehead",
        [ISO_CAPTURE_COVERED_EYES] = "take your glasses or your hand from your eyes",
        [ISO_CAPTURE_COVERED_NOSE] = "take what covers your nose away",
        [ISO_CAPTURE_COVERED_MOUTH] = "take your scarf, mask or hand from your mouth",
        [ISO_CAPTURE_COVERED_LEFT] = "the left half of your face is covered",
        [ISO_CAPTURE_COVERED_RIGHT] = "the right half of your face is covered",
        [ISO_CAPTURE_SEVERAL_FACES] = "one at a time: several faces are equally near",
        [ISO_CAPTURE_NOT_A_FACE] = "look straight at the camera",
        [ISO_CAPTURE_FLAT] = "this looks like a picture: a real face is needed",
        [ISO_CAPTURE_BENT] = "this looks like a bent picture: a real face is needed",
        [ISO_CAPTURE_SCREEN] = "this looks like a screen: a real face is needed",
        [ISO_CAPTURE_WRONG_SIZE] = "this face has the wrong size: a real face is needed",
        [ISO_CAPTURE_EYES_CUT] = "this looks like a mask: a real face is needed",
        [ISO_CAPTURE_STILL] = "nothing moves: a living face is needed",
        [ISO_CAPTURE_NO_FACE_IN_IMAGE] = "the camera's image shows no face: look straight at it",
        [ISO_CAPTURE_MOVING] = "hold still",
        [ISO_CAPTURE_EXPRESSION] = "close your mouth and look calm",
    };

    for (int i = 0; i < ISO_CAPTURES; i++) {
        if (strcmp(capture_word, iso_capture_name((enum iso_capture)i)) == 0) {
            return hints[i];
        }
    }
    return NULL;
}
