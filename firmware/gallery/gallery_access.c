#include "firmware/gallery/gallery_access.h"

#include <errno.h>
#include <sodium.h>
#include <stdlib.h>
#include <string.h>

#include "firmware/gallery/gallery_state.h"

static void wipe(uint8_t *bytes, size_t size)
{
    if (bytes) {
        sodium_memzero(bytes, size);
        free(bytes);
    }
}

void iso_gallery_access_done(struct iso_gallery_access_list *list)
{
    for (size_t i = 0; i < list->n; i++) {
        wipe(list->records[i].bytes, list->records[i].size);
    }
    free(list->records);
    *list = (struct iso_gallery_access_list){0};
}

/* The first record of this person or of a later one. */
static size_t place_of(const struct iso_gallery_access_list *list, int64_t person)
{
    size_t low = 0, high = list->n;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        if (list->records[middle].person < person) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

const struct iso_gallery_access *iso_gallery_access_find(const struct iso_gallery_access_list *list,
                                                         int64_t person)
{
    const size_t at = place_of(list, person);
    return at < list->n && list->records[at].person == person ? &list->records[at] : NULL;
}

int iso_gallery_access_reserve(struct iso_gallery_access_list *list, size_t n)
{
    if (n <= list->capacity - list->n) {
        return 0;
    }
    const size_t more = 2 * list->capacity + n + 16;
    void *grown = reallocarray(list->records, more, sizeof *list->records);
    if (!grown) {
        return -ENOMEM;
    }
    list->records = grown;
    list->capacity = more;
    return 0;
}

/* Appends bytes to the last record. Its old memory is wiped. */
static int extend(struct iso_gallery_access *record, const void *bytes, size_t size)
{
    uint8_t *longer = malloc(record->size + size);
    if (!longer) {
        return -ENOMEM;
    }
    if (record->size > 0) {
        memcpy(longer, record->bytes, record->size);
    }
    memcpy(longer + record->size, bytes, size);
    wipe(record->bytes, record->size);
    record->bytes = longer;
    record->size += size;
    record->parts++;
    return 0;
}

int iso_gallery_access_load(struct iso_gallery_access_list *list, int64_t person, uint32_t part,
                            const void *bytes, size_t size)
{
    struct iso_gallery_access *last = list->n > 0 ? &list->records[list->n - 1] : NULL;
    if (!last || last->person != person) {
        if (last && last->person > person) {
            return -EBADMSG;
        }
        if (iso_gallery_access_reserve(list, 1)) {
            return -ENOMEM;
        }
        last = &list->records[list->n++];
        *last = (struct iso_gallery_access){.person = person};
    }
    if (size == 0 || part != last->parts || size > ISO_GALLERY_ACCESS_MAX - last->size) {
        return -EBADMSG;
    }
    return extend(last, bytes, size);
}

void iso_gallery_access_put(struct iso_gallery_access_list *list, int64_t person, uint8_t *bytes,
                            size_t size)
{
    const size_t at = place_of(list, person);
    struct iso_gallery_access *record = &list->records[at];
    if (at < list->n && record->person == person) {
        wipe(record->bytes, record->size);
    } else {
        memmove(record + 1, record, (list->n - at) * sizeof *record);
        list->n++;
    }
    *record = (struct iso_gallery_access){.person = person, .bytes = bytes, .size = size};
}

void iso_gallery_access_remove(struct iso_gallery_access_list *list, int64_t person)
{
    const size_t at = place_of(list, person);
    if (at < list->n && list->records[at].person == person) {
        struct iso_gallery_access *record = &list->records[at];
        wipe(record->bytes, record->size);
        memmove(record, record + 1, (list->n - at - 1) * sizeof *record);
        list->n--;
    }
}

/* ---- of a gallery ---- */

const void *iso_gallery_access(const struct iso_gallery *gallery, int64_t person, size_t *size)
{
    const struct iso_gallery_access *record = iso__gallery_is_lost(gallery)
                                                  ? NULL
                                                  : iso_gallery_access_find(&gallery->memory.access,
                                                                            person);
    *size = record ? record->size : 0;
    return record ? record->bytes : NULL;
}

static int check(const struct iso_gallery *gallery, int64_t person, size_t size,
                 struct iso_fault *fault)
{
    if (person != ISO_GALLERY_SITE && person != ISO_GALLERY_FLEET &&
        !iso_gallery_find_id(gallery, person)) {
        return iso_fault_set(fault, -ENOENT, "no such person");
    }
    return size > ISO_GALLERY_ACCESS_MAX
               ? iso_fault_set(fault, -EFBIG, "an access record of %zu bytes; at most %d are kept",
                               size, ISO_GALLERY_ACCESS_MAX)
               : 0;
}

/* ---- a record that goes with another change ---- */

int iso_gallery_stage(struct iso_gallery *gallery, int64_t id, const void *bytes, size_t size,
                      struct iso_fault *fault)
{
    const int error = check(gallery, id, size, fault);
    if (error) {
        return error;
    }
    uint8_t *copy = size > 0 ? malloc(size) : NULL;
    if (size > 0 && !copy) {
        return iso_fault_set(fault, -ENOMEM, "gallery: out of memory");
    }
    if (size > 0) {
        memcpy(copy, bytes, size);
    }
    iso_gallery_unstage(gallery);
    gallery->staged = (struct iso_gallery_staged){true, id, copy, size};
    return 0;
}

void iso_gallery_unstage(struct iso_gallery *gallery)
{
    wipe(gallery->staged.bytes, gallery->staged.size);
    gallery->staged = (struct iso_gallery_staged){.on = false};
}

int iso__gallery_begin(struct iso_gallery *gallery, struct iso_fault *fault)
{
    if (gallery->staged.on && iso_gallery_access_reserve(&gallery->memory.access, 1)) {
        return iso_fault_set(fault, -ENOMEM, "gallery: out of memory");
    }
    return iso_gallery_db_begin(gallery->db, fault);
}

/* Gives the bytes of a stored record to the memory. */
static void keep(struct iso_gallery *gallery, int64_t id, uint8_t *bytes, size_t size)
{
    if (size > 0) {
        iso_gallery_access_put(&gallery->memory.access, id, bytes, size);
    } else {
        iso_gallery_access_remove(&gallery->memory.access, id);
    }
}

int iso__gallery_end(struct iso_gallery *gallery, int error, struct iso_fault *fault)
{
    struct iso_gallery_staged *staged = &gallery->staged;
    if (!error && staged->on) {
        error = iso_gallery_db_put_access(gallery->db, staged->id, staged->bytes, staged->size,
                                          fault);
    }
    error = iso_gallery_db_end(gallery->db, error, fault);
    if (!error && staged->on) {
        keep(gallery, staged->id, staged->bytes, staged->size);
        *staged = (struct iso_gallery_staged){.on = false};
    }
    return error;
}

/* ---- storing one ---- */

/* Ends the transaction first, and then changes the memory, which cannot fail. `copy` belongs to the
 * memory after success. */
static int put(struct iso_gallery *gallery, int64_t person, uint8_t *copy, size_t size,
               struct iso_fault *fault)
{
    int error = iso__gallery_begin(gallery, fault);
    if (error) {
        return error;
    }
    error = iso_gallery_db_put_access(gallery->db, person, copy, size, fault);
    error = iso__gallery_end(gallery, error, fault);
    if (!error) {
        keep(gallery, person, copy, size);
    }
    return error;
}

int iso_gallery_set_access(struct iso_gallery *gallery, int64_t person, const void *bytes,
                           size_t size, struct iso_fault *fault)
{
    int error = check(gallery, person, size, fault);
    if (error) {
        return error;
    }
    uint8_t *copy = size > 0 ? malloc(size) : NULL;
    /* One of the two places is for a staged record. */
    if ((size > 0 && !copy) || iso_gallery_access_reserve(&gallery->memory.access, 2)) {
        free(copy);
        return iso_fault_set(fault, -ENOMEM, "gallery: out of memory");
    }
    if (size > 0) {
        memcpy(copy, bytes, size);
    }
    error = put(gallery, person, copy, size, fault);
    if (error) {
        wipe(copy, size);
    }
    return error;
}
