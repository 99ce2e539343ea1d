/* Several messages of doors taken in one transaction. A commit waits for the disk, which takes
 * longer than all the rest of a message; so a hub with many doors takes what has come meanwhile
 * together. The errors of hub_answer.h. */
#ifndef ISO_ENROLL_HUB_ANSWER_HUB_LETTERS_H
#define ISO_ENROLL_HUB_ANSWER_HUB_LETTERS_H

#include <stdbool.h>

#include "enroll/hub/answer/hub_answer.h"

enum { HUB_LETTERS_MOST = 64 };

/* A message of a door, which belongs to the caller. */
struct hub_letter {
    struct iso_fleet_id door;
    const void *bytes; /* from the topic `out`; NULL: none, it tells whether the door is online */
    size_t size;
    bool online;
};

/* Whether a message may be taken together with others: QUESTION and EVENTS may. A REQUEST may not,
 * because it may be approved at once, which is a change of a zone. */
bool hub_letter_is_joint(const void *bytes, size_t size);

/* Takes n messages (1 to HUB_LETTERS_MOST) that may be taken together, those of each door in their
 * order. What answers them is emitted after the commit, so that no door learns of something that a
 * crash could still undo. After an error of one of them nothing of all holds, and nothing was
 * emitted; the caller takes them one by one. An error of `emit` comes after the commit; the same
 * messages may come again. */
int hub_take_letters(struct hub_store *store, const struct hub_letter *letters, size_t n,
                     const struct hub_emit *emit, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
