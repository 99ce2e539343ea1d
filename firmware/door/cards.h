/* The card numbers of people for an access controller: a text file with one line for each person,
 *
 *   FACILITY NUMBER NAME
 *
 * such as "17 4711 anna". The name is everything after the second blank. Empty lines and lines that
 * begin with '#' are ignored. The file is read strictly: no spelling of a name and no card may
 * occur twice. */
#ifndef ISO_FIRMWARE_DOOR_CARDS_H
#define ISO_FIRMWARE_DOOR_CARDS_H

#include "core/base/fault.h"
#include "drivers/door/wiegand.h"

struct iso_cards;

/* Reads the file. -EBADMSG with "FILE:LINE: what is wrong", -ENOMEM, or an error of opening and
 * reading it. */
int iso_cards_load(const char *path, struct iso_cards **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Frees them. NULL is accepted. */
void iso_cards_free(struct iso_cards *cards);

/* One line of the file. Belongs to the cards. */
struct iso_card {
    struct iso_wiegand_card number;
    const char *person; /* as the file spells the name */
};

/* The card of a person, or NULL. A line with exactly this spelling of the name is preferred.
 * Otherwise it is the only line whose name is the same without regard to case (person_name.h). In
 * an old gallery such a name may be another person's, so the caller has to check whose card it
 * is. */
const struct iso_card *iso_cards_find(const struct iso_cards *cards, const char *person);

#endif
