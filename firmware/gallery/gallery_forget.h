/* The way back from what the appliance has learned: the gallery as it was enrolled. */
#ifndef ISO_FIRMWARE_GALLERY_GALLERY_FORGET_H
#define ISO_FIRMWARE_GALLERY_GALLERY_FORGET_H

#include "firmware/gallery/gallery.h"

/* Deletes all learned templates, in one transaction; *n is how many there were. People who had some
 * get another id; names, dates and enrolled templates stay. Who had nothing else keeps them. Errors
 * of iso_gallery_export and iso_gallery_import; then nothing has changed. */
int iso_gallery_forget_learned(struct iso_gallery *gallery, size_t *n, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
