/* What the tests of the policy at the door share. The clock of the rig shows Saturday, 2026-11-21,
 * 08:33:20 UTC; anna and ben are enrolled. */
#ifndef TESTS_FIRMWARE_APPLIANCE_ACCESS_RIG_H
#define TESTS_FIRMWARE_APPLIANCE_ACCESS_RIG_H

#include "firmware/appliance/administration/administration.h"
#include "tests/firmware/rigs/rig.h"

enum { ACCESS_ANNA = 20, ACCESS_BEN = 40, ACCESS_STRANGER = 70 };

/* A policy that lets staff in at any time, at the only access point "front": the members of its
 * security level, two people or one, and further members of the access point (", ..." or ""). Valid
 * until the next call. */
const char *access_rig_always(const char *level, bool two_people, const char *members);

/* Stores a policy, and returns its revision; or changes a credential. A failure fails the test. */
uint64_t access_rig_set_policy(struct rig *rig, const char *json);
void access_rig_set_credential(struct rig *rig, const char *person, const char *patch);

/* Enrols both, starts the appliance, and stores a policy, if it is not "". */
void access_rig_start(struct rig *rig, const char *policy);

/* Ends the appliance and starts it again with the same stores. */
void access_rig_restart(struct rig *rig);

/* Somebody stands before the door for a moment. */
void access_rig_look(struct rig *rig, int face);

/* The same; then nobody is there for a while, so that the next visit begins anew. Asserts that the
 * reports contain this part. */
void access_rig_expect_visit(struct rig *rig, int face, const char *part);

/* Asserts that a text contains a part. */
void access_rig_expect(const char *text, const char *part);

/* Somebody shows a card, as credential_record.h writes it, or types keys. */
void access_rig_show_card(struct rig *rig, const char *card);
void access_rig_type(struct rig *rig, const char *keys);

#endif
