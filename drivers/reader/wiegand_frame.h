/* From the pulses of a Wiegand reader to cards and keys. Pure: time is an argument. */
/* clang-format off */
/*   pulses on D0 (0) and D1 (1) --25 ms without a pulse--> a frame of n bits
 *
 *        26 or 34 bits, right parity     a card: facility and number (drivers/door/wiegand.h)
 *        4 bits                          a key: 0 to 9, 10 is '*', 11 is '#'
 *        8 bits                          a key: the same in the low half, its complement in the high
 *        27 to 64 other bits             a card: the code as it is
 *        otherwise                       damaged: noise, lost pulses, a wrong parity. 33 bits are a
 *                                        card of 34 that has lost one */
/* clang-format on */
/* Readers send a pulse every 0.2 to 20 ms. The two lines are read one after the other, so that the
 * pulses come out of order; their times put them right. */
#ifndef ISO_DRIVERS_READER_WIEGAND_FRAME_H
#define ISO_DRIVERS_READER_WIEGAND_FRAME_H

#include <stdbool.h>
#include <stdint.h>

#define ISO_WIEGAND_GAP_NS INT64_C(25000000) /* the end of a frame */

enum { ISO_WIEGAND_BITS_MAX = 64 };

enum iso_reader_event_kind {
    ISO_READER_NOTHING = 0,
    ISO_READER_CARD,
    ISO_READER_KEY,
    ISO_READER_DAMAGED,
};

struct iso_reader_event {
    enum iso_reader_event_kind kind;
    uint8_t bits;  /* CARD: 1 to 64 */
    uint64_t code; /* CARD: its first bit is the most significant of `bits` */
    char key;      /* KEY: '0' to '9', '*', '#' */
    int64_t t_ns;  /* of its last pulse or byte, by CLOCK_MONOTONIC */
};

/* All zero: no pulse yet. */
struct iso_wiegand_frame {
    int n; /* pulses; more than ISO_WIEGAND_BITS_MAX are counted and not kept */
    int64_t latest_ns;
    struct {
        int64_t t_ns;
        bool one;
    } pulses[ISO_WIEGAND_BITS_MAX];
};

/* A pulse of this time. */
void iso_wiegand_frame_pulse(struct iso_wiegand_frame *frame, bool one, int64_t t_ns);

/* When the frame ends; INT64_MAX if there is none. */
int64_t iso_wiegand_frame_due_ns(const struct iso_wiegand_frame *frame);

/* The event of a frame that has ended at now_ns, which begins a new one; else NOTHING. */
struct iso_reader_event iso_wiegand_frame_time(struct iso_wiegand_frame *frame, int64_t now_ns);

#endif
