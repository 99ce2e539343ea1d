/* Documents for tests, with zones that need no file. */
#ifndef TESTS_FIRMWARE_POLICY_DOCUMENT_RIG_H
#define TESTS_FIRMWARE_POLICY_DOCUMENT_RIG_H

#include "firmware/policy/document/policy_document.h"

/* A source that has the zones "UTC", "Test/East" (an hour before UTC) and "Test/West" (two hours
 * behind), that has no memory for "Test/Memory", and that refuses all others. */
extern const struct iso_zone_source document_rig_zones;

/* Reads a document that is right. Fails the test if it is refused. */
struct iso_policy_document *document_rig_read(const char *json);

/* Writes a document. The caller frees the text. */
char *document_rig_write(const struct iso_policy_document *document);

/* Fails the test unless both policies are the same, record by record. */
void document_rig_assert_equal(const struct iso_policy *a, const struct iso_policy *b);

#endif
