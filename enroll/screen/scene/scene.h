/* From what the screen knows to what it shows. Pure: time is an argument.
 *
 * The first of these that holds is shown:
 *   OUT_OF_SERVICE  the daemon does not answer, or its sensor delivers nothing
 *   WANTED          the policy wants a card, a PIN, a face or a second person besides
 *   ALLOWED         for some seconds after a visit that was allowed
 *   REFUSED         the same after one that was refused
 *   CLOSED          lockdown, or locked out
 *   ENROL           a person is being enrolled: the same picture as NEAR
 *   BUSY            a client has the camera
 *   PANEL           the access panel shows a text
 *   NEAR            a face is before the camera: its outline, an oval to fill, a hint
 *   IDLE            nobody is there: the clock
 *
 * A hint stays long enough to be read, also when the person has followed it already. */
#ifndef ENROLL_SCREEN_SCENE_SCENE_H
#define ENROLL_SCREEN_SCENE_SCENE_H

#include "enroll/screen/scene/screen_state.h"
#include "enroll/screen/scene/words.h"

enum screen_scene_kind {
    SCREEN_OUT_OF_SERVICE = 0,
    SCREEN_WANTED,
    SCREEN_ALLOWED,
    SCREEN_REFUSED,
    SCREEN_CLOSED,
    SCREEN_ENROL,
    SCREEN_BUSY,
    SCREEN_PANEL,
    SCREEN_NEAR,
    SCREEN_IDLE,
    SCREEN_SCENES
};

/* "out-of-service", "allowed", ... ; NULL outside. */
const char *screen_scene_name(enum screen_scene_kind kind);

struct screen_scene {
    enum screen_scene_kind kind;
    const char *title;  /* a key of the catalogues; IDLE: NULL, the clock is the title */
    const char *advice; /* the same; NULL: none */
    enum screen_symbol symbol;
    char person[SCREEN_PERSON_SIZE]; /* ALLOWED: as it is spelt; PANEL: the text; else "" */
    /* NEAR, ENROL: the outline to draw; its n_points is 0 if there is no face. */
    struct iso_outline_record outline;
};

/* The longest and shortest times, nanoseconds. */
#define SCREEN_VISIT_NS  INT64_C(4000000000) /* a visit is shown */
#define SCREEN_HINT_NS   INT64_C(1500000000) /* a hint is shown at least */
#define SCREEN_RECORD_NS INT64_C(1000000000) /* a record counts */

/* What was shown before. All zero at the beginning. */
struct screen_scene_memory {
    const struct screen_words *hint; /* the hint that is shown; NULL: none */
    int64_t since_ns;
};

/* The scene at this time. */
struct screen_scene screen_scene_of(struct screen_scene_memory *memory,
                                    const struct screen_state *state, int64_t now_ns);

#endif
