#include "drivers/sensor/openni2/openni2_pairing.h"

#include <stddef.h>

static void release(OniFrame **frame)
{
    if (*frame) {
        oniFrameRelease(*frame);
        *frame = NULL;
    }
}

int64_t iso__openni2_frame_ns(const OniFrame *frame)
{
    return (int64_t)frame->timestamp * 1000;
}

void iso__openni2_pairing_add(struct iso__openni2_pairing *pairing, OniFrame *frame)
{
    if (frame->sensorType != ONI_SENSOR_DEPTH) {
        release(&pairing->grey);
        pairing->grey = frame;
        return;
    }
    if (pairing->depth) {
        pairing->dropped++;
        release(&pairing->depth);
    }
    pairing->depth = frame;
}

bool iso__openni2_pairing_complete(struct iso__openni2_pairing *pairing, bool with_grey, int fps)
{
    if (!with_grey) {
        return pairing->depth != NULL;
    }
    if (!pairing->depth || !pairing->grey) {
        return false;
    }
    const int64_t half_ns = INT64_C(500000000) / fps;
    const int64_t ahead_ns = iso__openni2_frame_ns(pairing->grey) -
                             iso__openni2_frame_ns(pairing->depth);
    if (ahead_ns > half_ns) {
        pairing->dropped++;
        release(&pairing->depth);
    } else if (ahead_ns < -half_ns) {
        release(&pairing->grey);
    }
    return pairing->depth && pairing->grey;
}

void iso__openni2_pairing_clear(struct iso__openni2_pairing *pairing)
{
    release(&pairing->depth);
    release(&pairing->grey);
}
