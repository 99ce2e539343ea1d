#include "enroll/web/http/gzip.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <zlib.h>

enum { GZIP_WINDOW = 15 + 16 /* zlib writes the header of gzip */, GZIP_MEMORY = 8 };

/* Whether the parameters of a coding, such as ";q=0.5", have a weight of 0. */
static bool is_forbidden(const char *parameters, size_t length)
{
    const char *equals = memchr(parameters, '=', length);
    const char *end = parameters + length;

    if (!equals) {
        return false;
    }
    for (equals++; equals < end && strchr(" 0.", *equals); equals++) {
    }
    return equals == end;
}

bool web__accepts_gzip(const char *accept_encoding)
{
    static const char name[] = "gzip";
    const char *at = accept_encoding ? accept_encoding : "";

    for (at += strspn(at, ", \t"); *at; at += strspn(at, ", \t")) {
        const size_t n = strcspn(at, ",");
        if (strncasecmp(at, name, sizeof name - 1) == 0 &&
            (n == sizeof name - 1 || strchr(" ;", at[sizeof name - 1]))) {
            return !is_forbidden(at + sizeof name - 1, n - (sizeof name - 1));
        }
        at += n;
    }
    return false;
}

bool web__gzip(char **text, size_t *size)
{
    z_stream stream = {.next_in = (Bytef *)*text, .avail_in = (uInt)*size};
    char *compressed;

    if (deflateInit2(&stream, Z_BEST_SPEED, Z_DEFLATED, GZIP_WINDOW, GZIP_MEMORY,
                     Z_DEFAULT_STRATEGY) != Z_OK) {
        return false;
    }
    stream.avail_out = (uInt)deflateBound(&stream, (uLong)*size);
    compressed = malloc(stream.avail_out);
    stream.next_out = (Bytef *)compressed;
    if (!compressed || deflate(&stream, Z_FINISH) != Z_STREAM_END) {
        (void)deflateEnd(&stream);
        free(compressed);
        return false;
    }
    *size = (size_t)stream.total_out;
    (void)deflateEnd(&stream);
    free(*text);
    *text = compressed;
    return true;
}
