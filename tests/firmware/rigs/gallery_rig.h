/* What the tests of the gallery share: g.db in a directory of the test's. */
#ifndef TESTS_FIRMWARE_RIGS_GALLERY_RIG_H
#define TESTS_FIRMWARE_RIGS_GALLERY_RIG_H

#include "firmware/gallery/gallery.h"
#include "tests/firmware/rigs/stores.h"

/* How many people a gallery that is opened from here on may hold; 3 at first. */
extern int gallery_rig_capacity;

int gallery_rig_try_open(const char *directory, struct iso_gallery **out, struct iso_fault *fault);

/* The same; a failure fails the test. */
struct iso_gallery *gallery_rig_open(const char *directory);

/* A person who was enrolled 1000 + face seconds after 1970, and may come in until then or (0) for
 * good. */
int gallery_rig_add_until(struct iso_gallery *gallery, const char *name, int face,
                          int64_t valid_until_s, struct iso_fault *fault);
int gallery_rig_add(struct iso_gallery *gallery, const char *name, int face,
                    struct iso_fault *fault);

/* "person NUMBER", with the face of this number; or so many of them, the first with number 0, in a
 * gallery that is closed then. */
int gallery_rig_add_number(struct iso_gallery *gallery, int number, struct iso_fault *fault);
void gallery_rig_make(const char *directory, int people);

/* That a person is there, with so many templates, all of them usable. */
void gallery_rig_expect(struct iso_gallery *gallery, const char *name, unsigned templates);

/* Executes SQL in g.db, past the gallery. */
void gallery_rig_execute(const char *directory, const char *sql);

#endif
