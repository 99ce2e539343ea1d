#include "enroll/web/account/role.h"

#include <string.h>

static const char *const words[] = {
    [WEB_ROLE_NONE] = "none",
    [WEB_ROLE_OBSERVER] = "observer",
    [WEB_ROLE_ENROLLER] = "enroller",
    [WEB_ROLE_ADMINISTRATOR] = "administrator",
};

const char *web_role_word(enum web_role role)
{
    return words[role];
}

enum web_role web_role_of(const char *word)
{
    for (enum web_role role = WEB_ROLE_OBSERVER; role <= WEB_ROLE_ADMINISTRATOR; role++) {
        if (strcmp(word, words[role]) == 0) {
            return role;
        }
    }
    return WEB_ROLE_NONE;
}
