/* One enrolment with the faces of the puppets. Two faces agree if they differ by at most 6, and
 * they are duplicates if they differ by at most 4. */
#ifndef TESTS_FIRMWARE_RECOGNISE_ENROLMENT_RIG_H
#define TESTS_FIRMWARE_RECOGNISE_ENROLMENT_RIG_H

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/base/times.h"
#include "firmware/recognise/enrolment.h"
#include "tests/firmware/rigs/puppets.h"

/* Of the present test. */
extern struct iso_enrolment enrolment;
extern struct puppet_pipeline puppet;
extern struct iso_pipeline pipeline;
extern struct iso_enrolment_gallery gallery;
extern int64_t now_ns;

/* cmocka set-up: begins an enrolment of three frames, of the frontal face alone, at 5 s. */
int enrolment_rig_setup(void **state);

/* Adds a frame of that face. Returns whether it passed. */
bool frame(int face);

/* A gallery of the first n entries. */
struct iso_candidate_list first_of(const struct iso_search_entry *entries, int n);

#endif
