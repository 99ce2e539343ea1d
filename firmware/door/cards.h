/* The card numbers that an access controller knows people by: a text file, one line a person,
 *
 *   FACILITY NUMBER NAME
 *
 * such as "17 4711 anna"; the name is all that stands behind the second blank. Empty lines and
 * lines that begin with '#' say nothing. Read strictly: no name and no number twice. */
#ifndef ISO_FIRMWARE_DOOR_CARDS_H
#define ISO_FIRMWARE_DOOR_CARDS_H

#include "core/base/fault.h"
#include "drivers/door/wiegand.h"

struct iso_cards;

/* -EBADMSG with "FILE:LINE: what is wrong", -ENOMEM, or an error of opening and reading it. */
int iso_cards_load(const char *path, struct iso_cards **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* NULL is fine. */
void iso_cards_free(struct iso_cards *cards);

/* One line of the file. Belongs to the cards. */
struct iso_card {
    struct iso_wiegand_card number;
    const char *person; /* as the file spells the name */
};

/* The card of a person, or NULL. A line that spells the name in the same way goes first; else the
 * only line whose name is the same without regard to case (person_name.h). Of an old gallery, in
 * which such a name may be another person's, the caller has to ask whose it is. */
const struct iso_card *iso_cards_find(const struct iso_cards *cards, const char *person);

#endif
