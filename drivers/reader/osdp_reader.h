/* A card reader or keypad on an RS-485 bus, asked by the appliance over OSDP (IEC 60839-11-5, SIA
 * OSDP 2.2). Here the appliance is what the standard calls the control panel; the other side of
 * the protocol is drivers/door/osdp. Pure: bytes, time and random numbers are handed in;
 * osdp_reader_port.h connects it to a serial line.
 *
 *   start --ID--> --CAP--> [with a key: --CHLNG--> --SCRYPT-->] --LSTAT--> POLL, POLL, ...
 *
 * A command without a reply is repeated bit by bit after 200 ms, and the time that the bytes take
 * on the line. A reply counts if it has the sequence number of the command that waits for one, so a
 * repeated reply counts once. After 8 s without a reply the reader is away, and the start begins
 * anew with the sequence number 0. So it does when the reader says that it does not know the
 * conversation.
 *
 * Cards and keys that the reader has kept from the time before a start are dropped: nobody means a
 * card that was shown long ago, and a reader that does not know whether the last card has arrived
 * may send it again. The first reply to a POLL that has no event ends this.
 *
 * Security. With a key no card and no key is taken outside of the secure channel; in it every reply
 * needs a MAC, and one that has none or a wrong one is not taken. A plain NAK is the one exception,
 * because a reader that has lost its power has no keys: it makes the appliance start anew, after a
 * pause. The default key SCBK-D, which everyone knows, is never used. README.md lists the commands
 * and the replies. */
#ifndef ISO_DRIVERS_READER_OSDP_READER_H
#define ISO_DRIVERS_READER_OSDP_READER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "drivers/door/osdp/osdp_aes.h"
#include "drivers/door/osdp/osdp_packet.h"
#include "drivers/reader/wiegand_frame.h"

#define ISO_OSDP_READER_POLL_NS    INT64_C(50000000)  /* from a reply without an event to a POLL */
#define ISO_OSDP_READER_GAP_NS     INT64_C(2000000)   /* from any other reply to the next command */
#define ISO_OSDP_READER_REPLY_NS   INT64_C(200000000) /* after which a command is repeated */
#define ISO_OSDP_READER_PAUSE_NS   INT64_C(1000000000) /* before a start after a refusal */
#define ISO_OSDP_READER_SILENCE_NS INT64_C(8000000000) /* the reader is away after this time */

enum {
    ISO_OSDP_READER_EVENTS = 64
}; /* so many cards and keys may wait; further ones are dropped */

struct iso_osdp_reader_setup {
    uint8_t address;                 /* 0 to 0x7E */
    uint32_t baud;                   /* iso_osdp_is_baud */
    bool has_key;                    /* false: plain; anyone on the wire reads and forges cards */
    uint8_t key[ISO_OSDP_KEY_BYTES]; /* the reader's SCBK */

    /* Writes n random bytes; 0 or a negative errno, after which the start begins anew. */
    int (*random)(void *context, void *bytes, size_t n);
    void *context;
};

/* Why a reader does not work. */
enum iso_osdp_reader_problem {
    ISO_OSDP_READER_FINE = 0, /* it works, or there was no time yet to find out */
    ISO_OSDP_READER_SILENT,   /* no reply for ISO_OSDP_READER_SILENCE_NS */
    ISO_OSDP_READER_OTHER_KEY,
    ISO_OSDP_READER_REFUSES,   /* it refuses the secure channel */
    ISO_OSDP_READER_WANTS_KEY, /* it refuses to work without the secure channel */
    ISO_OSDP_READER_TAMPERED,  /* it says that it was opened; its cards and keys still count */
    ISO_OSDP_READER_PROBLEMS,
};

struct iso_osdp_reader_status {
    bool online; /* the start has succeeded, and the last reply is not long ago */
    bool secure; /* the secure channel is open */
    enum iso_osdp_reader_problem problem;
    uint32_t serial;   /* as it says itself; 0: it has not said it */
    uint64_t events;   /* cards, keys and damaged ones that were taken */
    uint64_t stale;    /* replies with events that were dropped after a start */
    uint64_t dropped;  /* events for which there was no room */
    uint64_t repeated; /* commands that were sent again */
    uint64_t refused;  /* replies without a MAC, or with a wrong one */
    uint64_t damaged;  /* as in struct iso_osdp_receiver */
    uint64_t starts;   /* after the first one, also those of a line that was opened */
};

struct iso_osdp_reader;

/* Makes a reader that starts at now_ns. -EINVAL the setup is not possible; -ENOMEM. */
int iso_osdp_reader_new(const struct iso_osdp_reader_setup *setup, int64_t now_ns,
                        struct iso_osdp_reader **out) __attribute__((warn_unused_result));

/* Wipes all keys. NULL is fine. */
void iso_osdp_reader_free(struct iso_osdp_reader *reader);

/* Takes n bytes that arrived at now_ns, which never goes back. */
void iso_osdp_reader_receive(struct iso_osdp_reader *reader, const uint8_t *bytes, size_t n,
                             int64_t now_ns);

/* Lets time pass. Returns the number of bytes of the command in frame[ISO_OSDP_FRAME_BYTES] that
 * has to be sent now, or 0: there is nothing to send before iso_osdp_reader_due_ns. */
size_t iso_osdp_reader_send(struct iso_osdp_reader *reader, int64_t now_ns, uint8_t *frame);
int64_t iso_osdp_reader_due_ns(const struct iso_osdp_reader *reader);

/* Starts anew at now_ns, because the line was gone. */
void iso_osdp_reader_restart(struct iso_osdp_reader *reader, int64_t now_ns);

/* Takes the oldest event; false: there is none. */
bool iso_osdp_reader_take(struct iso_osdp_reader *reader, struct iso_reader_event *out);

/* Shows for 2 s whether somebody is let in: green and one tone, or red and three tones. A reader
 * that is away, or has no lamp or buzzer, shows nothing. */
void iso_osdp_reader_show(struct iso_osdp_reader *reader, bool allow);

/* Copies the state. */
void iso_osdp_reader_status(const struct iso_osdp_reader *reader,
                            struct iso_osdp_reader_status *status);

#endif
