#include "drivers/sensor/contract/timeline.h"

void iso_timeline_advance(struct iso_timeline *timeline, int64_t index, int64_t device_ns,
                          int64_t now_ns)
{
    const int64_t passed_ns = device_ns - timeline->device_ns;
    const int64_t delay_ns = now_ns - device_ns;
    const bool goes_on = timeline->begun && !timeline->anew && index > timeline->index &&
                         passed_ns > 0;
    if (goes_on) {
        const int64_t risen_ns = timeline->offset_ns +
                                 passed_ns / (1000000 / ISO_TIMELINE_DRIFT_PPM);
        timeline->offset_ns = delay_ns < risen_ns ? delay_ns : risen_ns;
        timeline->sequence += timeline->gapless ? 1 : (uint64_t)(index - timeline->index);
    } else {
        timeline->offset_ns = delay_ns;
        timeline->sequence += timeline->begun ? 1 : 0;
    }
    const int64_t t_ns = device_ns + timeline->offset_ns;
    const bool rises = !timeline->begun || t_ns > timeline->t_ns;
    timeline->t_ns = rises ? t_ns : timeline->t_ns + 1;
    timeline->index = index;
    timeline->device_ns = device_ns;
    timeline->begun = true;
    timeline->anew = false;
}

void iso_timeline_restart(struct iso_timeline *timeline)
{
    timeline->anew = true;
}
