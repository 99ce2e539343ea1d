/* Outlets: where the events of the doors go out of the hub. Each outlet hands over every event that
 * its filter lets through at least once, and the events of each door in the order of their numbers.
 * The errors of hub_store.h.
 *
 * For each door an outlet has a cursor, which follows door.acked: up to there the hub has every
 * event of the door. So no event is overtaken by one that another process stored earlier, and no
 * number for the whole hub is needed. What is handed over next, the batch, is stored first. After a
 * crash the same batch is handed over again, with the same key, by which a receiver knows it. */
#ifndef ISO_ENROLL_HUB_OUTLET_HUB_OUTLET_H
#define ISO_ENROLL_HUB_OUTLET_HUB_OUTLET_H

#include "enroll/hub/store/hub_store.h"

enum hub_outlet_kind { HUB_OUTLET_WEBHOOK, HUB_OUTLET_SYSLOG };

enum {
    HUB_OUTLET_ADDRESS_SIZE = 1024,
    HUB_OUTLET_SECRET_SIZE = 129, /* 16 to 128 bytes */
    HUB_OUTLET_EVENTS_SIZE = 1024,
    HUB_OUTLET_TROUBLE_SIZE = 256,
};

struct hub_outlet {
    struct iso_fleet_id id;
    char name[HUB_NAME_SIZE];
    enum hub_outlet_kind kind;
    /* webhook: "https://HOST[:PORT]/...", or "http://" of localhost.
     * syslog: "tls://HOST[:PORT]", "tcp://HOST[:PORT]", "udp://HOST[:PORT]", or "local:PATH" of a
     * socket, such as local:/dev/log. */
    char address[HUB_OUTLET_ADDRESS_SIZE];
    char events[HUB_OUTLET_EVENTS_SIZE]; /* names of events, separated by commas; "": all */
    bool has_ca;                         /* the receiver is checked by certificates of its own */
    bool stopped;                        /* the receiver has refused; a person resumes it */
    bool in_flight;                      /* a batch was handed over and is not confirmed */
    uint64_t delivered;                  /* events */
    uint64_t waiting;       /* numbers of events that the hub has and the outlet has not passed */
    uint64_t failures;      /* since the last success */
    int64_t next_attempt_s; /* 0: at once */
    int64_t delivered_s;    /* the last success; 0: none */
    char trouble[HUB_OUTLET_TROUBLE_SIZE]; /* the last failure; "" after a success */
};

const char *hub_outlet_kind_word(enum hub_outlet_kind kind);

struct hub_outlet_options {
    const char *name, *address;
    enum hub_outlet_kind kind;
    const char *events;  /* as above; NULL: all */
    const char *secret;  /* webhook: with which the requests are signed; NULL: a new one is made */
    const char *ca;      /* PEM: the certificates that are trusted; NULL: those of the system */
    bool from_beginning; /* the events that the hub has already are handed over, too */
};

/* Adds an outlet. `secret` receives the secret of a webhook, else "". -EEXIST the name is taken;
 * -EINVAL a name, an address, a secret or a list of events is not allowed. */
int hub_outlet_add(struct hub_store *store, const struct hub_outlet_options *options,
                   char secret[HUB_OUTLET_SECRET_SIZE], struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Removes an outlet with its cursors. -ENOENT. */
int hub_outlet_remove(struct hub_store *store, const char *name, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Lets an outlet go on that was stopped, or try at once what has failed. -ENOENT. */
int hub_outlet_resume(struct hub_store *store, const char *name, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* All outlets by name. */
int hub_outlet_each(struct hub_store *store,
                    int (*each)(void *context, const struct hub_outlet *outlet), void *context,
                    struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
