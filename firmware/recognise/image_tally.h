/* Counts the results of the image check for the faces of one visit, for the audit log. Pure. */
#ifndef ISO_FIRMWARE_RECOGNISE_IMAGE_TALLY_H
#define ISO_FIRMWARE_RECOGNISE_IMAGE_TALLY_H

#include <stddef.h>

#include "drivers/vision/face_check.h"

enum { ISO_IMAGE_TALLY_TEXT_SIZE = 96 };

struct iso_image_tally {
    unsigned confirmed, contradicted, unsure; /* numbers of frames */
};

/* Counts one result. Frames without a check of the face, or without an image, do not count. */
void iso_image_tally_take(struct iso_image_tally *tally, enum iso_face_seen seen);

/* Writes "image: 2 confirmed, 1 contradicted, 0 unsure". Returns false and writes nothing if
 * nothing was counted. */
bool iso_image_tally_text(const struct iso_image_tally *tally,
                          char text[ISO_IMAGE_TALLY_TEXT_SIZE]);

#endif
