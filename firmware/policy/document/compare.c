#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "firmware/policy/document/document.h"

struct comparison {
    int (*each)(void *context, const char *kind, const char *token, const char *before_json,
                const char *after_json);
    void *context;
};

/* The record as text, which the caller frees; an empty text for none. NULL: no memory. */
static char *record_text(const struct iso_policy_document *document, enum iso__kind_id kind,
                         uint16_t index)
{
    if (index == ISO_INDEX_NONE) {
        return strdup("");
    }
    json_t *record = iso__document_record(document, kind, index);
    char *text = record ? iso__document_dump(record) : NULL;
    json_decref(record);
    return text;
}

/* Takes over both texts. */
static int report(const struct comparison *comparison, const char *kind, const char *token,
                  char *before, char *after)
{
    int result = before && after ? 0 : -ENOMEM;
    if (result == 0 && strcmp(before, after) != 0) {
        result = comparison->each(comparison->context, kind, token, before, after);
    }
    free(before);
    free(after);
    return result;
}

/* From tokens to indices, so that large documents are compared in short time. */
static json_t *index_tokens(const struct iso_policy_document *document, enum iso__kind_id kind)
{
    json_t *indices = json_object();
    for (uint16_t i = 0; indices && document && i < document->n[kind]; i++) {
        if (json_object_set_new(indices, iso__document_token(document, kind, i), json_integer(i)) !=
            0) {
            json_decref(indices);
            indices = NULL;
        }
    }
    return indices;
}

static uint16_t index_of(const json_t *indices, const char *token)
{
    const json_t *index = json_object_get(indices, token);
    return index ? (uint16_t)json_integer_value(index) : ISO_INDEX_NONE;
}

static int compare_kind(const struct iso_policy_document *before,
                        const struct iso_policy_document *after, enum iso__kind_id kind,
                        const struct comparison *comparison)
{
    json_t *of_before = index_tokens(before, kind), *of_after = index_tokens(after, kind);
    int result = of_before && of_after ? 0 : -ENOMEM;
    for (uint16_t i = 0; result == 0 && before && i < before->n[kind]; i++) {
        const char *token = iso__document_token(before, kind, i);
        result = report(comparison, iso__kinds[kind].name, token, record_text(before, kind, i),
                        record_text(after, kind, index_of(of_after, token)));
    }
    for (uint16_t i = 0; result == 0 && after && i < after->n[kind]; i++) {
        const char *token = iso__document_token(after, kind, i);
        if (index_of(of_before, token) == ISO_INDEX_NONE) {
            result = report(comparison, iso__kinds[kind].name, token, strdup(""),
                            record_text(after, kind, i));
        }
    }
    json_decref(of_before);
    json_decref(of_after);
    return result;
}

static char *default_text(const struct iso_policy_document *document)
{
    if (!document || document->default_profile == ISO_INDEX_NONE) {
        return strdup("");
    }
    json_t *token = json_string(
        iso__document_token(document, ISO__PROFILE, document->default_profile));
    char *text = token ? iso__document_dump(token) : NULL;
    json_decref(token);
    return text;
}

int iso_policy_document_compare(const struct iso_policy_document *before,
                                const struct iso_policy_document *after,
                                int (*each)(void *context, const char *kind, const char *token,
                                            const char *before_json, const char *after_json),
                                void *context)
{
    const struct comparison comparison = {each, context};
    int result = 0;
    for (enum iso__kind_id kind = ISO__GROUP; result == 0 && kind < ISO__KINDS; kind++) {
        result = compare_kind(before, after, kind, &comparison);
    }
    return result != 0 ? result
                       : report(&comparison, "default_profile", "", default_text(before),
                                default_text(after));
}
