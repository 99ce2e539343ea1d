/* Whether a request comes from the pages of this server, and not from a page of somebody else that
 * uses the cookie of a person who is logged in (CSRF). Pure. */
#ifndef WEB_SESSION_ORIGIN_H
#define WEB_SESSION_ORIGIN_H

#include <stdbool.h>

/* The headers of a request; NULL: it has no such header. */
struct web_origin {
    const char *host;           /* Host */
    const char *origin;         /* Origin */
    const char *sec_fetch_site; /* Sec-Fetch-Site */
};

/* For requests that change something: Sec-Fetch-Site has to be "same-origin", and Origin has to be
 * "https://" and Host. Browsers send at least one of the two; a header that is missing is not
 * compared, but a request with neither is refused. Programs send Origin. */
bool web_origin_may_change(const struct web_origin *origin);

/* For requests that only read: refuses what a browser says another site has asked for. */
bool web_origin_may_read(const struct web_origin *origin);

#endif
