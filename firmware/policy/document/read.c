#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/fault.h"
#include "firmware/policy/document/reader.h"
#include "firmware/policy/validate.h"

/* ---- the text ---- */

/* Whether arrays and objects are nested too deep. It is checked before the text is parsed, because
 * the parser calls itself. */
static bool is_too_deep(const char *json, size_t size)
{
    int depth = 0;
    bool in_string = false;
    for (size_t i = 0; i < size; i++) {
        const char c = json[i];
        if (in_string) {
            i += c == '\\';
            in_string = c != '"';
        } else if (c == '"') {
            in_string = true;
        } else if (c == '[' || c == '{') {
            depth++;
        } else if (c == ']' || c == '}') {
            depth--;
        }
        if (depth > ISO_POLICY_DOCUMENT_MAX_DEPTH) {
            return true;
        }
    }
    return false;
}

/* Jansson 2.14 leaves out a character, or reports an error of the syntax, when memory runs out
 * within a text. So the text is parsed twice, and memory has run out unless both times are the
 * same. */
static int parse_twice(const struct iso__reader *reader, const char *json, size_t size,
                       json_t **out)
{
    json_error_t error = {.line = 0}, again = {.line = 0};
    json_t *first = json_loadb(json, size, JSON_REJECT_DUPLICATES, &error);
    json_t *second = json_loadb(json, size, JSON_REJECT_DUPLICATES, &again);
    const bool is_wrong = !first && !second && error.text[0] &&
                          json_error_code(&error) != json_error_out_of_memory &&
                          strcmp(error.text, again.text) == 0;
    const bool is_right = first && second && json_equal(first, second);
    json_decref(second);
    if (is_right) {
        *out = first;
        return 0;
    }
    json_decref(first);
    return is_wrong ? iso__reader_refuse(reader, "line %d, column %d: %s", error.line, error.column,
                                         error.text)
                    : iso__reader_no_memory(reader);
}

static int parse(const struct iso__reader *reader, const char *json, size_t size, json_t **out)
{
    if (size > ISO_POLICY_DOCUMENT_MAX_BYTES) {
        return iso__reader_refuse(reader, "has %zu bytes, at most %d", size,
                                  ISO_POLICY_DOCUMENT_MAX_BYTES);
    }
    if (is_too_deep(json, size)) {
        return iso__reader_refuse(reader, "has more than %d arrays and objects within each other",
                                  ISO_POLICY_DOCUMENT_MAX_DEPTH);
    }
    return parse_twice(reader, json, size, out);
}

static int check_members(const struct iso__reader *reader, const json_t *root)
{
    const char *members[ISO__KINDS + 2] = {NULL};
    for (enum iso__kind_id kind = ISO__GROUP; kind < ISO__KINDS; kind++) {
        members[kind] = iso__kinds[kind].array;
    }
    members[ISO__KINDS] = "default_profile";
    return iso__reader_members(reader, "the document", root, members);
}

/* ---- tokens ---- */

static bool has_control(const char *text)
{
    for (const unsigned char *c = (const unsigned char *)text; *c; c++) {
        if (*c < 0x20 || *c == 0x7f || (*c == 0xc2 && c[1] < 0xa0)) {
            return true;
        }
    }
    return false;
}

/* Adds the token to the index of its kind. */
static int add_token(struct iso__reader *reader, enum iso__kind_id kind, const char *token)
{
    struct iso_policy_document *document = reader->document;
    char *record = (char *)document->records[kind] + document->n[kind] * iso__kinds[kind].size;
    if (json_object_set_new(reader->indices[kind], token, json_integer(document->n[kind])) != 0) {
        return iso__reader_no_memory(reader);
    }
    memcpy(record, token, strlen(token) + 1); /* a record begins with its token; it fits */
    document->n[kind]++;
    return 0;
}

static int read_token(struct iso__reader *reader, enum iso__kind_id kind, const json_t *object)
{
    const char *token = NULL;
    reader->token = NULL;
    int error = json_is_object(object) ? 0 : iso__reader_refuse(reader, "is not an object");
    error = error != 0 ? error : iso__reader_text(reader, object, "token", &token);
    if (error != 0) {
        return error;
    }
    if (!token || !token[0]) {
        return iso__reader_refuse(reader, "has no token");
    }
    if (strlen(token) >= ISO_TOKEN_SIZE) {
        return iso__reader_refuse(reader, "the token has more than %d bytes", ISO_TOKEN_SIZE - 1);
    }
    if (has_control(token)) {
        return iso__reader_refuse(reader, "the token has a control character");
    }
    if (json_object_get(reader->indices[kind], token)) {
        return iso__reader_refuse(reader, "the token \"%s\" is used twice", token);
    }
    return add_token(reader, kind, token);
}

/* Reads the tokens of one kind, so that records can refer to later ones. */
static int read_tokens(struct iso__reader *reader, enum iso__kind_id kind, const json_t *root)
{
    const json_t *list = NULL;
    reader->words = NULL;
    int error = iso__reader_list(reader, root, iso__kinds[kind].array,
                                 ISO_POLICY_DOCUMENT_MAX_RECORDS, &list);
    if (error != 0) {
        return error;
    }
    reader->words = iso__kinds[kind].words;
    reader->indices[kind] = json_object();
    /* One more: the reader may add a profile and its level. */
    reader->document->records[kind] = calloc(json_array_size(list) + 1, iso__kinds[kind].size);
    if (!reader->indices[kind] || !reader->document->records[kind]) {
        return iso__reader_no_memory(reader);
    }
    size_t i;
    json_t *object;
    json_array_foreach(list, i, object)
    {
        reader->number = i + 1;
        error = error != 0 ? error : read_token(reader, kind, object);
    }
    return error;
}

