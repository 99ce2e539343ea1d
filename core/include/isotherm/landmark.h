/** @file
 * The twelve landmarks at which heat is released, and the 68 that they are taken from.
 *
 * A name that ends in _R or _L is the SUBJECT's right or left. */
#ifndef ISOTHERM_LANDMARK_H
#define ISOTHERM_LANDMARK_H

/** The landmarks. */
enum iso_landmark {
    ISO_LM_NASION,    /**< The root of the nose. */
    ISO_LM_NOSE_TIP,  /**< The tip of the nose. */
    ISO_LM_SUBNASALE, /**< Where the nose meets the upper lip. */
    ISO_LM_ALA_R,     /**< The right wing of the nose. */
    ISO_LM_ALA_L,     /**< The left wing of the nose. */
    ISO_LM_EYE_IN_R,  /**< The inner corner of the right eye. */
    ISO_LM_EYE_IN_L,  /**< The inner corner of the left eye. */
    ISO_LM_EYE_OUT_R, /**< The outer corner of the right eye. */
    ISO_LM_EYE_OUT_L, /**< The outer corner of the left eye. */
    ISO_LM_LIP_UPPER, /**< The middle of the upper lip. */
    ISO_LM_MOUTH_R,   /**< The right corner of the mouth. */
    ISO_LM_MOUTH_L,   /**< The left corner of the mouth. */
    ISO_LANDMARKS     /**< How many there are. */
};

enum {
    ISO_LANDMARKS_IBUG = 68, /**< Points of the scheme iBUG 300-W (Sagonas 2013; Multi-PIE). */
};

/** The index of each landmark among the 68 points of iBUG 300-W, counted from 0. */
extern const int iso_landmark_ibug[ISO_LANDMARKS];

/** The name of a landmark, such as "nasion" or "nose_tip".
 *
 * @param landmark  The landmark.
 * @return A constant; NULL outside the range. */
const char *iso_landmark_name(enum iso_landmark landmark);

#endif
