/* A second writer of documents, for comparison: it draws one of the forms wherever a policy may be
 * written in several ways, such as the order of members and of dates, ranges of days, and members
 * that are as by default. */
#ifndef TESTS_FIRMWARE_POLICY_DOCUMENT_TEXT_H
#define TESTS_FIRMWARE_POLICY_DOCUMENT_TEXT_H

#include "firmware/policy/policy.h"

/* A random number below n; the same sequence in every run. */
uint32_t document_text_draw(uint32_t n);

/* Writes a valid policy. The caller frees the text. */
char *document_text_write(const struct iso_policy *policy, uint16_t default_profile);

#endif