/* ---- the profile of access points that name none ---- */

/* Adds the token unless the document has it. *added becomes its index, or none. */
static int add_face(struct iso__reader *reader, enum iso__kind_id kind, uint16_t *added)
{
    *added = ISO_INDEX_NONE;
    if (json_object_get(reader->indices[kind], iso__face_token)) {
        return 0;
    }
    *added = reader->document->n[kind];
    return add_token(reader, kind, iso__face_token);
}

static bool needs_face_profile(const json_t *root)
{
    size_t i;
    json_t *point;
    json_array_foreach(json_object_get(root, iso__kinds[ISO__POINT].array), i, point)
    {
        if (!json_object_get(point, "authentication_profile")) {
            return true;
        }
    }
    return false;
}

static bool has_priority(const struct iso_security_level *levels, uint16_t n, int32_t priority)
{
    for (uint16_t i = 0; i < n; i++) {
        if (levels[i].priority == priority) {
            return true;
        }
    }
    return false;
}

/* The two records that the document does not have; none: it has it. */
static void complete_face(struct iso_policy_document *document, uint16_t level, uint16_t profile)
{
    struct iso_security_level *levels = document->records[ISO__LEVEL];
    struct iso_authentication_profile *profiles = document->records[ISO__AUTHENTICATION];
    if (level != ISO_INDEX_NONE) {
        int32_t priority = 0;
        while (has_priority(levels, level, priority)) {
            priority++;
        }
        levels[level].priority = priority;
        levels[level].n_groups = 1;
        levels[level].groups[0] = ISO_RECOGNITION_FACE;
    }
    if (profile != ISO_INDEX_NONE) {
        profiles[profile].default_level = iso__document_find(document, ISO__LEVEL, iso__face_token);
    }
}

/* ---- all of it ---- */

static int read_records(struct iso__reader *reader, enum iso__kind_id kind, const json_t *root)
{
    size_t i;
    json_t *object;
    int error = 0;
    json_array_foreach(json_object_get(root, iso__kinds[kind].array), i, object)
    {
        if (error == 0) {
            reader->words = iso__kinds[kind].words;
            reader->token = iso__document_token(reader->document, kind, (uint16_t)i);
            reader->number = i + 1;
            error = iso__reader_members(reader, "it", object, iso__kinds[kind].members);
        }
        if (error == 0) {
            error = iso__kinds[kind].read(reader, object,
                                          (char *)reader->document->records[kind] +
                                              i * iso__kinds[kind].size);
        }
    }
    return error;
}

static void point_to_arrays(struct iso_policy_document *document)
{
    struct iso_policy *policy = &document->policy;
    policy->zones = document->zones;
    policy->groups = document->records[ISO__GROUP];
    policy->schedules = document->records[ISO__SCHEDULE];
    policy->areas = document->records[ISO__AREA];
    policy->levels = document->records[ISO__LEVEL];
    policy->authentication_profiles = document->records[ISO__AUTHENTICATION];
    policy->access_points = document->records[ISO__POINT];
    policy->access_profiles = document->records[ISO__PROFILE];
    policy->n_groups = document->n[ISO__GROUP];
    policy->n_schedules = document->n[ISO__SCHEDULE];
    policy->n_areas = document->n[ISO__AREA];
    policy->n_levels = document->n[ISO__LEVEL];
    policy->n_authentication_profiles = document->n[ISO__AUTHENTICATION];
    policy->n_access_points = document->n[ISO__POINT];
    policy->n_access_profiles = document->n[ISO__PROFILE];
}

static int read_root(struct iso__reader *reader, const json_t *root)
{
    uint16_t level = ISO_INDEX_NONE, profile = ISO_INDEX_NONE;
    int error = check_members(reader, root);
    for (enum iso__kind_id kind = ISO__GROUP; error == 0 && kind < ISO__KINDS; kind++) {
        error = read_tokens(reader, kind, root);
    }
    if (error == 0 && needs_face_profile(root)) {
        error = add_face(reader, ISO__AUTHENTICATION, &profile);
        error = error != 0 || profile == ISO_INDEX_NONE ? error
                                                        : add_face(reader, ISO__LEVEL, &level);
    }
    for (enum iso__kind_id kind = ISO__GROUP; error == 0 && kind < ISO__KINDS; kind++) {
        error = read_records(reader, kind, root);
    }
    if (error != 0) {
        return error;
    }
    complete_face(reader->document, level, profile);
    reader->words = NULL;
    reader->document->default_profile = ISO_INDEX_NONE;
    error = iso__reader_reference(reader, root, "default_profile", ISO__PROFILE, false,
                                  &reader->document->default_profile);
    if (error != 0) {
        return error;
    }
    point_to_arrays(reader->document);
    error = iso_policy_validate(&reader->document->policy, reader->fault);
    if (error != 0) {
        iso__reader_clean(reader->fault);
    }
    return error;
}

int iso_policy_document_read(const char *json, size_t size, const struct iso_zone_source *zones,
                             struct iso_policy_document **out, struct iso_fault *fault)
{
    struct iso_fault unused;
    struct iso__reader reader = {.document = calloc(1, sizeof *reader.document),
                                 .zones = zones,
                                 .fault = fault ? fault : &unused};
    json_t *root = NULL;
    int error = reader.document ? 0 : iso__reader_no_memory(&reader);
    error = error != 0 ? error : parse(&reader, json, size, &root);
    error = error != 0 ? error : read_root(&reader, root);
    for (enum iso__kind_id kind = ISO__GROUP; kind < ISO__KINDS; kind++) {
        json_decref(reader.indices[kind]);
    }
    json_decref(root);
    if (error != 0) {
        iso_policy_document_free(reader.document);
        return error;
    }
    *out = reader.document;
    return 0;
}
