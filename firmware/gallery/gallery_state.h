/* The state of an open gallery. Internal to firmware/gallery. */
#ifndef ISO_FIRMWARE_GALLERY_GALLERY_STATE_H
#define ISO_FIRMWARE_GALLERY_GALLERY_STATE_H

#include "firmware/gallery/gallery_db.h"
#include "firmware/gallery/gallery_memory.h"

struct iso_gallery {
    struct iso_gallery_db *db;
    size_t capacity;
    struct iso_gallery_memory memory;
    bool renumbers; /* the import under way stores people of this gallery with other numbers */
};

/* Whether the gallery is out of service (iso_gallery_state). (gallery_recover.c) */
bool iso__gallery_is_lost(const struct iso_gallery *gallery);

#endif
