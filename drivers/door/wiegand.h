/* Card numbers as access controllers read them from a reader, in the two common Wiegand formats
 * (HID H10301 and H10306). Pure: no device is used.
 *
 *   26 bits   even parity over the next 12, facility (8), number (16), odd parity over the last 12
 *   34 bits   even parity over the next 16, facility (16), number (16), odd parity over the last 16
 *
 * A code of n bits is sent from its most significant bit on: bit n-1 first, bit 0 last. */
#ifndef ISO_DRIVERS_DOOR_WIEGAND_H
#define ISO_DRIVERS_DOOR_WIEGAND_H

#include <stdint.h>

struct iso_wiegand_card {
    unsigned facility, number;
};

/* Makes the code of a card in the format of 26 or 34 bits. -EINVAL no such format, -ERANGE facility
 * or number does not fit. */
int iso_wiegand_encode(int bits, const struct iso_wiegand_card *card, uint64_t *code)
    __attribute__((warn_unused_result));

/* Reads the card from a code of 26 or 34 bits. -EINVAL no such format, or the code is longer;
 * -EBADMSG a parity is wrong. */
int iso_wiegand_decode(int bits, uint64_t code, struct iso_wiegand_card *card)
    __attribute__((warn_unused_result));

#endif
