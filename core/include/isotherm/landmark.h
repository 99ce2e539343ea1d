/* The twelve landmarks at which heat is released, and the 68 they are taken from.
 *
 * A name ending in _r or _l is the SUBJECT's right or left. The indices into the 68-point scheme
 * (iBUG 300-W / Multi-PIE, Sagonas 2013, counted from 0) are in iso_landmark_ibug. */
#ifndef ISOTHERM_LANDMARK_H
#define ISOTHERM_LANDMARK_H

enum iso_landmark {
    ISO_LM_NASION,
    ISO_LM_NOSE_TIP,
    ISO_LM_SUBNASALE,
    ISO_LM_ALA_R,
    ISO_LM_ALA_L,
    ISO_LM_EYE_IN_R,
    ISO_LM_EYE_IN_L,
    ISO_LM_EYE_OUT_R,
    ISO_LM_EYE_OUT_L,
    ISO_LM_LIP_UPPER,
    ISO_LM_MOUTH_R,
    ISO_LM_MOUTH_L,
    ISO_LANDMARKS
};

enum { ISO_LANDMARKS_IBUG = 68 };

/* Index of the landmark among the 68. */
extern const int iso_landmark_ibug[ISO_LANDMARKS];

/* "nasion", "nose_tip", ..., as in landmarks.csv; NULL outside the range. */
const char *iso_landmark_name(enum iso_landmark landmark);

#endif
