#include "firmware/gallery/gallery_seal.h"

#include <errno.h>
#include <string.h>

#include "core/base/bytes.h"

struct iso_gallery_seal iso_gallery_seal_of(const uint8_t gallery[ISO_GALLERY_ID_BYTES],
                                            uint32_t key_number, const struct iso_seal_key *key)
{
    struct iso_gallery_seal seal = {
        .key_number = key_number,
        .key = iso_seal_key_derive(key, 1, "isogalry"),
        .digest_key = iso_seal_key_derive(key, 2, "isogalry"),
    };
    memcpy(seal.gallery, gallery, sizeof seal.gallery);
    return seal;
}

void iso_gallery_seal_wipe(struct iso_gallery_seal *seal)
{
    iso_seal_key_wipe(&seal->key);
    iso_seal_key_wipe(&seal->digest_key);
}

static struct iso_seal_label label_of(const struct iso_gallery_seal *seal, const char *kind)
{
    struct iso_seal_label label = iso_seal_label_of(kind);
    iso_seal_label_bytes(&label, seal->gallery, sizeof seal->gallery);
    iso_seal_label_number(&label, seal->key_number);
    return label;
}

static struct iso_seal_label record_label(const struct iso_gallery_seal *seal,
                                          const struct iso_gallery_place *place)
{
    static const char *const kinds[] = {
        [ISO_GALLERY_PERSON] = "isotherm gallery person 1",
        [ISO_GALLERY_TEMPLATE] = "isotherm gallery template 1",
        [ISO_GALLERY_ACCESS] = "isotherm gallery access 1",
    };
    struct iso_seal_label label = label_of(seal, kinds[place->kind]);
    iso_seal_label_number(&label, (uint64_t)place->number);
    iso_seal_label_number(&label, (uint64_t)place->person);
    iso_seal_label_number(&label, place->algorithm);
    return label;
}

void iso_gallery_record_close(const struct iso_gallery_seal *seal,
                              const struct iso_gallery_place *place, const void *plain, size_t size,
                              uint8_t *sealed)
{
    const struct iso_seal_label label = record_label(seal, place);
    iso_seal_close(&seal->key, &label, plain, size, sealed);
}

int iso_gallery_record_open(const struct iso_gallery_seal *seal,
                            const struct iso_gallery_place *place, const void *sealed, size_t size,
                            void *plain)
{
    const struct iso_seal_label label = record_label(seal, place);
    return iso_seal_open(&seal->key, &label, sealed, size, plain);
}

void iso_gallery_record_toggle(const struct iso_gallery_seal *seal,
                               const struct iso_gallery_place *place, const void *sealed,
                               size_t size, uint8_t digest[ISO_SEAL_DIGEST_BYTES])
{
    const struct iso_seal_label label = record_label(seal, place);
    uint8_t own[ISO_SEAL_DIGEST_BYTES];
    iso_seal_digest(&seal->digest_key, &label, sealed, size, own);
    for (size_t i = 0; i < sizeof own; i++) {
        digest[i] ^= own[i];
    }
}

/* The number at the end of the kind counts the ways in which programs have made vectors. */
static struct iso_seal_label vector_label(const struct iso_gallery_seal *seal,
                                          const uint8_t record[ISO_SEAL_DIGEST_BYTES],
                                          const uint8_t metric[ISO_SEAL_DIGEST_BYTES])
{
    struct iso_seal_label label = label_of(seal, "isotherm gallery vector 2");
    iso_seal_label_bytes(&label, record, ISO_SEAL_DIGEST_BYTES);
    iso_seal_label_bytes(&label, metric, ISO_SEAL_DIGEST_BYTES);
    return label;
}

void iso_gallery_vector_close(const struct iso_gallery_seal *seal,
                              const uint8_t record[ISO_SEAL_DIGEST_BYTES],
                              const uint8_t metric[ISO_SEAL_DIGEST_BYTES], const void *plain,
                              size_t size, uint8_t *sealed)
{
    const struct iso_seal_label label = vector_label(seal, record, metric);
    iso_seal_close(&seal->key, &label, plain, size, sealed);
}

int iso_gallery_vector_open(const struct iso_gallery_seal *seal,
                            const uint8_t record[ISO_SEAL_DIGEST_BYTES],
                            const uint8_t metric[ISO_SEAL_DIGEST_BYTES], const void *sealed,
                            size_t size, void *plain)
{
    const struct iso_seal_label label = vector_label(seal, record, metric);
    return iso_seal_open(&seal->key, &label, sealed, size, plain);
}

