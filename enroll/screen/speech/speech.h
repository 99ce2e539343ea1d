/* Says aloud what the screen shows, for people who cannot see it: the words of a scene when they
 * change, by the program espeak-ng. A verdict interrupts a hint; a hint waits until the last words
 * are spoken, and is left out if it is not shown any more by then. Names are never spoken. */
#ifndef ENROLL_SCREEN_SPEECH_SPEECH_H
#define ENROLL_SCREEN_SPEECH_SPEECH_H

#include <stdbool.h>
#include <sys/types.h>

#include "enroll/screen/scene/scene.h"

/* All zero: nothing is spoken. */
struct screen_speech {
    bool on;
    const char *language;  /* of screen_languages */
    const char *directory; /* "": aloud; else each sentence becomes DIRECTORY/NNNNN.wav */
    pid_t child;           /* 0: nothing is being spoken */
    const char *said;      /* the title of the last words; NULL: none */
    unsigned n;            /* how many sentences were begun */
};

/* Called several times a second with the scene that is shown. It does not wait. If espeak-ng is not
 * installed, it prints a line and switches itself off. */
void screen_speech_follow(struct screen_speech *speech, const struct screen_scene *scene);

/* Ends what is being spoken. */
void screen_speech_end(struct screen_speech *speech);

#endif
