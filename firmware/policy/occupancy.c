#include "firmware/policy/occupancy.h"

void iso_presence_enter(struct iso_presence *presence, const struct iso_access_point *access_point,
                        int64_t time_s)
{
    *presence = access_point->to == ISO_INDEX_NONE ? (struct iso_presence){0}
                                                   : (struct iso_presence){.known = true,
                                                                           .area = access_point->to,
                                                                           .since_s = time_s};
}

void iso_presence_forget(struct iso_presence *presence)
{
    *presence = (struct iso_presence){0};
}
