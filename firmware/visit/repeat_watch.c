#include "firmware/visit/repeat_watch.h"

bool iso_repeat_watch_take(struct iso_repeat_watch *watch, bool repeats)
{
    watch->run = repeats != watch->stuck ? watch->run + 1 : 0;
    if (watch->run < (watch->stuck ? ISO_NEW_TO_FREE : ISO_REPEATS_TO_STUCK)) {
        return false;
    }
    watch->stuck = !watch->stuck;
    watch->run = 0;
    return true;
}
