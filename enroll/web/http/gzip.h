/* Compression of long answers (RFC 1952). Internal to enroll/web/http.
 *
 * A list of 10,000 people is 1 MB, and the browser needs longer to receive than the server to
 * compress it. Answers are not compressed together with what other sites send: their requests are
 * refused (session/origin.h), so that their lengths tell nobody anything. */
#ifndef WEB_HTTP_GZIP_H
#define WEB_HTTP_GZIP_H

#include <stdbool.h>
#include <stddef.h>

enum { WEB_GZIP_LEAST_BYTES = 16 << 10 }; /* shorter answers are sent as they are */

/* Whether a header Accept-Encoding names gzip without forbidding it. NULL: there is no header. */
bool web__accepts_gzip(const char *accept_encoding);

/* Replaces a text, which was made by malloc(), by its compressed form. Returns false, with all as
 * it was, if there is no memory. */
bool web__gzip(char **text, size_t *size);

#endif
