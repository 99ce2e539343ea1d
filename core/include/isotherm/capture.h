/** @file
 * What became of a frame: a usable face, or the reason why not.
 *
 * The reason is also the hint to the person. It is a result, never an error code and never a
 * verdict. Zero is "no face": something is there, but it is not like a face.
 *
 * Directions are the SUBJECT's: "move-left" asks the person to step to his or her own left. */
#ifndef ISOTHERM_CAPTURE_H
#define ISOTHERM_CAPTURE_H

#include <stdbool.h>

/** What became of a frame. */
enum iso_capture {
    ISO_CAPTURE_NO_FACE = 0,    /**< Something is there, but nothing like a face. */
    ISO_CAPTURE_OK,             /**< A usable face. */
    ISO_CAPTURE_TOO_FAR,        /**< The face is too far from the sensor. */
    ISO_CAPTURE_TOO_CLOSE,      /**< The face is too close to the sensor. */
    ISO_CAPTURE_MOVE_LEFT,      /**< The border of the image cuts the face: move to the left. */
    ISO_CAPTURE_MOVE_RIGHT,     /**< The same: move to the right. */
    ISO_CAPTURE_MOVE_UP,        /**< The same: move up. */
    ISO_CAPTURE_MOVE_DOWN,      /**< The same: move down. */
    ISO_CAPTURE_TURN_LEFT,      /**< Not frontal: turn the head to the left. */
    ISO_CAPTURE_TURN_RIGHT,     /**< The same: turn the head to the right. */
    ISO_CAPTURE_LOOK_UP,        /**< The same: look up. */
    ISO_CAPTURE_LOOK_DOWN,      /**< The same: look down. */
    ISO_CAPTURE_TOO_FEW_POINTS, /**< Holes all over: sunlight, dark hair, a smeared lens. */
    ISO_CAPTURE_COVERED_BROW,   /**< Something is before the brow, or it is a hole. */
    ISO_CAPTURE_COVERED_EYES,   /**< The same of the eyes. */
    ISO_CAPTURE_COVERED_NOSE,   /**< The same of the nose. */
    ISO_CAPTURE_COVERED_MOUTH,  /**< The same of the mouth. */
    ISO_CAPTURE_COVERED_LEFT,   /**< The same of the left half of the face. */
    ISO_CAPTURE_COVERED_RIGHT,  /**< The same of the right half of the face. */
    ISO_CAPTURE_SEVERAL_FACES,  /**< There are two faces at about the same distance. */
    ISO_CAPTURE_NOT_A_FACE,     /**< Something is there, but it does not fit a head. */
    ISO_CAPTURE_MOVING,         /**< The face moves too fast. */
    ISO_CAPTURE_EXPRESSION, /**< The expression is too strong: enrolment wants a neutral face. */
    ISO_CAPTURE_NOBODY,     /**< There is nothing in the scene except the background. */
    ISO_CAPTURE_FLAT,       /**< Presentation attack (ISO/IEC 30107-1): a flat picture. */
    ISO_CAPTURE_BENT,       /**< Presentation attack: a bent picture. */
    ISO_CAPTURE_SCREEN,     /**< Presentation attack: a flat object with holes where it shines. */
    ISO_CAPTURE_WRONG_SIZE, /**< Presentation attack: too small or large for its distance. */
    ISO_CAPTURE_EYES_CUT,   /**< Presentation attack: a mask with holes for eyes. */
    ISO_CAPTURE_STILL,      /**< Presentation attack: it holds stiller than anybody can. */
    ISO_CAPTURE_NO_FACE_IN_IMAGE, /**< Depth says face, the infrared or grey image does not. */
    ISO_CAPTURES                  /**< How many there are. */
};

/** Whether an outcome is a cue of a presentation attack.
 *
 * @param capture  The outcome.
 * @return True for the outcomes that are marked as presentation attacks, and for
 *         ISO_CAPTURE_NO_FACE_IN_IMAGE. */
bool iso_capture_is_attack(enum iso_capture capture);

/** The word of an outcome, such as "no-face", "ok" or "too-far".
 *
 * @param capture  The outcome.
 * @return A constant; NULL outside the range. */
const char *iso_capture_name(enum iso_capture capture);

#endif
