#include "isotherm/capture.h"

#include <stddef.h>

bool iso_capture_is_attack(enum iso_capture capture)
{
    return capture >= ISO_CAPTURE_FLAT && capture < ISO_CAPTURES;
}

const char *iso_capture_name(enum iso_capture capture)
{
    static const char *const names[ISO_CAPTURES] = {
        "no-face",        "ok",           "too-far",          "too-close",
        "move-left",      "move-right",   "move-up",          "move-down",
        "turn-left",      "turn-right",   "look-up",          "look-down",
        "too-few-points", "covered-brow", "covered-eyes",     "covered-nose",
        "covered-mouth",  "covered-left", "covered-right",    "several-faces",
        "not-a-face",     "moving",       "expression",       "nobody",
        "flat",           "bent",         "screen",           "wrong-size",
        "eyes-cut",       "still",        "no-face-in-image",
    };
    return (unsigned)capture < ISO_CAPTURES ? names[capture] : NULL;
}
