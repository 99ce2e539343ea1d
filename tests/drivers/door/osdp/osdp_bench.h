/* A device and a panel on a bench: no line between them, time stands still unless a test moves it.
 */
#ifndef TESTS_DRIVERS_DOOR_OSDP_OSDP_BENCH_H
#define TESTS_DRIVERS_DOOR_OSDP_OSDP_BENCH_H

#include "drivers/door/osdp/osdp_peripheral.h"
#include "tests/drivers/door/osdp/osdp_panel.h"

#define BENCH_SECOND_NS INT64_C(1000000000)

extern const uint8_t bench_key[16], bench_default_key[16];

struct bench {
    struct iso_osdp_peripheral *device;
    struct panel panel;
    int64_t now_ns;
    struct iso_osdp_saved saved; /* what the device has stored */
    int stores;                  /* how often */
    int store_error, random_error;
    uint8_t random; /* the next random byte */
};

/* A setup: address 5, 9600 baud, with or without the key bench_key, plain frames permitted or not.
 */
struct iso_osdp_setup bench_setup(struct bench *bench, bool has_key, bool plain);

/* Makes device and panel. */
void bench_init(struct bench *bench, bool has_key, bool plain);
void bench_done(struct bench *bench);

/* Gives the panel's last frame to the device, and its reply to the panel. */
void bench_exchange(struct bench *bench, struct panel_reply *reply);

/* Sends a command; returns the code of the reply, -1: there was none. */
int bench_ask(struct bench *bench, uint8_t command, const void *data, size_t n,
              struct panel_reply *reply);

/* Opens the channel with a key. Returns whether this succeeded. */
bool bench_secure(struct bench *bench, const uint8_t key[16]);

struct iso_osdp_status bench_status(const struct bench *bench);

#endif
