/* The access panel to which the appliance belongs, over OSDP (drivers/door/osdp). It gets the card
 * of each person who is let in, and says what the door station shows. The lock stays the
 * appliance's: the panel has a lock and a door of its own, or decides by the card. */
#ifndef ISO_FIRMWARE_PANEL_PANEL_H
#define ISO_FIRMWARE_PANEL_PANEL_H

#include "core/base/clock.h"
#include "core/base/fault.h"
#include "drivers/door/osdp/osdp_port.h"
#include "drivers/door/wiegand.h"
#include "firmware/keys/key_ring.h"

struct iso_panel_options {
    const char *port;          /* the serial line */
    uint8_t address;           /* of this device, unless the panel has set another one */
    uint32_t baud;             /* the same */
    bool plain;                /* plain frames are permitted */
    int card_bits;             /* 26 or 34, the format of a card (wiegand.h) */
    const char *path;          /* the file of panel_file.h */
    struct iso_key_ring *ring; /* its keys of the use ISO_KEY_PANEL belong to the panel */
    struct iso_clock clock;    /* the clock of the machine */
};

struct iso_panel;

/* Reads the file, makes a key for it if the ring has none, opens the line and starts its thread. A
 * file that cannot be used does not prevent this (the panel has to set its key again), nor does a
 * line that may appear later; iso_panel_fault tells of both. The errors of iso_key_ring_add and
 * iso_osdp_port_new. */
int iso_panel_open(const struct iso_panel_options *options, struct iso_panel **out,
                   struct iso_fault *fault) __attribute__((warn_unused_result));

/* Ends the thread, closes the line, wipes the keys. NULL is accepted. */
void iso_panel_close(struct iso_panel *panel);

/* Becomes readable when iso_panel_next has news. */
int iso_panel_fd(const struct iso_panel *panel);

/* Queues a card for the panel. -ENOTCONN the panel is away, or its channel may not carry cards;
 * -ENOBUFS too many cards wait; -ERANGE the number does not fit the format. */
int iso_panel_send_card(struct iso_panel *panel, const struct iso_wiegand_card *card,
                        struct iso_fault *fault) __attribute__((warn_unused_result));

/* Tell the panel the state of the door, as its input 0 (open) and as tamper of the device, and
 * whether the reader, which is the sensor, works. Only changes are sent. */
void iso_panel_set_door(struct iso_panel *panel, bool open, bool tamper);
void iso_panel_set_reader(struct iso_panel *panel, bool works);

/* Lets the panel set its key by the default key, for two minutes. */
void iso_panel_install(struct iso_panel *panel);

/* What has changed. */
struct iso_panel_news {
    const char *event; /* a word: "online", "offline", "secure", "default-key", "closed" (the secure
                        * channel), "key-set", "moved" (another address or speed), "undelivered",
                        * "line-gone", "line-back", "install-end" */
    char note[64];     /* more about it, or "" */
    bool alarm;        /* a person should look at it */
};

/* Takes the next change; false: there is none. In one minute there are at most ISO_PANEL_NEWS_MOST,
 * because anyone on the wire can cause changes, and each goes to the log. What has changed in
 * between is told afterwards. */
enum { ISO_PANEL_NEWS_MOST = 20 };
bool iso_panel_next(struct iso_panel *panel, int64_t now_ns, struct iso_panel_news *news);

/* When iso_panel_next has more to tell although its descriptor is not readable; INT64_MAX: never.
 */
int64_t iso_panel_due_ns(const struct iso_panel *panel);

/* The present state. */
struct iso_panel_look {
    const char *state; /* "gone" (the line), "offline", "waiting" (without a channel that it needs),
                        * "default-key", "plain", "secure" */
    bool install, has_key;
    const char
        *lamp; /* a word: "off", "red", "green", "amber", "blue", "magenta", "cyan", "white" */
    struct iso_osdp_shown shown;
    struct iso_fault
        fault; /* PANEL_LINE, PANEL_SILENT, PANEL_KEY; its text is "" while all is well */
    uint64_t delivered, undelivered;
};
void iso_panel_look(struct iso_panel *panel, struct iso_panel_look *look);

/* Why the file or the line could not be used at the start; its text is "" if they could. */
const struct iso_fault *iso_panel_fault(const struct iso_panel *panel);

#endif
