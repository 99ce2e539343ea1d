/* What the screen knows: the last record of the outline stream, the last visit and the state of the
 * daemon. The client fills it in (enroll/screen/client/client.h); scene.h makes a scene of it. */
#ifndef ENROLL_SCREEN_SCENE_SCREEN_STATE_H
#define ENROLL_SCREEN_SCENE_SCREEN_STATE_H

#include <stdbool.h>
#include <stdint.h>

#include "firmware/contract/stream_record.h"

enum { SCREEN_PERSON_SIZE = 256, SCREEN_PANEL_TEXT_SIZE = 128 };

/* All zero: nothing is known, the daemon is not there. Times are of CLOCK_MONOTONIC, nanoseconds.
 */
struct screen_state {
    bool connected; /* the daemon answers */
    bool sees;      /* its sensor delivers frames */
    bool lockdown, locked_out;
    char mode[12]; /* of the last record: "watch", "claimed", "enroll", "verify", "identify" */
    char panel_text[SCREEN_PANEL_TEXT_SIZE]; /* of the access panel, in one line; "": none */
    char panel_lamp[12];                     /* its lamp: "off", "red", "green", ... */
    bool has_record;
    struct iso_outline_record record;
    int64_t record_ns; /* when it arrived */
    bool has_visit;
    bool allowed;                    /* the last visit */
    char person[SCREEN_PERSON_SIZE]; /* its person, UTF-8; "": unknown, or not to be shown */
    char reason[16];                 /* a word of firmware/visit/decision.h */
    int64_t visit_ns;                /* when it was told */
};

#endif
