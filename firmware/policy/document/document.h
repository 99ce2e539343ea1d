/* What the files of this folder share: the document, and the table of the kinds of records. */
#ifndef ISO_FIRMWARE_POLICY_DOCUMENT_DOCUMENT_H
#define ISO_FIRMWARE_POLICY_DOCUMENT_DOCUMENT_H

#include <jansson.h>

#include "firmware/policy/document/policy_document.h"

/* In the order of the document. */
enum iso__kind_id {
    ISO__GROUP,
    ISO__SCHEDULE,
    ISO__AREA,
    ISO__LEVEL,
    ISO__AUTHENTICATION,
    ISO__POINT,
    ISO__PROFILE,
    ISO__KINDS
};

/* The array `records[k]` has n[k] records of the size of their kind. Each record begins with its
 * token. */
struct iso_policy_document {
    struct iso_policy policy; /* points to the arrays below */
    void *records[ISO__KINDS];
    uint16_t n[ISO__KINDS];
    struct iso_zone *zones;
    uint16_t default_profile; /* or none */
};

struct iso__reader;

/* A kind of record. */
struct iso__kind {
    const char *array;                /* the member of the document */
    const char *name;                 /* for programs */
    const char *words;                /* for the lines of faults */
    size_t size;                      /* of a record */
    const char *const *members;       /* of a record; ends with NULL */
    int (*read)(struct iso__reader *, /* fills in all of *record but the token */
                const json_t *object, void *record);
    /* Adds all members but the token. Returns 0, or -1 without memory. */
    int (*write)(const struct iso_policy *policy, const void *record, json_t *object);
};

extern const struct iso__kind iso__kinds[ISO__KINDS];

/* The token of a record. */
const char *iso__document_token(const struct iso_policy_document *document, enum iso__kind_id kind,
                                uint16_t index);

/* The index of a token, or ISO_INDEX_NONE. */
uint16_t iso__document_find(const struct iso_policy_document *document, enum iso__kind_id kind,
                            const char *token);

/* The record as a new JSON object, or NULL without memory. */
json_t *iso__document_record(const struct iso_policy_document *document, enum iso__kind_id kind,
                             uint16_t index);

/* The value as compact text, which the caller frees, or NULL without memory. Not json_dumps(),
 * which in Jansson 2.14 leaves out a key when memory runs out. */
char *iso__document_dump(const json_t *value);

/* The functions of iso__kinds. */
int iso__read_group(struct iso__reader *reader, const json_t *object, void *record);
int iso__read_schedule(struct iso__reader *reader, const json_t *object, void *record);
int iso__read_area(struct iso__reader *reader, const json_t *object, void *record);
int iso__read_level(struct iso__reader *reader, const json_t *object, void *record);
int iso__read_authentication(struct iso__reader *reader, const json_t *object, void *record);
int iso__read_point(struct iso__reader *reader, const json_t *object, void *record);
int iso__read_profile(struct iso__reader *reader, const json_t *object, void *record);
int iso__write_group(const struct iso_policy *policy, const void *record, json_t *object);
int iso__write_schedule(const struct iso_policy *policy, const void *record, json_t *object);
int iso__write_area(const struct iso_policy *policy, const void *record, json_t *object);
int iso__write_level(const struct iso_policy *policy, const void *record, json_t *object);
int iso__write_authentication(const struct iso_policy *policy, const void *record, json_t *object);
int iso__write_point(const struct iso_policy *policy, const void *record, json_t *object);
int iso__write_profile(const struct iso_policy *policy, const void *record, json_t *object);

/* The token of the authentication profile of an access point that names none, and of its level. */
extern const char iso__face_token[];

/* Words of the format, in the order of the bits or values of policy.h. */
extern const char *const iso__method_words[3];
extern const char *const iso__antipassback_words[4];
extern const char *const iso__state_words[ISO_SCHEDULE_STATES];

#endif
