/* Records of the gallery: the sealed bytes of a row, and the opened bytes. */
#include <string.h>

#include "firmware/gallery/gallery_seal.h"
#include "tests/fuzz/fuzz.h"

static void try_person(const uint8_t *data, size_t size)
{
    struct iso_person person;
    uint8_t again[ISO_GALLERY_PERSON_BYTES];
    if (iso_gallery_person_get(data, size, &person) == 0) {
        fuzz_check(iso_person_name_can_be_stored(person.name), "the name can be stored");
        iso_gallery_person_put(&person, again);
        fuzz_check(memcmp(again, data, 24 + strlen(person.name) + 1) == 0,
                   "a person who was read is written again with the same bytes");
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const uint8_t gallery[ISO_GALLERY_ID_BYTES] = {1};
    static const struct iso_seal_key key = {{5}};
    static uint8_t plain[ISO_TEMPLATE_BYTES_MAX], sealed[ISO_GALLERY_TEMPLATE_SEALED];
    const struct iso_gallery_place place = {
        .kind = ISO_GALLERY_TEMPLATE, .number = 3, .person = 2, .algorithm = 9};
    const struct iso_gallery_place other = {.number = 3, .person = 4, .algorithm = 9};
    struct iso_gallery_head head;
    struct iso_fault fault = {.text = ""};
    fuzz_check(iso_seal_start(&fault) == 0, fault.text);
    const struct iso_gallery_seal seal = iso_gallery_seal_of(gallery, 1, &key);
    try_person(data, size);
    fuzz_check(iso_gallery_head_open(&seal, data, size, &head) != 0, "a forged head is refused");
    if (size <= sizeof plain) {
        fuzz_check(size >= ISO_SEAL_OVERHEAD
                       ? iso_gallery_record_open(&seal, &place, data, size, plain) != 0
                       : 1,
                   "a forged record is refused");
        iso_gallery_record_close(&seal, &place, data, size, sealed);
        fuzz_check(
            iso_gallery_record_open(&seal, &place, sealed, size + ISO_SEAL_OVERHEAD, plain) == 0 &&
                memcmp(plain, data, size) == 0,
            "a sealed record is opened unchanged");
        fuzz_check(
            iso_gallery_record_open(&seal, &other, sealed, size + ISO_SEAL_OVERHEAD, plain) != 0,
            "a record in another place is refused");
    }
    return 0;
}
