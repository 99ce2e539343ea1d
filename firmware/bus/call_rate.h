/* Limits how often the clients of the bus may call. Pure: time is an argument. The door must be
 * watched even while a client calls without end. So each client has an allowance that fills again
 * with time; further calls are refused before they are read.
 *
 * Clients are identified by their unique names. A client that leaves the bus and comes back has a
 * new name; therefore new clients take their allowance from one that all new clients share. The
 * last ISO_CALL_RATE_CLIENTS clients are remembered, and older ones count as new. */
#ifndef ISO_FIRMWARE_BUS_CALL_RATE_H
#define ISO_FIRMWARE_BUS_CALL_RATE_H

#include <stdbool.h>
#include <stdint.h>

enum { ISO_CALL_RATE_CLIENTS = 16, ISO_CALL_RATE_NAME_SIZE = 64 };

/* An allowance: at most `burst` calls at once, `per_s` in the long run. */
struct iso_call_allowance {
    double calls; /* left */
    int64_t t_ns; /* the time of this level */
};

struct iso_call_rate {
    struct iso_call_allowance newcomers;
    struct {
        char name[ISO_CALL_RATE_NAME_SIZE]; /* "": the slot is free */
        struct iso_call_allowance allowance;
    } clients[ISO_CALL_RATE_CLIENTS];
};

/* A client: 40 calls at once and 20 a second. All new clients: 40 at once and 10 a second. */
#define ISO_CALL_RATE_BURST          40.0
#define ISO_CALL_RATE_PER_S          20.0
#define ISO_CALL_RATE_NEWCOMER_PER_S 10.0

void iso_call_rate_init(struct iso_call_rate *rate, int64_t now_ns);

/* Whether a call of this client is to be answered. If so, it is counted. now_ns never decreases. */
bool iso_call_rate_take(struct iso_call_rate *rate, const char *client, int64_t now_ns);

#endif
