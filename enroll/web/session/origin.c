#include "enroll/web/session/origin.h"

#include <stddef.h>
#include <string.h>
#include <strings.h>

static bool is_own(const struct web_origin *origin)
{
    static const char scheme[] = "https://";

    return origin->host && *origin->host &&
           strncmp(origin->origin, scheme, sizeof scheme - 1) == 0 &&
           strcasecmp(origin->origin + sizeof scheme - 1, origin->host) == 0;
}

bool web_origin_may_change(const struct web_origin *origin)
{
    if (!origin->origin && !origin->sec_fetch_site) {
        return false;
    }
    if (origin->sec_fetch_site && strcmp(origin->sec_fetch_site, "same-origin") != 0) {
        return false;
    }
    return !origin->origin || is_own(origin);
}

bool web_origin_may_read(const struct web_origin *origin)
{
    const char *site = origin->sec_fetch_site;

    return (!site || strcmp(site, "same-origin") == 0 || strcmp(site, "none") == 0) &&
           (!origin->origin || is_own(origin));
}
