#include "core/capture.h"

#include <stddef.h>

const char *iso_capture_name(enum iso_capture capture)
{
    static const char *const names[ISO_CAPTURES] = {
        "no-face",    "ok",         "too-far", "too-close", "off-centre",
        "turn-left",  "turn-right", "look-up", "look-down", "too-few-points",
        "not-a-face", "flat",       "moving",
    };
    return (unsigned)capture < ISO_CAPTURES ? names[capture] : NULL;
}
