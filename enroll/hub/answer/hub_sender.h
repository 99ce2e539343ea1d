/* Who has sent a message: the door's row, and whether it may send. Internal to the answers. */
#ifndef ISO_ENROLL_HUB_ANSWER_HUB_SENDER_H
#define ISO_ENROLL_HUB_ANSWER_HUB_SENDER_H

#include "enroll/hub/store/hub_door.h"

/* Finds the door that the message names. -EACCES it is unknown, has not joined, or is expelled;
 * -EBADMSG the message names none. */
int hub__sender(struct hub_store *store, const void *bytes, size_t size, struct hub_door *out,
                struct iso_fault *fault) __attribute__((warn_unused_result));

/* The fault of reading a message of this door: `what` is "question". Returns the error. */
int hub__sender_fault(const struct hub_door *door, const char *what, int error,
                      struct iso_fault *fault);

#endif
