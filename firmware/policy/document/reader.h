/* Reads the members of a document, and writes a line for each member that is wrong. */
#ifndef ISO_FIRMWARE_POLICY_DOCUMENT_READER_H
#define ISO_FIRMWARE_POLICY_DOCUMENT_READER_H

#include <stdbool.h>

#include "firmware/policy/document/document.h"

struct iso__reader {
    struct iso_policy_document *document;
    const struct iso_zone_source *zones;
    json_t *indices[ISO__KINDS]; /* from a token to its index */
    struct iso_fault *fault;
    /* The record that is read, for lines of faults; words NULL: the document itself. */
    const char *words, *token; /* token NULL: not known yet, `number` counts */
    size_t number;             /* from 1 */
};

/* Returns -EINVAL with a line that names the record. The texts in it are made fit for a line: see
 * iso__reader_clean(). */
int iso__reader_refuse(const struct iso__reader *reader, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Returns -ENOMEM with its line. */
int iso__reader_no_memory(const struct iso__reader *reader);

/* How many bytes of a text a line quotes, for "%.*s": the whole text, or whole characters of its
 * beginning. 0 for NULL. */
int iso__quoted(const char *text);

/* Makes the text of a fault one line of UTF-8: control characters become '?', and a character that
 * was cut at the end goes. */
void iso__reader_clean(struct iso_fault *fault);

/* Whether the value is an object that has only members of the list, which ends with NULL. `what`
 * names the value. */
int iso__reader_members(const struct iso__reader *reader, const char *what, const json_t *value,
                        const char *const *members);

/* These read a member of an object. A member that does not exist leaves *out as it was. Return 0,
 * or -EINVAL for a value of another type. */
int iso__reader_text(const struct iso__reader *reader, const json_t *object, const char *member,
                     const char **out);
int iso__reader_truth(const struct iso__reader *reader, const json_t *object, const char *member,
                      bool *out);
int iso__reader_number(const struct iso__reader *reader, const json_t *object, const char *member,
                       int32_t *out);
int iso__reader_list(const struct iso__reader *reader, const json_t *object, const char *member,
                     size_t max, const json_t **out);

/* The token of another record, as its index. `required`: refuses an object without the member. */
int iso__reader_reference(const struct iso__reader *reader, const json_t *object,
                          const char *member, enum iso__kind_id kind, bool required, uint16_t *out);

#endif
