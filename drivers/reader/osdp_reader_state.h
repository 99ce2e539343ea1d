/* The members of a reader of OSDP, which its sources share: osdp_reader.c (commands, sequence and
 * security), and osdp_reader_reply.c (what replies say). */
#ifndef ISO_DRIVERS_READER_OSDP_READER_STATE_H
#define ISO_DRIVERS_READER_OSDP_READER_STATE_H

#include "drivers/door/osdp/osdp_secure.h"
#include "drivers/reader/osdp_reader.h"

/* The steps of a start. Each is one command, except the last one. */
enum iso__osdp_step {
    ISO__OSDP_STEP_ID = 0,
    ISO__OSDP_STEP_CAP,
    ISO__OSDP_STEP_CHALLENGE,
    ISO__OSDP_STEP_PROOF,
    ISO__OSDP_STEP_STATE,
    ISO__OSDP_STEP_POLL,
};

/* What the reader has to show. The numbers are bits. */
enum iso__osdp_show {
    ISO__OSDP_SHOW_LAMP = 1,
    ISO__OSDP_SHOW_TONE = 2,
};

struct iso_osdp_reader {
    struct iso_osdp_reader_setup setup;
    struct iso_osdp_receiver receiver;
    struct iso_osdp_secure secure;
    uint8_t proof[ISO_OSDP_KEY_BYTES]; /* the server cryptogram, for SCRYPT */
    enum iso__osdp_step step;

    uint8_t sequence; /* of the command that waits for a reply, or of the next one */
    bool waits;       /* the command in `frame` waits for a reply */
    bool polls;       /* ... and it is a POLL */
    uint8_t frame[ISO_OSDP_FRAME_BYTES];
    size_t n_frame;
    int64_t due_ns;    /* when something is to be sent */
    int64_t heard_ns;  /* the last reply that counted, or the start */
    int64_t worked_ns; /* the last reply after the start, or the very first start */
    int64_t bytes_ns;  /* the last bytes */

    bool online;
    bool draining; /* events are from the time before the start */
    bool tamper, unit_tamper;
    enum iso_osdp_reader_problem problem;
    unsigned show; /* of enum iso__osdp_show */
    bool show_allow;

    struct iso_reader_event events[ISO_OSDP_READER_EVENTS]; /* a ring */
    size_t first_event, n_events;
    struct iso_osdp_reader_status count; /* only its counters and `serial` are used */
};

/* What a reply asks for. */
enum iso__osdp_next {
    ISO__OSDP_NEXT_SOON = 0, /* the next command at once */
    ISO__OSDP_NEXT_POLL,     /* there was nothing to tell */
    ISO__OSDP_NEXT_RESTART,  /* a new start after a pause */
};

/* A reply that counts. `data` is decrypted. */
struct iso__osdp_reply {
    uint8_t code;
    uint8_t block; /* of a handshake, else ISO_OSDP_SCS_NONE */
    const uint8_t *data;
    size_t n;
};

/* Takes a reply to the command of the present step. */
enum iso__osdp_next iso__osdp_reader_reply(struct iso_osdp_reader *reader,
                                           const struct iso__osdp_reply *reply);

#endif
