/* Limits how often the clients of the bus may call. Pure: time is an argument. The door must be
 * watched even while a client calls without end. So each client has an allowance that fills again
 * with time. Calls beyond it are refused before they are read.
 *
 * Clients are identified by their unique names. A client that leaves the bus and comes back has a
 * new name. Therefore the first call of each client is counted against a second allowance, which
 * all new clients share. The last ISO_CALL_RATE_CLIENTS clients are remembered; a client that was
 * forgotten counts as new. */
#ifndef ISO_FIRMWARE_BUS_CALL_RATE_H
#define ISO_FIRMWARE_BUS_CALL_RATE_H

#include <stdbool.h>
#include <stdint.h>

enum { ISO_CALL_RATE_CLIENTS = 16, ISO_CALL_RATE_NAME_SIZE = 64 };

/* An allowance: a number of calls, at most ISO_CALL_RATE_BURST, which rises with time at the rate
 * of its kind. */
struct iso_call_allowance {
    double calls; /* calls that are left at t_ns */
    int64_t t_ns; /* time of the last call */
};

struct iso_call_rate {
    struct iso_call_allowance newcomers; /* for the first calls of new clients */
    struct iso_call_allowance messages;  /* of a hub */
    struct {
        char name[ISO_CALL_RATE_NAME_SIZE]; /* "": the slot is free */
        struct iso_call_allowance allowance;
    } clients[ISO_CALL_RATE_CLIENTS];
};

/* A client: 40 calls at once and 20 a second. First calls of all new clients: 40 at once and 10 a
 * second. */
#define ISO_CALL_RATE_BURST          40.0
#define ISO_CALL_RATE_PER_S          20.0
#define ISO_CALL_RATE_NEWCOMER_PER_S 10.0

/* Messages of a hub, which isotherm-link alone hands over: 40 at once and 100 a second, so that a
 * door that was away catches up. */
#define ISO_CALL_RATE_MESSAGES_PER_S 100.0

/* Begins with no client and a full allowance for new ones. */
void iso_call_rate_init(struct iso_call_rate *rate, int64_t now_ns);

/* Whether a call of this client is to be answered; such a call is counted. Calls of a new client
 * whose name does not fit into ISO_CALL_RATE_NAME_SIZE are refused. now_ns never decreases. */
bool iso_call_rate_take(struct iso_call_rate *rate, const char *client, int64_t now_ns);

/* The same for a message of a hub, whoever brings it. */
bool iso_call_rate_take_message(struct iso_call_rate *rate, int64_t now_ns);

#endif
