/* Exported people: the sealed file, and its opened contents. */
#include "firmware/transfer/transfer.h"
#include "tests/fuzz/fuzz.h"

static void check_items(const struct iso_transfer *transfer)
{
    size_t n = 0, templates = 0;
    const struct iso_gallery_item *items = iso_transfer_items(transfer, &n);
    for (size_t i = 0; i < n; i++) {
        fuzz_check(items[i].n >= 1 && items[i].n <= ISO_GALLERY_TEMPLATES_MAX,
                   "each person has a valid number of templates");
        for (size_t t = 0; t < items[i].n; t++) {
            const uint8_t *bytes = items[i].templates[t].bytes;
            for (size_t at = 0; at < items[i].templates[t].size; at++) {
                templates += bytes[at]; /* reads every byte, so that a sanitizer checks it */
            }
        }
    }
    fuzz_check(templates != SIZE_MAX, "bytes that can be read");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const struct iso_seal_key key;
    struct iso_transfer *transfer = NULL;
    struct iso_fault fault = {.text = ""};
    fuzz_check(iso_seal_start(&fault) == 0, fault.text);
    if (iso_transfer_parse(data, size, &transfer) == 0) {
        check_items(transfer);
    }
    iso_transfer_done(transfer);
    transfer = NULL;
    fuzz_check(iso_transfer_read(data, size, NULL, &key, NULL, &transfer, &fault) != 0,
               "a forged signature is refused");
    fuzz_check(fault.text[0] != '\0', "a fault that says something");
    return 0;
}
