#include "firmware/recognise/image_tally.h"

#include <stdio.h>

void iso_image_tally_take(struct iso_image_tally *tally, enum iso_face_seen seen)
{
    if (seen == ISO_FACE_NOT_CHECKED || seen == ISO_FACE_NO_INTENSITY) {
        return;
    }
    if (iso_face_seen_disagrees(seen)) {
        tally->contradicted++;
    } else if (seen == ISO_FACE_CONFIRMED) {
        tally->confirmed++;
    } else {
        tally->unsure++;
    }
}

bool iso_image_tally_text(const struct iso_image_tally *tally, char text[ISO_IMAGE_TALLY_TEXT_SIZE])
{
    if (tally->confirmed + tally->contradicted + tally->unsure == 0) {
        return false;
    }
    (void)snprintf(text, ISO_IMAGE_TALLY_TEXT_SIZE,
                   "image: %u confirmed, %u contradicted, %u unsure", tally->confirmed,
                   tally->contradicted, tally->unsure);
    return true;
}
