#include "enroll/web/daemon/json_text.h"

#include <stdbool.h>
#include <time.h>

void web_json_text(FILE *out, const char *text)
{
    (void)putc_unlocked('"', out);
    for (const unsigned char *p = (const unsigned char *)text; *p; p++) {
        if (*p < 0x20 || *p == 0x7f) {
            (void)fprintf(out, "\\u%04x", *p);
        } else {
            if (*p == '"' || *p == '\\') {
                (void)putc_unlocked('\\', out);
            }
            (void)putc_unlocked(*p, out);
        }
    }
    (void)putc_unlocked('"', out);
}

const char *web_time_text(int64_t seconds, char text[WEB_TIME_TEXT_SIZE])
{
    const time_t time = (time_t)seconds;
    struct tm utc;
    text[0] = '\0';
    if (gmtime_r(&time, &utc)) {
        (void)strftime(text, WEB_TIME_TEXT_SIZE, "%Y-%m-%dT%H:%M:%SZ", &utc);
    }
    return text;
}

int64_t web_time_read(const char *text)
{
    struct tm utc = {.tm_year = 0};
    return strptime(text, "%Y-%m-%dT%H:%M:%S", &utc) ? (int64_t)timegm(&utc) : 0;
}
