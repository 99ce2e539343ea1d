/* State that the tests of the decision share: one decision, its last verdict, and two people. */
#ifndef TESTS_FIRMWARE_VISIT_DECISION_RIG_H
#define TESTS_FIRMWARE_VISIT_DECISION_RIG_H

#include "drivers/base/times.h"
#include "firmware/visit/decision.h"

enum { ANNA = 7, BOB = 12 };

#define MS ISO_NS_PER_MS

extern struct iso_decision decision;
extern struct iso_verdict verdict;

/* cmocka set-up: a new decision, and a verdict that shows whether it was written. */
int decision_rig_setup(void **state);

/* Adds a usable face at this time. Returns true if a verdict followed. */
bool face(int64_t t_ms, int64_t person, double score, double second, bool valid);

/* Adds a frame with a cue of an attack. Returns true if a verdict followed. */
bool attack(int64_t t_ms, enum iso_capture cue);

#endif
