/* The state of an open gallery. Internal to firmware/gallery. */
#ifndef ISO_FIRMWARE_GALLERY_GALLERY_STATE_H
#define ISO_FIRMWARE_GALLERY_GALLERY_STATE_H

#include "firmware/gallery/gallery_db.h"
#include "firmware/gallery/gallery_memory.h"

/* A record that goes with the next change. */
struct iso_gallery_staged {
    bool on;
    int64_t id;
    uint8_t *bytes; /* NULL: the record is deleted */
    size_t size;
};

struct iso_gallery {
    struct iso_gallery_db *db;
    size_t capacity;
    struct iso_gallery_memory memory;
    bool renumbers; /* the import under way stores people of this gallery with other numbers */
    struct iso_gallery_staged staged; /* (gallery_access.c) */
};

/* A transaction that also stores the staged record: begin, changes of the database, end with the
 * result of the changes. (gallery_access.c) */
int iso__gallery_begin(struct iso_gallery *gallery, struct iso_fault *fault);
int iso__gallery_end(struct iso_gallery *gallery, int error, struct iso_fault *fault);

/* Stores template i of an item for a person; one that does not teach is excluded. *number is that
 * of the template. Called within a transaction. (gallery_apply.c) */
int iso__gallery_put_template(struct iso_gallery *gallery, int64_t person,
                              const struct iso_gallery_item *item, size_t i, int64_t *number,
                              struct iso_fault *fault);

/* iso_gallery_apply() with a listener, which counts two steps for each change. (gallery_apply.c) */
int iso__gallery_apply(struct iso_gallery *gallery, struct iso_gallery_change *changes, size_t n,
                       const struct iso_work_listener *listener, struct iso_fault *fault);

/* Whether the gallery is out of service (iso_gallery_state). (gallery_recover.c) */
bool iso__gallery_is_lost(const struct iso_gallery *gallery);

#endif
