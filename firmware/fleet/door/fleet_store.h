/* Where a door of a fleet keeps its people and what it knows of the fleet: a table of functions, so
 * that a measurement can run thousands of doors in memory. iso_fleet_gallery_store() is the real
 * one. */
#ifndef ISO_FIRMWARE_FLEET_DOOR_FLEET_STORE_H
#define ISO_FIRMWARE_FLEET_DOOR_FLEET_STORE_H

#include "firmware/gallery/gallery.h"

/* All functions are REQUIRED. What they hand out is valid until the next change. */
struct iso_fleet_store {
    void *context;
    /* 0, or -EIO while the store is out of service. */
    int (*state)(void *context, struct iso_fault *fault);
    /* Which store it is, and how often it was changed. */
    struct iso_gallery_version (*version)(void *context);
    /* All people; the access record of one, of the site or of the fleet (gallery.h). NULL: none. */
    const struct iso_person *(*people)(void *context, size_t *n);
    const struct iso_person *(*find)(void *context, const char *name);
    const struct iso_person *(*find_id)(void *context, int64_t person);
    const void *(*access)(void *context, int64_t id, size_t *size);
    /* As iso_gallery_apply(), with the record of the fleet in the same transaction. size 0 deletes
     * the record. */
    int (*apply)(void *context, struct iso_gallery_change *changes, size_t n, const void *record,
                 size_t size, struct iso_fault *fault);
    /* Keeps the record of the fleet until the next change of the record of the site, which stores
     * both together; unstage drops one that was not stored. */
    int (*stage)(void *context, const void *record, size_t size, struct iso_fault *fault);
    void (*unstage)(void *context);
    /* Calls `each` once with a person and all templates; not for a person without any. As
     * iso_gallery_export(). */
    int (*templates)(void *context, const struct iso_person *person,
                     int (*each)(void *context, const struct iso_gallery_item *item,
                                 struct iso_fault *fault),
                     void *each_context, struct iso_fault *fault);
};

/* The store of a gallery, which must outlive it. */
struct iso_fleet_store iso_fleet_gallery_store(struct iso_gallery *gallery);

#endif
