#include "drivers/reader/wiegand_frame.h"

#include <stdlib.h>

#include "drivers/door/wiegand.h"

enum { KEY_BITS = 4, KEY_BYTE_BITS = 8, CARD_BITS_MIN = 26 };

void iso_wiegand_frame_pulse(struct iso_wiegand_frame *frame, bool one, int64_t t_ns)
{
    if (frame->n < ISO_WIEGAND_BITS_MAX) {
        frame->pulses[frame->n].t_ns = t_ns;
        frame->pulses[frame->n].one = one;
    }
    frame->n++;
    frame->latest_ns = frame->n == 1 || t_ns > frame->latest_ns ? t_ns : frame->latest_ns;
}

int64_t iso_wiegand_frame_due_ns(const struct iso_wiegand_frame *frame)
{
    return frame->n > 0 ? frame->latest_ns + ISO_WIEGAND_GAP_NS : INT64_MAX;
}

/* Insertion sort: the pulses are nearly in order. */
static void put_in_order(struct iso_wiegand_frame *frame)
{
    for (int i = 1; i < frame->n; i++) {
        for (int j = i; j > 0 && frame->pulses[j].t_ns < frame->pulses[j - 1].t_ns; j--) {
            const int64_t t_ns = frame->pulses[j].t_ns;
            const bool one = frame->pulses[j].one;
            frame->pulses[j] = frame->pulses[j - 1];
            frame->pulses[j - 1].t_ns = t_ns;
            frame->pulses[j - 1].one = one;
        }
    }
}

static struct iso_reader_event key_of(uint64_t code, int bits)
{
    static const char keys[] = "0123456789*#";
    const unsigned number = (unsigned)(code & 15);
    const bool sound = bits == KEY_BITS || (code >> 4) == (~code & 15);
    return sound && number < sizeof keys - 1
               ? (struct iso_reader_event){.kind = ISO_READER_KEY, .key = keys[number]}
               : (struct iso_reader_event){.kind = ISO_READER_DAMAGED};
}

static struct iso_reader_event event_of(uint64_t code, int bits)
{
    struct iso_wiegand_card card;
    if (bits == KEY_BITS || bits == KEY_BYTE_BITS) {
        return key_of(code, bits);
    }
    const bool has_parity = bits == 26 || bits == 34;
    if (bits < CARD_BITS_MIN || bits == 33 ||
        (has_parity && iso_wiegand_decode(bits, code, &card))) {
        return (struct iso_reader_event){.kind = ISO_READER_DAMAGED};
    }
    return (struct iso_reader_event){.kind = ISO_READER_CARD, .bits = (uint8_t)bits, .code = code};
}

struct iso_reader_event iso_wiegand_frame_time(struct iso_wiegand_frame *frame, int64_t now_ns)
{
    if (now_ns < iso_wiegand_frame_due_ns(frame)) {
        return (struct iso_reader_event){.kind = ISO_READER_NOTHING};
    }
    struct iso_reader_event event = {.kind = ISO_READER_DAMAGED};
    if (frame->n <= ISO_WIEGAND_BITS_MAX) {
        uint64_t code = 0;
        put_in_order(frame);
        for (int i = 0; i < frame->n; i++) {
            code = code << 1 | frame->pulses[i].one;
        }
        event = event_of(code, frame->n);
    }
    event.t_ns = frame->latest_ns;
    *frame = (struct iso_wiegand_frame){.n = 0};
    return event;
}