void iso_gallery_person_put(const struct iso_person *person,
                            uint8_t plain[ISO_GALLERY_PERSON_BYTES])
{
    uint8_t *p = iso_put_u64(plain, (uint64_t)person->enrolled_s);
    p = iso_put_u64(p, (uint64_t)person->valid_from_s);
    p = iso_put_u64(p, (uint64_t)person->valid_until_s);
    memset(p, 0, ISO_PERSON_NAME_SIZE);
    (void)iso_put_bytes(p, person->name, strlen(person->name));
}

int iso_gallery_person_get(const uint8_t *plain, size_t size, struct iso_person *out)
{
    const char *name = (const char *)plain + 24;
    if (size != ISO_GALLERY_PERSON_BYTES || !memchr(name, '\0', ISO_PERSON_NAME_SIZE) ||
        !iso_person_name_can_be_stored(name)) {
        return -EBADMSG;
    }
    *out = (struct iso_person){
        .enrolled_s = (int64_t)iso_get_u64(plain),
        .valid_from_s = (int64_t)iso_get_u64(plain + 8),
        .valid_until_s = (int64_t)iso_get_u64(plain + 16),
    };
    memcpy(out->name, name, strlen(name) + 1);
    return 0;
}

int iso_gallery_head_version(const struct iso_gallery_head *head)
{
    if (head->has_access) {
        return ISO_GALLERY_SCHEMA;
    }
    return iso_site_record_is_empty(&head->site) ? ISO_GALLERY_SCHEMA_SEALED
                                                 : ISO_GALLERY_SCHEMA_SITE;
}

size_t iso_gallery_head_close(const struct iso_gallery_seal *seal,
                              const struct iso_gallery_head *head,
                              uint8_t sealed[ISO_GALLERY_HEAD_SEALED])
{
    const bool has_site = !iso_site_record_is_empty(&head->site);
    const struct iso_seal_label label = label_of(seal, has_site ? "isotherm gallery head 3"
                                                                : "isotherm gallery head 2");
    const size_t size = has_site ? ISO_GALLERY_HEAD_BYTES : ISO_GALLERY_HEAD_2_BYTES;
    uint8_t plain[ISO_GALLERY_HEAD_BYTES];
    uint8_t *p = iso_put_u64(plain, head->changes);
    p = iso_put_u64(p, head->next);
    p = iso_put_bytes(p, head->digest, sizeof head->digest);
    iso_heads_put(&head->known, p);
    iso_site_record_put(&head->site, plain + ISO_GALLERY_HEAD_2_BYTES);
    iso_seal_close(&seal->key, &label, plain, size, sealed);
    return size + ISO_SEAL_OVERHEAD;
}

/* Returns the label of a head of this size; NULL if no format has it. */
static const char *head_kind(size_t size)
{
    switch (size) {
    case ISO_GALLERY_HEAD_1_BYTES + ISO_SEAL_OVERHEAD:
        return "isotherm gallery head 1";
    case ISO_GALLERY_HEAD_2_BYTES + ISO_SEAL_OVERHEAD:
        return "isotherm gallery head 2";
    case ISO_GALLERY_HEAD_SEALED:
        return "isotherm gallery head 3";
    default:
        return NULL;
    }
}

int iso_gallery_head_open(const struct iso_gallery_seal *seal, const void *sealed, size_t size,
                          struct iso_gallery_head *out)
{
    const char *kind = head_kind(size);
    uint8_t plain[ISO_GALLERY_HEAD_BYTES] = {0};
    if (!kind) {
        return -EBADMSG;
    }
    const struct iso_seal_label label = label_of(seal, kind);
    if (iso_seal_open(&seal->key, &label, sealed, size, plain) ||
        iso_site_record_get(plain + ISO_GALLERY_HEAD_2_BYTES, &out->site)) {
        return -EBADMSG;
    }
    out->changes = iso_get_u64(plain);
    out->next = iso_get_u64(plain + 8);
    memcpy(out->digest, plain + 16, sizeof out->digest);
    out->known = iso_heads_get(plain + ISO_GALLERY_HEAD_1_BYTES);
    return 0;
}
