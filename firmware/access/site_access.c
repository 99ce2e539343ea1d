#include "firmware/access/site_access.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/bytes.h"
#include "core/base/fault.h"
#include "firmware/access/site_access_state.h"
#include "firmware/policy/occupancy.h"

/* The record of the site: format, revision, and the text of the document. */
enum { FORMAT = 1, HEAD_BYTES = 1 + 8 };

int iso_site_access_new(const struct iso_site_access_options *options, struct iso_site_access **out)
{
    struct iso_site_access *access = calloc(1, sizeof *access);
    if (!access) {
        return -ENOMEM;
    }
    access->options = *options;
    access->point = ISO_INDEX_NONE;
    *out = access;
    return 0;
}

void iso_site_access_free(struct iso_site_access *access)
{
    if (access) {
        iso_policy_document_free(access->document);
        free(access->presences);
        free(access);
    }
}

/* The access point of this door in a document: the configured one, or the only one. */
static int find_point(const struct iso_site_access *access,
                      const struct iso_policy_document *document, uint16_t *point,
                      struct iso_fault *fault)
{
    const char *token = access->options.access_point;
    const struct iso_policy *policy = iso_policy_document_policy(document);
    if (!*token) {
        *point = 0;
        return policy->n_access_points == 1
                   ? 0
                   : iso_fault_set(fault, -EINVAL,
                                   "the policy has %u access points: [policy] access_point has to "
                                   "name this door",
                                   policy->n_access_points);
    }
    *point = iso_policy_document_access_point(document, token);
    return *point == ISO_INDEX_NONE
               ? iso_fault_set(fault, -EINVAL,
                               "the policy has no access point \"%s\", which [policy] access_point "
                               "names",
                               token)
               : 0;
}

/* What is known about whereabouts refers to areas by their index, so it ends with the policy. */
static void adopt(struct iso_site_access *access, struct iso_policy_document *document,
                  uint64_t revision, uint16_t point)
{
    iso_policy_document_free(access->document);
    access->document = document;
    access->revision = revision;
    access->point = point;
    access->n_presences = 0;
}

int iso_site_access_load(struct iso_site_access *access, const struct iso_gallery *gallery)
{
    size_t size = 0;
    struct iso_policy_document *document = NULL;
    struct iso_fault why = {.text = ""};
    uint16_t point = ISO_INDEX_NONE;
    const uint8_t *bytes = iso_gallery_access(gallery, 0, &size);
    if (iso_gallery_state(gallery, &why)) {
        /* It is not known whether there is a policy. */
        access->has_policy = true;
        access->fault = why;
        adopt(access, NULL, 0, point);
        return 0;
    }
    if (!bytes) {
        access->has_policy = false;
        access->fault = why;
        adopt(access, NULL, 0, point);
        return 0;
    }
    int error = size < HEAD_BYTES || bytes[0] != FORMAT
                    ? iso_fault_set(&why, -EPROTONOSUPPORT,
                                    "the stored policy is of a newer version, or damaged")
                    : iso_policy_document_read((const char *)bytes + HEAD_BYTES, size - HEAD_BYTES,
                                               access->options.zones, &document, &why);
    if (!error) {
        error = find_point(access, document, &point, &why);
    }
    if (error == -ENOMEM) {
        return error;
    }
    if (error) {
        iso_policy_document_free(document);
        document = NULL;
    }
    access->has_policy = true;
    access->fault = why;
    adopt(access, document, size < HEAD_BYTES ? 0 : iso_get_u64(bytes + 1), point);
    return 0;
}

bool iso_site_access_has_policy(const struct iso_site_access *access)
{
    return access->has_policy;
}

const struct iso_fault *iso_site_access_fault(const struct iso_site_access *access)
{
    return &access->fault;
}

const struct iso_policy_document *iso_site_access_document(const struct iso_site_access *access)
{
    return access->document;
}

uint64_t iso_site_access_revision(const struct iso_site_access *access)
{
    return access->revision;
}

uint16_t iso_site_access_point(const struct iso_site_access *access)
{
    return access->point;
}

