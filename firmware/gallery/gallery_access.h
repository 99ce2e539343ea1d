/* The access records (gallery.h) in memory. Internal to the gallery. */
#ifndef ISO_FIRMWARE_GALLERY_GALLERY_ACCESS_H
#define ISO_FIRMWARE_GALLERY_GALLERY_ACCESS_H

#include <stddef.h>
#include <stdint.h>

struct iso_gallery_access {
    int64_t person; /* 0: the site */
    uint8_t *bytes;
    size_t size;
    uint32_t parts; /* of the database; counted while they are loaded */
};

/* Records in ascending order of person. All zero is empty. */
struct iso_gallery_access_list {
    struct iso_gallery_access *records;
    size_t n, capacity;
};

/* Wipes and frees everything. */
void iso_gallery_access_done(struct iso_gallery_access_list *list);

/* Returns NULL if there is none. */
const struct iso_gallery_access *iso_gallery_access_find(const struct iso_gallery_access_list *list,
                                                         int64_t person);

/* Adds part number `part` of a record. The parts come in ascending order of person and part.
 * -EBADMSG a part is missing or the record is too long, -ENOMEM. */
int iso_gallery_access_load(struct iso_gallery_access_list *list, int64_t person, uint32_t part,
                            const void *bytes, size_t size) __attribute__((warn_unused_result));

/* Makes room for n more records. -ENOMEM. */
int iso_gallery_access_reserve(struct iso_gallery_access_list *list, size_t n)
    __attribute__((warn_unused_result));

/* Puts a record, whose bytes then belong to the list, in place of the earlier one. The caller has
 * made room. */
void iso_gallery_access_put(struct iso_gallery_access_list *list, int64_t person, uint8_t *bytes,
                            size_t size);

/* Wipes and removes the record of a person, if there is one. */
void iso_gallery_access_remove(struct iso_gallery_access_list *list, int64_t person);

#endif
