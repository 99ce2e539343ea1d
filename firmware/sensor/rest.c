#include "firmware/sensor/rest.h"

bool iso_rest_skips(struct iso_rest *rest, const struct iso_rest_frame *frame)
{
    if (frame->stirs || frame->wanted) {
        rest->busy_ns = frame->t_ns;
        rest->has_busy = true;
        rest->resting = false;
    }
    if (!rest->resting) {
        return false;
    }
    return rest->has_examined && frame->t_ns - rest->examined_ns < ISO_REST_EXAMINE_NS;
}

void iso_rest_note(struct iso_rest *rest, int64_t t_ns, bool busy, int64_t after_ns)
{
    rest->has_examined = true;
    rest->examined_ns = t_ns;
    if (busy || !rest->has_busy) {
        rest->has_busy = true;
        rest->busy_ns = t_ns;
    }
    rest->resting = !busy && after_ns > 0 && t_ns - rest->busy_ns >= after_ns;
}

void iso_rest_end(struct iso_rest *rest)
{
    *rest = (struct iso_rest){.resting = false};
}
