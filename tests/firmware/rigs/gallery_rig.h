/* Functions that the tests of the gallery share. The gallery is g.db in a directory of the test. */
#ifndef TESTS_FIRMWARE_RIGS_GALLERY_RIG_H
#define TESTS_FIRMWARE_RIGS_GALLERY_RIG_H

#include "firmware/gallery/gallery.h"
#include "tests/firmware/rigs/stores.h"

/* The capacity, in people, of the galleries that are opened from now on; 3 at first. */
extern int gallery_rig_capacity;

int gallery_rig_try_open(const char *directory, struct iso_gallery **out, struct iso_fault *fault);

/* Like gallery_rig_try_open, but a failure fails the test. */
struct iso_gallery *gallery_rig_open(const char *directory);

/* Adds a person who was enrolled 1000 + face seconds after 1970, and who is valid until
 * valid_until_s, or without limit (0). */
int gallery_rig_add_until(struct iso_gallery *gallery, const char *name, int face,
                          int64_t valid_until_s, struct iso_fault *fault);
int gallery_rig_add(struct iso_gallery *gallery, const char *name, int face,
                    struct iso_fault *fault);

/* gallery_rig_add_number adds "person NUMBER" with the face of this number. gallery_rig_make makes
 * a gallery with so many of them, from number 0, and closes it. */
int gallery_rig_add_number(struct iso_gallery *gallery, int number, struct iso_fault *fault);
void gallery_rig_make(const char *directory, int people);

/* Asserts that the gallery has this person with so many templates, and that all of them are usable.
 */
void gallery_rig_expect(struct iso_gallery *gallery, const char *name, unsigned templates);

/* Executes SQL on g.db directly, without the gallery. */
void gallery_rig_execute(const char *directory, const char *sql);

#endif