char *iso_site_access_text(const struct iso_gallery *gallery, size_t *size)
{
    const uint8_t *bytes = iso_gallery_access(gallery, 0, size);
    *size = bytes && *size >= HEAD_BYTES ? *size - HEAD_BYTES : 0;
    return *size > 0 ? strndup((const char *)bytes + HEAD_BYTES, *size) : strdup("");
}

/* ---- a policy that could be stored ---- */

/* Makes the record from the canonical text, so that the same policy is the same record. */
static int make_record(const struct iso_site_access *access, struct iso_site_policy *policy,
                       struct iso_fault *fault)
{
    char *text = NULL;
    const int error = iso_policy_document_write(policy->document, &text, fault);
    if (error) {
        return error;
    }
    const size_t length = strlen(text);
    policy->size = HEAD_BYTES + length;
    policy->bytes = malloc(policy->size);
    if (policy->bytes) {
        policy->bytes[0] = FORMAT;
        (void)iso_put_bytes(iso_put_u64(policy->bytes + 1, access->revision + 1), text, length);
    }
    free(text);
    if (!policy->bytes) {
        return iso_fault_set(fault, -ENOMEM, "policy: out of memory");
    }
    return policy->size > ISO_GALLERY_ACCESS_MAX
               ? iso_fault_set(fault, -EFBIG, "the policy is too long: %zu bytes of at most %d",
                               policy->size, ISO_GALLERY_ACCESS_MAX)
               : 0;
}

int iso_site_access_prepare(const struct iso_site_access *access, const char *json,
                            struct iso_site_policy *out, struct iso_fault *fault)
{
    struct iso_site_policy policy = {.document = NULL};
    uint16_t point = ISO_INDEX_NONE;
    if (!*json) {
        *out = policy;
        return 0;
    }
    int error = iso_policy_document_read(json, strlen(json), access->options.zones,
                                         &policy.document, fault);
    if (!error) {
        error = find_point(access, policy.document, &point, fault);
    }
    if (!error) {
        error = make_record(access, &policy, fault);
    }
    if (error) {
        iso_site_policy_free(&policy);
        return error;
    }
    *out = policy;
    return 0;
}

void iso_site_policy_free(struct iso_site_policy *policy)
{
    iso_policy_document_free(policy->document);
    free(policy->bytes);
    *policy = (struct iso_site_policy){0};
}

/* ---- who is where ---- */

static struct iso__site_presence *presence_of(const struct iso_site_access *access, int64_t person)
{
    for (size_t i = 0; i < access->n_presences; i++) {
        if (access->presences[i].person == person) {
            return &access->presences[i];
        }
    }
    return NULL;
}

static struct iso__site_presence *new_presence(struct iso_site_access *access, int64_t person)
{
    if (access->n_presences == access->presences_capacity) {
        const size_t more = access->presences_capacity ? 2 * access->presences_capacity : 16;
        void *grown = reallocarray(access->presences, more, sizeof *access->presences);
        if (!grown) {
            return NULL;
        }
        access->presences = grown;
        access->presences_capacity = more;
    }
    struct iso__site_presence *own = &access->presences[access->n_presences++];
    *own = (struct iso__site_presence){.person = person};
    return own;
}

int iso_site_access_enter(struct iso_site_access *access, int64_t person, int64_t time_s)
{
    if (!access->document) {
        return 0;
    }
    const struct iso_policy *policy = iso_policy_document_policy(access->document);
    struct iso__site_presence *own = presence_of(access, person);
    own = own ? own : new_presence(access, person);
    if (!own) {
        return -ENOMEM;
    }
    iso_presence_enter(&own->presence, &policy->access_points[access->point], time_s);
    return 0;
}

void iso_site_access_forget(struct iso_site_access *access, int64_t person)
{
    struct iso__site_presence *own = presence_of(access, person);
    if (own) {
        *own = access->presences[--access->n_presences];
    }
}

struct iso_presence iso__site_presence(const struct iso_site_access *access, int64_t person)
{
    const struct iso__site_presence *own = presence_of(access, person);
    return own ? own->presence : (struct iso_presence){.known = false};
}
