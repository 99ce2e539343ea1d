/* The language of the screen: English, or one of the catalogues that are installed. */
#ifndef ENROLL_SCREEN_LANGUAGE_LANGUAGE_H
#define ENROLL_SCREEN_LANGUAGE_LANGUAGE_H

#include <stdbool.h>

/* The languages that there are: "en", "de", "fr", "es", "ar", "zh_CN"; ended by NULL. */
extern const char *const screen_languages[];

/* Selects a language for gettext(), which does not depend on the locales of the machine: all texts
 * are UTF-8. `catalogues` is the directory with LANGUAGE/LC_MESSAGES/isotherm-screen.mo. -EINVAL:
 * no such language. A catalogue that is missing leaves English; -ENOENT then. */
int screen_language_set(const char *language, const char *catalogues)
    __attribute__((warn_unused_result));

/* Whether it is written from right to left. */
bool screen_language_is_right_to_left(const char *language);

#endif
