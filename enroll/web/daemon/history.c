#include "enroll/web/daemon/history.h"

#include <inttypes.h>
#include <string.h>

#include "enroll/cli/client/state.h"

static const int64_t MINUTE_NS = 60000000000;

static uint64_t count_of(const json_t *status, const char *key)
{
    return (uint64_t)cli_state_number(status, key, 0);
}

/* What came to a counter. One that is lower than before began anew with the daemon. */
static uint64_t growth(uint64_t before, uint64_t now)
{
    return now >= before ? now - before : now;
}

static void count(struct web_history *history, const json_t *status)
{
    const struct web_counters now = {
        .frames = count_of(status, "frames"),
        .allowed = count_of(status, "visits-allowed"),
        .denied = count_of(status, "visits-denied"),
        .attack_frames = count_of(status, "attack-frames"),
    };
    if (history->has_last) {
        const struct web_counters *last = &history->last;
        history->sum.frames += growth(last->frames, now.frames);
        history->sum.allowed += growth(last->allowed, now.allowed);
        history->sum.denied += growth(last->denied, now.denied);
        history->sum.attack_frames += growth(last->attack_frames, now.attack_frames);
    }
    history->last = now;
    history->has_last = true;
}

static void end_minute(struct web_history *history, int64_t now_ns, int64_t now_s)
{
    const double took_s = (double)(now_ns - history->begin_ns) / 1e9;
    history->samples[history->next] = (struct web_sample){
        .time_s = now_s,
        .frames_per_s = (float)((double)history->sum.frames / took_s),
        .allowed = (uint32_t)history->sum.allowed,
        .denied = (uint32_t)history->sum.denied,
        .attack_frames = (uint32_t)history->sum.attack_frames,
        .sensor_works = history->sensor_works,
    };
    history->next = (history->next + 1) % WEB_HISTORY_SAMPLES;
    history->n += history->n < WEB_HISTORY_SAMPLES;
    history->begin_ns = now_ns;
    history->sum = (struct web_counters){.frames = 0};
    history->sensor_works = true;
}

void web_history_take(struct web_history *history, const json_t *status, int64_t now_ns,
                      int64_t now_s)
{
    const char *sensor = cli_state_text(status, "sensor-state");
    if (history->begin_ns == 0) {
        history->begin_ns = now_ns;
        history->sensor_works = true;
    }
    if (status) {
        count(history, status);
    }
    history->sensor_works = history->sensor_works && sensor && strcmp(sensor, "started") == 0;
    if (now_ns - history->begin_ns >= MINUTE_NS) {
        end_minute(history, now_ns, now_s);
    }
}

void web_history_write(const struct web_history *history, FILE *out)
{
    const int first = history->n < WEB_HISTORY_SAMPLES ? 0 : history->next;
    (void)fputc('[', out);
    for (int i = 0; i < history->n; i++) {
        const struct web_sample *s = &history->samples[(first + i) % WEB_HISTORY_SAMPLES];
        (void)fprintf(out,
                      "%s{\"time_s\":%" PRId64 ",\"frames_per_s\":%.2f,\"allowed\":%" PRIu32
                      ",\"denied\":%" PRIu32 ",\"attack_frames\":%" PRIu32 ",\"sensor_works\":%s}",
                      i ? "," : "", s->time_s, (double)s->frames_per_s, s->allowed, s->denied,
                      s->attack_frames, s->sensor_works ? "true" : "false");
    }
    (void)fputc(']', out);
}
