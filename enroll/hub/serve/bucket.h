/* Limits how often something is tried: so many at once, and then so many a second. Pure. */
#ifndef HUB_SERVE_BUCKET_H
#define HUB_SERVE_BUCKET_H

#include <stdbool.h>

struct hub_bucket {
    double most, a_second; /* how many fit in, and how fast it fills */
    double left, at_s;     /* at this time */
};

/* A full bucket. */
static inline struct hub_bucket hub_bucket_of(double most, double a_second)
{
    return (struct hub_bucket){.most = most, .a_second = a_second, .left = most};
}

/* Whether one more may be tried at this time (seconds, monotonic), which then counts. */
static inline bool hub_bucket_take(struct hub_bucket *bucket, double now_s)
{
    if (bucket->at_s > 0) {
        bucket->left += (now_s - bucket->at_s) * bucket->a_second;
    }
    bucket->at_s = now_s;
    if (bucket->left > bucket->most) {
        bucket->left = bucket->most;
    }
    if (bucket->left < 1) {
        return false;
    }
    bucket->left -= 1;
    return true;
}

#endif
