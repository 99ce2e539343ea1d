/* The filters and paths of SCIM (RFC 7644, sections 3.4.2.2 and 3.5.2) which identity providers
 * send: comparisons with "eq", joined by "and". Pure.
 *
 *   filter   userName eq "ada@example.org" and active eq true
 *   path     name.givenName, members, members[value eq "0190..."], emails[type eq "work"].value
 *
 * Names of attributes are the same in capital and small letters; they are read in small ones,
 * without the URN of the core schemas. */
#ifndef ENROLL_HUB_SCIM_SCIM_FILTER_H
#define ENROLL_HUB_SCIM_SCIM_FILTER_H

#include <stddef.h>

#include "core/base/fault.h"

enum { SCIM_TEXT_SIZE = 257, SCIM_TERMS_MOST = 4 };

struct scim_term {
    char attribute[SCIM_TEXT_SIZE];
    char value[SCIM_TEXT_SIZE]; /* a text without its quotes, or the word of another value */
};

/* All terms have to hold. */
struct scim_filter {
    size_t n;
    struct scim_term terms[SCIM_TERMS_MOST];
};

struct scim_path {
    char attribute[SCIM_TEXT_SIZE]; /* with its sub-attribute: "name.givenname" */
    struct scim_filter filter;      /* of its values; no terms: none */
};

/* Copies the name of an attribute as it is compared. -ENAMETOOLONG. */
int scim_attribute_take(const char *name, size_t length, char out[SCIM_TEXT_SIZE])
    __attribute__((warn_unused_result));

/* -EDOM it is no such filter. */
int scim_filter_read(const char *text, struct scim_filter *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* -ENXIO it is no such path. */
int scim_path_read(const char *text, struct scim_path *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
