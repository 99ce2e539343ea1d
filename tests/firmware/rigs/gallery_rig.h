/* Functions that the tests of the gallery share. The gallery is g.db in a directory of the test. */
#ifndef TESTS_FIRMWARE_RIGS_GALLERY_RIG_H
#define TESTS_FIRMWARE_RIGS_GALLERY_RIG_H

#include "firmware/gallery/gallery.h"
#include "tests/firmware/rigs/stores.h"

/* The capacity, in people, of the galleries that are opened from now on; 3 at first. */
extern int gallery_rig_capacity;

/* Opens the gallery of the directory with this capacity; the errors of iso_gallery_open. */
int gallery_rig_try_open(const char *directory, struct iso_gallery **out, struct iso_fault *fault);

/* Like gallery_rig_try_open, but a failure fails the test. */
struct iso_gallery *gallery_rig_open(const char *directory);

/* Adds a person with the template that belongs to the number `face`. The time of enrolment is
 * 1000 + face seconds after 1970. The person is valid until valid_until_s; 0 means without limit.
 * gallery_rig_add adds a person without a limit. */
int gallery_rig_add_until(struct iso_gallery *gallery, const char *name, int face,
                          int64_t valid_until_s, struct iso_fault *fault);
int gallery_rig_add(struct iso_gallery *gallery, const char *name, int face,
                    struct iso_fault *fault);

/* Adds a person whose name is "person NUMBER" and whose face has the same number. */
int gallery_rig_add_number(struct iso_gallery *gallery, int number, struct iso_fault *fault);

/* Creates the gallery of the directory, adds the people 0 to people - 1, and closes it. */
void gallery_rig_make(const char *directory, int people);

/* Asserts that the gallery has this person, that the person has this number of templates, and that
 * all templates are usable. */
void gallery_rig_expect(struct iso_gallery *gallery, const char *name, unsigned templates);

/* Executes SQL on g.db directly, without the gallery. */
void gallery_rig_execute(const char *directory, const char *sql);

/* Makes a metric of five dimensions for the templates of the puppets. The caller releases it with
 * iso_metric_free(). */
struct iso_metric *gallery_rig_new_metric(void);

#endif
