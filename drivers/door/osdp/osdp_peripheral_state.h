/* The members of a device of OSDP, which its sources share: osdp_peripheral.c (sequence and
 * security), osdp_commands.c, and osdp_events.c. */
#ifndef ISO_DRIVERS_DOOR_OSDP_OSDP_PERIPHERAL_STATE_H
#define ISO_DRIVERS_DOOR_OSDP_OSDP_PERIPHERAL_STATE_H

#include "drivers/door/osdp/osdp_peripheral.h"
#include "drivers/door/osdp/osdp_secure.h"

enum {
    ISO__OSDP_EVENT_BYTES = 4 + ISO_OSDP_CARD_BITS / 8,
    ISO__OSDP_ANSWER_BYTES = 64, /* the longest data of a reply */
};

/* A card or digits: the reply to a POLL. */
struct iso__osdp_event {
    uint8_t code;
    uint8_t n;
    uint8_t data[ISO__OSDP_EVENT_BYTES];
};

/* The states that are reported when they change. The numbers are bits. */
enum iso__osdp_report {
    ISO__OSDP_REPORT_LOCAL = 1,
    ISO__OSDP_REPORT_READER = 2,
    ISO__OSDP_REPORT_INPUTS = 4,
};

/* What the reply to the last POLL carried. */
enum iso__osdp_flight {
    ISO__OSDP_FLIGHT_NONE = 0,
    ISO__OSDP_FLIGHT_EVENT, /* the first event of the queue */
    ISO__OSDP_FLIGHT_REPORT,
};

/* A reply before it is put into a frame. */
struct iso__osdp_answer {
    uint8_t code;
    size_t n;
    uint8_t data[ISO__OSDP_ANSWER_BYTES];
    uint8_t block;  /* of a handshake, else ISO_OSDP_SCS_NONE */
    int block_data; /* of a handshake */
};

struct iso_osdp_peripheral {
    struct iso_osdp_setup setup;
    struct iso_osdp_saved next; /* holds after the reply to COMSET has been sent */
    bool has_next;
    struct iso_osdp_receiver receiver;
    struct iso_osdp_secure secure;
    bool default_key; /* the channel uses SCBK-D */

    int sequence; /* of the last frame that was accepted; -1: none */
    uint8_t frame[ISO_OSDP_FRAME_BYTES],
        reply[ISO_OSDP_FRAME_BYTES]; /* that frame, and its reply */
    size_t n_frame, n_reply;

    struct iso__osdp_event events[ISO_OSDP_EVENTS]; /* a ring */
    size_t first_event, n_events;
    enum iso__osdp_flight flight;
    unsigned reports;       /* of enum iso__osdp_report: to be sent */
    unsigned flight_report; /* the one that has been sent */

    bool tamper;
    uint8_t reader;
    bool input[ISO_OSDP_INPUTS];
    struct iso_osdp_display display;

    bool online, install;
    int64_t heard_ns;             /* the last frame that was accepted */
    int64_t bytes_ns;             /* the last bytes */
    int64_t install_end_ns;       /* if `install` */
    struct iso_osdp_status count; /* only its counters are used */
};

/* Whether cards and digits may be sent to the panel now. */
bool iso__osdp_may_carry_events(const struct iso_osdp_peripheral *peripheral);

/* Closes the secure channel. */
void iso__osdp_close(struct iso_osdp_peripheral *peripheral);

/* The panel has (or nobody knows whether it has) what the last reply to a POLL carried. */
void iso__osdp_flight_arrived(struct iso_osdp_peripheral *peripheral);
void iso__osdp_flight_lost(struct iso_osdp_peripheral *peripheral);

/* Empties the queue, and counts its events as undelivered. */
void iso__osdp_drop_events(struct iso_osdp_peripheral *peripheral);

/* Writes a state, or what is next in the queue, into an answer. The answer to a POLL is unchanged
 * if there is nothing to tell. */
void iso__osdp_put_local(const struct iso_osdp_peripheral *peripheral,
                         struct iso__osdp_answer *answer);
void iso__osdp_put_reader(const struct iso_osdp_peripheral *peripheral,
                          struct iso__osdp_answer *answer);
void iso__osdp_put_inputs(const struct iso_osdp_peripheral *peripheral,
                          struct iso__osdp_answer *answer);
void iso__osdp_poll(struct iso_osdp_peripheral *peripheral, struct iso__osdp_answer *answer);

/* Does a command and writes the answer. `data` is the data of the command, decrypted. */
void iso__osdp_do(struct iso_osdp_peripheral *peripheral, const struct iso_osdp_packet *packet,
                  const uint8_t *data, size_t n, int64_t now_ns, struct iso__osdp_answer *answer);

/* Makes the answer a NAK. */
void iso__osdp_nak(struct iso__osdp_answer *answer, enum iso_osdp_nak reason);

#endif
