/* The side of OSDP that asks a reader, and the project's own device of OSDP as the reader. There is
 * no line between them; time goes on by itself as the two need it. */
#ifndef TESTS_DRIVERS_READER_READER_DUO_H
#define TESTS_DRIVERS_READER_READER_DUO_H

#include "drivers/door/osdp/osdp_peripheral.h"
#include "drivers/reader/osdp_reader.h"

#define MS INT64_C(1000000)

extern const uint8_t duo_key[16];

struct duo {
    struct iso_osdp_reader *reader;
    struct iso_osdp_peripheral *device;
    int64_t now_ns;
    uint32_t dice;
    uint32_t loss;                       /* of so many frames one is damaged or lost; 0: none */
    bool unplugged;                      /* the wire is cut */
    uint8_t reply[ISO_OSDP_FRAME_BYTES]; /* the last one */
    size_t n_reply;
};

/* Makes both, with the key duo_key, or both without a key. */
void duo_open(struct duo *duo, bool has_key);
void duo_close(struct duo *duo);

/* Makes one of them anew. */
void duo_plug_device(struct duo *duo, bool has_key, bool plain);
void duo_open_reader(struct duo *duo, bool has_key);

/* Makes the setup of a reader. The caller may change its key or take its random numbers away. */
struct iso_osdp_reader_setup duo_reader_setup(struct duo *duo, bool has_key);

/* One command, when one is due next, and its reply. */
void duo_exchange(struct duo *duo);

/* Exchanges for a time, or until the start is over and nothing old is dropped any more. */
void duo_run_for(struct duo *duo, int64_t ns);
void duo_run_until_online(struct duo *duo);

struct iso_osdp_reader_status duo_status(const struct duo *duo);

/* Queues the event i at the device: two cards of 40 bits, then a key, in turn. */
int duo_add(struct duo *duo, unsigned i);

/* Fails the test unless this is the event i. */
void duo_expect(const struct iso_reader_event *event, unsigned i);

#endif
