#include "enroll/screen/language/language.h"

#include <errno.h>
#include <libintl.h>
#include <limits.h>
#include <locale.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char domain[] = "isotherm-screen";

const char *const screen_languages[] = {"en", "de", "fr", "es", "ar", "zh_CN", NULL};

static bool is_known(const char *language)
{
    for (const char *const *known = screen_languages; *known; known++) {
        if (strcmp(language, *known) == 0) {
            return true;
        }
    }
    return false;
}

static bool has_catalogue(const char *language, const char *catalogues)
{
    char path[PATH_MAX];
    (void)snprintf(path, sizeof path, "%s/%s/LC_MESSAGES/%s.mo", catalogues, language, domain);
    return access(path, R_OK) == 0;
}

int screen_language_set(const char *language, const char *catalogues)
{
    if (!is_known(language)) {
        return -EINVAL;
    }
    /* gettext() ignores LANGUAGE in the locale "C", and every Debian has C.UTF-8. */
    if (!setlocale(LC_ALL, "C.UTF-8") || setenv("LANGUAGE", language, 1)) {
        return -ENOENT;
    }
    (void)bindtextdomain(domain, catalogues);
    (void)bind_textdomain_codeset(domain, "UTF-8");
    (void)textdomain(domain);
    return strcmp(language, "en") == 0 || has_catalogue(language, catalogues) ? 0 : -ENOENT;
}

bool screen_language_is_right_to_left(const char *language)
{
    return strcmp(language, "ar") == 0;
}
