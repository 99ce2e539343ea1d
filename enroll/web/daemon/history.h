/* How the appliance did in each minute of the last day. Pure; nothing is allocated. */
#ifndef WEB_DAEMON_HISTORY_H
#define WEB_DAEMON_HISTORY_H

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

enum { WEB_HISTORY_SAMPLES = 24 * 60 };

struct web_sample {
    int64_t time_s; /* the end of its minute, since 1970 */
    float frames_per_s;
    uint32_t allowed, denied, attack_frames; /* of this minute */
    bool sensor_works;                       /* whenever the daemon was asked */
};

/* Counters of the daemon, which begin at 0 whenever it starts. */
struct web_counters {
    uint64_t frames, allowed, denied, attack_frames;
};

/* An all-zero history is empty. */
struct web_history {
    int n, next; /* `next` is the place of the next sample */
    struct web_sample samples[WEB_HISTORY_SAMPLES];
    int64_t begin_ns; /* of this minute; 0: it has not begun */
    bool sensor_works;
    struct web_counters last, sum; /* the newest counters, and what came to them in this minute */
    bool has_last;
};

/* Takes the reply of GetStatus, or NULL if the daemon does not answer. Called about each second.
 * now_ns is monotonic and above 0, now_s is since 1970. */
void web_history_take(struct web_history *history, const json_t *status, int64_t now_ns,
                      int64_t now_s);

/* Writes the samples as a JSON array, the oldest first. */
void web_history_write(const struct web_history *history, FILE *out);

#endif
