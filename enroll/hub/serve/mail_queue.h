/* The messages of doors that wait for the database. They are taken one at a time, so that other
 * sources of the event loop get their turn. A queue that is full drops the newest message: each
 * door says the same again as long as it has no answer. A door that asks again needs no answer to
 * its earlier question, so a QUESTION replaces the one of the same door that still waits. One
 * thread. */
#ifndef HUB_SERVE_MAIL_QUEUE_H
#define HUB_SERVE_MAIL_QUEUE_H

#include <stdbool.h>
#include <stddef.h>

#include "firmware/fleet/message/fleet_id.h"

enum { HUB_MAIL_BYTES_MAX = 128 << 20 };

struct hub_mail {
    struct hub_mail *next;
    struct iso_fleet_id door;
    bool is_presence; /* from the topic `online`, else from `out` */
    bool is_question;
    size_t size;
    unsigned char *bytes; /* freed with the message */
};

/* All zero is empty. */
struct hub_mail_queue {
    struct hub_mail *first, **end;
    void *questions; /* the tree of tsearch(): the QUESTION of each door that has one here */
    size_t n, bytes;
    unsigned long long dropped, replaced;
};

/* The door of a topic isotherm/door/ID/out or .../online. False: it is another topic. */
bool hub_mail_topic(const char *topic, struct iso_fleet_id *door, bool *is_presence);

/* Copies a message to the end. A QUESTION replaces the earlier one of its door, if that still
 * waits. False: the queue is full, or there is no memory. */
bool hub_mail_put(struct hub_mail_queue *queue, const struct iso_fleet_id *door, bool is_presence,
                  const void *bytes, size_t size);

/* Wipes and frees the first message, if there is one. */
void hub_mail_drop_first(struct hub_mail_queue *queue);

void hub_mail_clear(struct hub_mail_queue *queue);

#endif
