/* The file of card numbers. */
#include "firmware/door/cards.h"
#include "tests/fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct iso_cards *cards = NULL;
    struct iso_fault fault = {0};
    const int error = iso_cards_load(fuzz_file(data, size), &cards, &fault);
    if (error == 0) {
        const struct iso_card *card = iso_cards_find(cards, "anna");
        fuzz_check(!iso_cards_find(cards, ""), "an empty name has no card");
        fuzz_check(!card || (card->number.facility <= 65535 && card->number.number <= 65535),
                   "numbers that fit");
    } else {
        fuzz_check(fault.text[0] != '\0', "a fault that says something");
    }
    iso_cards_free(cards);
    return 0;
}
