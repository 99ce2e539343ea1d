/* The clock by which the web server measures times: nanoseconds, monotonic. */
#ifndef WEB_HTTP_NOW_H
#define WEB_HTTP_NOW_H

#include <stdint.h>
#include <time.h>

static inline int64_t web_now_ns(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

#endif
