/* The card numbers that an access controller knows people by: a text file, one line a person,
 *
 *   FACILITY NUMBER NAME
 *
 * such as "17 4711 anna"; the name is all that stands behind the second blank. Empty lines and
 * lines that begin with '#' say nothing. Read strictly: nobody and no number twice.
 * Names are compared without regard to case (person_name.h). */
#ifndef ISO_FIRMWARE_CARDS_H
#define ISO_FIRMWARE_CARDS_H

#include "core/fault.h"
#include "drivers/door/wiegand.h"

struct iso_cards;

/* -EBADMSG with "FILE:LINE: what is wrong", -ENOMEM, or an error of opening and reading it. */
int iso_cards_load(const char *path, struct iso_cards **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* NULL is fine. */
void iso_cards_free(struct iso_cards *cards);

/* The card of a person, or NULL. */
const struct iso_wiegand_card *iso_cards_find(const struct iso_cards *cards, const char *person);

#endif
