/* A policy as a table for people. */
#ifndef CLI_POLICY_POLICY_TEXT_H
#define CLI_POLICY_POLICY_TEXT_H

#include <stdio.h>

#include "firmware/policy/policy.h"

/* Prints doors, profiles, schedules and special days. `default_profile` is an index or
 * ISO_INDEX_NONE. */
void cli_policy_print(const struct iso_policy *policy, uint16_t default_profile, FILE *out);

/* Writes recognition methods (enum iso_recognition) as words, such as "card and PIN". */
enum { CLI_METHODS_SIZE = 32 };
void cli_policy_methods_text(unsigned methods, char text[CLI_METHODS_SIZE]);

#endif
