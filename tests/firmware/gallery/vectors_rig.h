/* A gallery of many people for the tests of stored vectors (firmware/gallery/rows/
 * gallery_vector_rows.c). */
#ifndef ISO_TESTS_FIRMWARE_GALLERY_VECTORS_RIG_H
#define ISO_TESTS_FIRMWARE_GALLERY_VECTORS_RIG_H

#include "firmware/gallery/gallery.h"

enum {
    VECTORS_RIG_PEOPLE = 120, /* a start stores the vectors of so many people */
    VECTORS_RIG_DIMENSIONS = 5,
};

/* Counts the templates that are read, and those of which it is asked whether they were learned: the
 * linker puts functions of the rig in place of iso_template_parse and iso_template_check. */
extern int vectors_rig_n_parsed, vectors_rig_n_checked;

struct vectors_rig {
    char *directory;
    struct iso_metric *metric; /* the caller frees it */
    struct iso_gallery_options options;
};

struct vectors_rig vectors_rig_new(void **state);

/* Opens the gallery; n_parsed counts from here. */
struct iso_gallery *vectors_rig_open(const struct vectors_rig *world);

/* Imports "person 0" and so on; the template of each has the person's number as its face. */
void vectors_rig_enroll(const struct vectors_rig *world);

/* The same, and a start that stores their vectors. */
void vectors_rig_store(const struct vectors_rig *world);

/* Expects the vector of person `number`, to the bit: of the own face, and of `second` if it is not
 * negative. */
void vectors_rig_expect_vector(struct iso_gallery *gallery, const struct vectors_rig *world,
                               int number, int second);

void vectors_rig_expect_everybody(struct iso_gallery *gallery, const struct vectors_rig *world);

/* Opens and closes the gallery, and expects that it reads this number of templates. */
void vectors_rig_expect_start(const struct vectors_rig *world, int parsed);

/* A number that a query of g.db gives. */
int vectors_rig_ask(const struct vectors_rig *world, const char *sql);

#endif
