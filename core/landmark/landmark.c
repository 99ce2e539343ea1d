#include "isotherm/landmark.h"

#include <stddef.h>

const int iso_landmark_ibug[ISO_LANDMARKS] = {27, 30, 33, 31, 35, 39, 42, 36, 45, 51, 48, 54};

const char *iso_landmark_name(enum iso_landmark landmark)
{
    static const char *const names[ISO_LANDMARKS] = {
        "nasion",   "nose_tip",  "subnasale", "ala_r",     "ala_l",   "eye_in_r",
        "eye_in_l", "eye_out_r", "eye_out_l", "lip_upper", "mouth_r", "mouth_l",
    };
    return (unsigned)landmark < ISO_LANDMARKS ? names[landmark] : NULL;
}
