#include "drivers/door/wiegand.h"

#include <errno.h>

enum { NUMBER_BITS = 16 };

/* The number of bits of the facility; 0 if there is no such format. */
static int facility_bits(int bits)
{
    switch (bits) {
    case 26:
        return 8;
    case 34:
        return 16;
    default:
        return 0;
    }
}

static uint64_t ones(int n)
{
    return (UINT64_C(1) << n) - 1;
}

static unsigned is_odd(uint64_t bits)
{
    return (unsigned)__builtin_parityll(bits);
}

/* Adds the parity bits to facility and number: the complete code. */
static uint64_t with_parity(int bits, uint64_t data)
{
    const int half = (bits - 2) / 2;
    const uint64_t even = is_odd(data >> half);
    const uint64_t odd = 1 - is_odd(data & ones(half));
    return even << (bits - 1) | data << 1 | odd;
}

int iso_wiegand_encode(int bits, const struct iso_wiegand_card *card, uint64_t *code)
{
    const int facility = facility_bits(bits);
    if (!facility) {
        return -EINVAL;
    }
    if (card->facility > ones(facility) || card->number > ones(NUMBER_BITS)) {
        return -ERANGE;
    }
    *code = with_parity(bits, (uint64_t)card->facility << NUMBER_BITS | card->number);
    return 0;
}

int iso_wiegand_decode(int bits, uint64_t code, struct iso_wiegand_card *card)
{
    if (!facility_bits(bits) || code > ones(bits)) {
        return -EINVAL;
    }
    const uint64_t data = code >> 1 & ones(bits - 2);
    if (with_parity(bits, data) != code) {
        return -EBADMSG;
    }
    card->facility = (unsigned)(data >> NUMBER_BITS);
    card->number = (unsigned)(data & ones(NUMBER_BITS));
    return 0;
}
