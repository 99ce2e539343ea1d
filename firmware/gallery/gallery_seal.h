/* How the gallery's records are sealed. Pure; internal to the gallery.
 *
 * A record is bound to its gallery, its number, its person and its algorithm, so that it opens in
 * no other place. All records together have a digest. The head contains it with the number of
 * changes: a record that is missing, from another time or from another gallery does not fit the
 * digest.
 *
 * The digest is the exclusive or of a keyed digest of every record (the MSet-XOR-Hash of D. Clarke
 * et al., "Incremental Multiset Hash Functions and Their Application to Memory Integrity Checking",
 * ASIACRYPT 2003; the records differ by their numbers). So the cost of a change depends only on the
 * records that it changes. */
#ifndef ISO_FIRMWARE_GALLERY_GALLERY_SEAL_H
#define ISO_FIRMWARE_GALLERY_GALLERY_SEAL_H

#include <stddef.h>
#include <stdint.h>

#include "firmware/gallery/gallery.h"
#include "firmware/keys/heads.h"
#include "firmware/keys/seal.h"
#include "firmware/site/site_record.h"
#include "isotherm/template.h"

enum {
    ISO_GALLERY_ID_BYTES = 16,
    ISO_GALLERY_PERSON_BYTES = 3 * 8 + ISO_PERSON_NAME_SIZE, /* the same for every name */
    ISO_GALLERY_PERSON_SEALED = ISO_GALLERY_PERSON_BYTES + ISO_SEAL_OVERHEAD,
    ISO_GALLERY_TEMPLATE_SEALED = ISO_TEMPLATE_BYTES_MAX + ISO_SEAL_OVERHEAD,
    ISO_GALLERY_HEAD_1_BYTES = 2 * 8 + ISO_SEAL_DIGEST_BYTES, /* without knowledge of others */
    ISO_GALLERY_HEAD_2_BYTES = ISO_GALLERY_HEAD_1_BYTES + ISO_HEADS_BYTES, /* without `site` */
    ISO_GALLERY_HEAD_BYTES = ISO_GALLERY_HEAD_2_BYTES + ISO_SITE_RECORD_BYTES,
    ISO_GALLERY_HEAD_SEALED = ISO_GALLERY_HEAD_BYTES + ISO_SEAL_OVERHEAD,
};

struct iso_gallery_seal {
    uint8_t gallery[ISO_GALLERY_ID_BYTES];
    uint32_t key_number;
    struct iso_seal_key key, digest_key;
};

struct iso_gallery_head {
    uint64_t changes;
    uint64_t next; /* number of the next record; no number is used twice */
    uint8_t digest[ISO_SEAL_DIGEST_BYTES];
    struct iso_heads known;      /* about the other stores, when this was written (heads.h) */
    struct iso_site_record site; /* which templates teach the metric */
    bool has_access; /* the table of access records exists; the version of the database says so, and
                      * not the sealed head: the digest protects its records */
};

enum iso_gallery_kind {
    ISO_GALLERY_PERSON = 0,
    ISO_GALLERY_TEMPLATE,
    ISO_GALLERY_ACCESS, /* a part of an access record */
};

/* The place of a record. */
struct iso_gallery_place {
    enum iso_gallery_kind kind;
    int64_t number;     /* number of the row */
    int64_t person;     /* the person of a template or an access record; 0: none */
    uint32_t algorithm; /* of a template; the number of a part */
};

/* The seal of a gallery, with keys derived from key `key_number` of the ring. */
struct iso_gallery_seal iso_gallery_seal_of(const uint8_t gallery[ISO_GALLERY_ID_BYTES],
                                            uint32_t key_number, const struct iso_seal_key *key);
void iso_gallery_seal_wipe(struct iso_gallery_seal *seal);

/* Seals or opens a record at its place; sealed has size + ISO_SEAL_OVERHEAD bytes in close, and
 * `size` bytes in open. open: -EBADMSG. */
void iso_gallery_record_close(const struct iso_gallery_seal *seal,
                              const struct iso_gallery_place *place, const void *plain, size_t size,
                              uint8_t *sealed);
int iso_gallery_record_open(const struct iso_gallery_seal *seal,
                            const struct iso_gallery_place *place, const void *sealed, size_t size,
                            void *plain) __attribute__((warn_unused_result));

/* Adds the record to a digest, or removes it again. */
void iso_gallery_record_toggle(const struct iso_gallery_seal *seal,
                               const struct iso_gallery_place *place, const void *sealed,
                               size_t size, uint8_t digest[ISO_SEAL_DIGEST_BYTES]);

/* Seals or opens the vector of a template (rows/gallery_vector_rows.c): `record` is the digest of
 * the sealed template, and `metric` a digest of the metric. Sizes as for a record. open: -EBADMSG.
 */
void iso_gallery_vector_close(const struct iso_gallery_seal *seal,
                              const uint8_t record[ISO_SEAL_DIGEST_BYTES],
                              const uint8_t metric[ISO_SEAL_DIGEST_BYTES], const void *plain,
                              size_t size, uint8_t *sealed);
int iso_gallery_vector_open(const struct iso_gallery_seal *seal,
                            const uint8_t record[ISO_SEAL_DIGEST_BYTES],
                            const uint8_t metric[ISO_SEAL_DIGEST_BYTES], const void *sealed,
                            size_t size, void *plain) __attribute__((warn_unused_result));

/* A person's record: dates and name, without id and counts. get: -EBADMSG a size or a name that is
 * not possible. */
void iso_gallery_person_put(const struct iso_person *person,
                            uint8_t plain[ISO_GALLERY_PERSON_BYTES]);
int iso_gallery_person_get(const uint8_t *plain, size_t size, struct iso_person *out)
    __attribute__((warn_unused_result));

/* The version of the database that this head needs: ISO_GALLERY_SCHEMA with access records,
 * ISO_GALLERY_SCHEMA_SITE if its record of the site is not empty, else ISO_GALLERY_SCHEMA_SEALED,
 * which earlier programs can read. */
int iso_gallery_head_version(const struct iso_gallery_head *head);

/* Seals the head, in the format of version 3 only if that is needed, and returns the size; or opens
 * a sealed head. Opening fails with -EBADMSG if the bytes were not sealed with this key. A head of
 * an earlier format has no record of the site, and the earliest also no state of the other stores;
 * it can be opened as well, and these members are then zero. */
size_t iso_gallery_head_close(const struct iso_gallery_seal *seal,
                              const struct iso_gallery_head *head,
                              uint8_t sealed[ISO_GALLERY_HEAD_SEALED]);
int iso_gallery_head_open(const struct iso_gallery_seal *seal, const void *sealed, size_t size,
                          struct iso_gallery_head *out) __attribute__((warn_unused_result));

#endif
