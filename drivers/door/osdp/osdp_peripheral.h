/* A door station as a peripheral device of OSDP (IEC 60839-11-5, SIA OSDP 2.2) on the RS-485 bus of
 * an access panel. The panel asks, the device answers within 200 ms. Pure: bytes, time and random
 * numbers are handed in; osdp_port.h connects it to a serial line.
 *
 * This header is the only interface to the protocol. The library libosdp could do the same work
 * behind it; Debian 12 does not have that library, so the protocol is implemented here.
 *
 * Sequence numbers. Each frame has the number after that of the frame before: 0 once, then 1, 2, 3,
 * 1, 2, 3 and so on. A frame that is repeated bit by bit gets the same reply again, and its command
 * is not done again. A plain frame with the number 0 is a new start of the panel; it closes the
 * secure channel. Any other number is refused (NAK 4).
 *
 * Events (cards, digits) wait in a queue. Each is the reply to one POLL, and leaves the queue when
 * the panel's next frame shows that it has that reply. If the panel starts anew instead, nobody
 * knows whether it has the event. Then the event is dropped and counted, not sent again: a card
 * that arrives twice opens the door when nobody is there. For the same reason the queue is emptied
 * when the panel falls silent, and takes no event while the panel is away.
 *
 * Security. Unless plain frames are permitted, only ID, CAP and the commands that open the secure
 * channel are done without it, and cards and digits go only through a channel with the panel's own
 * key. The default key SCBK-D, which everyone knows, opens a channel only in the install mode, and
 * such a channel serves to set a key (KEYSET). COMSET is done without a channel in the install mode
 * only. A frame with a wrong MAC gets no answer and changes
 * nothing. */
#ifndef ISO_DRIVERS_DOOR_OSDP_OSDP_PERIPHERAL_H
#define ISO_DRIVERS_DOOR_OSDP_OSDP_PERIPHERAL_H

#include "drivers/door/osdp/osdp_aes.h"
#include "drivers/door/osdp/osdp_display.h"
#include "drivers/door/osdp/osdp_packet.h"

#define ISO_OSDP_SILENCE_NS INT64_C(8000000000)   /* the panel is away after this time */
#define ISO_OSDP_INSTALL_NS INT64_C(120000000000) /* how long the install mode lasts */
/* The first frame of a new start (number 0) may look like that of the last start. It counts as
 * repeated within this time, and as a new start after it. */
#define ISO_OSDP_REPEAT_NS INT64_C(1000000000)
/* A frame whose bytes stop for this time is given up. Less than the 200 ms after which a panel
 * repeats its frame, and more than the delays of a serial driver. */
#define ISO_OSDP_GAP_NS INT64_C(100000000)

enum {
    ISO_OSDP_EVENTS = 32,     /* so many cards and groups of digits may wait */
    ISO_OSDP_CARD_BITS = 128, /* the longest card */
    ISO_OSDP_DIGITS = 16,     /* the most digits at once */
    ISO_OSDP_INPUTS = 8,
};

/* What survives a restart. */
struct iso_osdp_saved {
    uint8_t address; /* 0 to 0x7E */
    uint32_t baud;   /* 9600, 19200, 38400, 57600 or 115200 */
    bool has_key;
    uint8_t key[ISO_OSDP_KEY_BYTES]; /* the SCBK */
};

struct iso_osdp_setup {
    struct iso_osdp_saved saved;
    bool plain; /* plain frames are permitted: everyone on the wire reads and forges all of it */
    uint8_t vendor[3], model, version;
    uint32_t serial;
    uint8_t firmware[3]; /* major, minor, build */
    unsigned inputs;     /* how many inputs the panel may ask for, 0 to ISO_OSDP_INPUTS */

    /* Writes n random bytes; 0 or a negative errno, with which a challenge is refused. */
    int (*random)(void *context, void *bytes, size_t n);
    /* Stores address, speed and key, which the panel has changed, so that they survive a power cut;
     * 0 or a negative errno, with which the panel's command is refused. Called within
     * iso_osdp_peripheral_receive, before the reply. A reply that comes too late for this reason
     * does no harm, because the panel repeats its frame. */
    int (*store)(void *context, const struct iso_osdp_saved *saved);
    void *context;
};

/* The state of a device. */
struct iso_osdp_status {
    bool online;      /* the panel has sent a frame within ISO_OSDP_SILENCE_NS */
    bool secure;      /* the secure channel is open, with the panel's own key */
    bool default_key; /* the secure channel is open, with SCBK-D */
    bool install;     /* the install mode is on */
    bool has_key;
    uint8_t address;
    uint32_t baud;
    size_t waiting;       /* events in the queue */
    uint64_t commands;    /* that have been done */
    uint64_t repeated;    /* frames that the panel has repeated */
    uint64_t refused;     /* frames that had a wrong MAC, or were not permitted */
    uint64_t damaged;     /* as in struct iso_osdp_receiver */
    uint64_t delivered;   /* events that the panel has */
    uint64_t undelivered; /* events that were dropped, because the panel was away or started anew */
    uint64_t keys_set;    /* by KEYSET */
    struct iso_osdp_shown shown;
};

struct iso_osdp_peripheral;

/* Makes a device. -EINVAL the setup is not possible; -ENOMEM. */
int iso_osdp_peripheral_new(const struct iso_osdp_setup *setup, struct iso_osdp_peripheral **out)
    __attribute__((warn_unused_result));

/* Wipes all keys. NULL is fine. */
void iso_osdp_peripheral_free(struct iso_osdp_peripheral *peripheral);

/* Takes n bytes that arrived at now_ns, which never goes back. Returns the number of bytes of the
 * reply in reply[ISO_OSDP_FRAME_BYTES], or 0: there is nothing to send. If several frames have
 * arrived, the reply is for the last one, because the panel has given up the others. */
size_t iso_osdp_peripheral_receive(struct iso_osdp_peripheral *peripheral, const uint8_t *bytes,
                                   size_t n, int64_t now_ns, uint8_t *reply);

/* Has to be called after the reply has left the line. If the panel has changed address or speed by
 * COMSET, they hold from now on. Returns the speed of the line. */
uint32_t iso_osdp_peripheral_sent(struct iso_osdp_peripheral *peripheral);

/* Lets time pass: the panel falls silent, the install mode ends. */
void iso_osdp_peripheral_tick(struct iso_osdp_peripheral *peripheral, int64_t now_ns);

/* Lets a panel open a channel with the default key and set its own, for ISO_OSDP_INSTALL_NS or
 * until it has done so. */
void iso_osdp_peripheral_install(struct iso_osdp_peripheral *peripheral, int64_t now_ns);

/* Queues a card: `bits` bits (1 to ISO_OSDP_CARD_BITS), the first one in the highest bit of the
 * first byte. -ENOTCONN the panel is away, or its channel may not carry cards; -ENOBUFS the queue
 * is full; -EINVAL bits out of range. */
int iso_osdp_peripheral_card(struct iso_osdp_peripheral *peripheral, const uint8_t *bytes,
                             size_t bits) __attribute__((warn_unused_result));

/* Queues digits: 0 to 9, '*' and '#', at most ISO_OSDP_DIGITS. Errors as above. */
int iso_osdp_peripheral_digits(struct iso_osdp_peripheral *peripheral, const char *digits)
    __attribute__((warn_unused_result));

/* States that are reported whenever they change, and on request. The reader: 0 it works, 1 it is
 * not connected, 2 it has been tampered with. */
void iso_osdp_peripheral_set_tamper(struct iso_osdp_peripheral *peripheral, bool tamper);
void iso_osdp_peripheral_set_reader(struct iso_osdp_peripheral *peripheral, uint8_t reader);
void iso_osdp_peripheral_set_input(struct iso_osdp_peripheral *peripheral, unsigned input,
                                   bool active);

/* Copies the state. */
void iso_osdp_peripheral_status(const struct iso_osdp_peripheral *peripheral, int64_t now_ns,
                                struct iso_osdp_status *status);

/* Whether a line may have this speed. */
bool iso_osdp_is_baud(uint32_t baud);

#endif
