/* What the replies of a reader say. */
#include <string.h>

#include "core/base/bytes.h"
#include "drivers/door/osdp/osdp_codes.h"
#include "drivers/door/wiegand.h"
#include "drivers/reader/osdp_reader_state.h"

enum {
    CARD_BITS_MIN = 5, /* as on Wiegand lines */
    CARD_BITS_MAX = 64,
    WIEGAND_FORM = 1, /* of RAW: the bits have parities */
    KEY_STAR = 0x7F,
    KEY_HASH = 0x0D,
    CCRYPT_BYTES = 8 + ISO_OSDP_RANDOM_BYTES + ISO_OSDP_KEY_BYTES,
};

/* ---- events ---- */

static void add_event(struct iso_osdp_reader *reader, const struct iso_reader_event *event)
{
    if (reader->n_events == ISO_OSDP_READER_EVENTS) {
        reader->count.dropped++;
        return;
    }
    const size_t at = (reader->first_event + reader->n_events++) % ISO_OSDP_READER_EVENTS;
    reader->events[at] = *event;
    reader->events[at].t_ns = reader->heard_ns;
    reader->count.events++;
}

static void add_damaged(struct iso_osdp_reader *reader)
{
    add_event(reader, &(struct iso_reader_event){.kind = ISO_READER_DAMAGED});
}

/* RAW: number of the reader, form, number of bits u16, bits. */
static void take_card(struct iso_osdp_reader *reader, const struct iso__osdp_reply *reply)
{
    const unsigned bits = reply->n >= 4 ? iso_get_u16(reply->data + 2) : 0;
    if (bits < CARD_BITS_MIN || bits > CARD_BITS_MAX || reply->n - 4 < (bits + 7) / 8) {
        add_damaged(reader);
        return;
    }
    struct iso_reader_event event = {.kind = ISO_READER_CARD, .bits = (uint8_t)bits};
    for (unsigned i = 0; i < bits; i++) {
        event.code = event.code << 1 | (reply->data[4 + i / 8] >> (7 - i % 8) & 1);
    }
    struct iso_wiegand_card card;
    const bool has_parity = reply->data[1] == WIEGAND_FORM && (bits == 26 || bits == 34);
    if (has_parity && iso_wiegand_decode((int)bits, event.code, &card)) {
        add_damaged(reader);
    } else {
        add_event(reader, &event);
    }
    explicit_bzero(&event, sizeof event);
}

/* KEYPAD: number of the reader, number of keys, keys. Other keys, such as F1, are no digits of a
 * PIN. */
static void take_keys(struct iso_osdp_reader *reader, const struct iso__osdp_reply *reply)
{
    if (reply->n < 2 || reply->n - 2 < reply->data[1]) {
        add_damaged(reader);
        return;
    }
    for (size_t i = 0; i < reply->data[1]; i++) {
        const uint8_t code = reply->data[2 + i];
        struct iso_reader_event event = {.kind = ISO_READER_KEY};
        event.key = code >= '0' && code <= '9' ? (char)code
                    : code == KEY_STAR         ? '*'
                    : code == KEY_HASH         ? '#'
                                               : '\0';
        if (event.key) {
            add_event(reader, &event);
        }
        explicit_bzero(&event, sizeof event);
    }
}

/* A card or keys. */
static enum iso__osdp_next take_event(struct iso_osdp_reader *reader,
                                      const struct iso__osdp_reply *reply)
{
    if (reader->draining) {
        reader->count.stale++;
    } else if (reply->code == ISO_OSDP_RAW) {
        take_card(reader, reply);
    } else if (reply->code == ISO_OSDP_KEYPAD) {
        take_keys(reader, reply);
    } else {
        /* FMT: a card as text, in a form that the maker of the reader has chosen. */
        add_damaged(reader);
    }
    return ISO__OSDP_NEXT_SOON;
}

/* ---- states ---- */

static enum iso__osdp_next take_state(struct iso_osdp_reader *reader,
                                      const struct iso__osdp_reply *reply)
{
    if (reply->code == ISO_OSDP_LSTATR && reply->n >= 1) {
        reader->tamper = reply->data[0] != 0;
    } else if (reply->code == ISO_OSDP_RSTATR && reply->n >= 1) {
        reader->unit_tamper = reply->data[0] != 0;
    }
    return ISO__OSDP_NEXT_SOON;
}

static enum iso__osdp_next take_content(struct iso_osdp_reader *reader,
                                        const struct iso__osdp_reply *reply)
{
    switch (reply->code) {
    case ISO_OSDP_RAW:
    case ISO_OSDP_FMT:
    case ISO_OSDP_KEYPAD:
        return take_event(reader, reply);
    case ISO_OSDP_LSTATR:
    case ISO_OSDP_RSTATR:
        return take_state(reader, reply);
    default:
        return ISO__OSDP_NEXT_POLL;
    }
}

/* A reply in the conversation after the start. */
static enum iso__osdp_next take_common(struct iso_osdp_reader *reader,
                                       const struct iso__osdp_reply *reply)
{
    reader->online = true;
    reader->step = ISO__OSDP_STEP_POLL;
    if (reader->polls && reply->code == ISO_OSDP_ACK) {
        /* The reader has kept nothing. */
        reader->draining = false;
    }
    if (!reader->draining) {
        reader->worked_ns = reader->heard_ns;
        reader->problem = ISO_OSDP_READER_FINE;
    }
    return take_content(reader, reply);
}

/* ---- the start ---- */

static enum iso__osdp_next fail(struct iso_osdp_reader *reader,
                                enum iso_osdp_reader_problem problem)
{
    reader->problem = problem;
    return ISO__OSDP_NEXT_RESTART;
}

/* CCRYPT: identity of the reader, RND.B, client cryptogram. */
static enum iso__osdp_next take_ccrypt(struct iso_osdp_reader *reader,
                                       const struct iso__osdp_reply *reply)
{
    if (reply->code != ISO_OSDP_CCRYPT || reply->block != ISO_OSDP_SCS_12 ||
        reply->n != CCRYPT_BYTES) {
        return fail(reader, ISO_OSDP_READER_REFUSES);
    }
    const uint8_t *rnd_b = reply->data + 8;
    if (iso_osdp_secure_answer(&reader->secure, rnd_b, rnd_b + ISO_OSDP_RANDOM_BYTES,
                               reader->proof)) {
        return fail(reader, ISO_OSDP_READER_OTHER_KEY);
    }
    reader->step = ISO__OSDP_STEP_PROOF;
    return ISO__OSDP_NEXT_SOON;
}

static enum iso__osdp_next take_rmac_i(struct iso_osdp_reader *reader,
                                       const struct iso__osdp_reply *reply)
{
    explicit_bzero(reader->proof, sizeof reader->proof);
    if (reply->code != ISO_OSDP_RMAC_I || reply->block != ISO_OSDP_SCS_14 ||
        reply->n != ISO_OSDP_KEY_BYTES || iso_osdp_secure_confirm(&reader->secure, reply->data)) {
        return fail(reader, ISO_OSDP_READER_OTHER_KEY);
    }
    reader->step = ISO__OSDP_STEP_STATE;
    return ISO__OSDP_NEXT_SOON;
}

/* Whether a NAK says that the two sides do not understand each other any more. */
static bool is_break(const struct iso__osdp_reply *reply)
{
    const uint8_t reason = reply->n >= 1 ? reply->data[0] : 0;
    return reason == ISO_OSDP_NAK_SEQUENCE || reason == ISO_OSDP_NAK_BLOCK ||
           reason == ISO_OSDP_NAK_UNSECURED;
}

static enum iso__osdp_next take_nak(struct iso_osdp_reader *reader,
                                    const struct iso__osdp_reply *reply)
{
    const bool plain = !reader->setup.has_key;
    if (reader->step >= ISO__OSDP_STEP_STATE && is_break(reply)) {
        return plain && reply->data[0] != ISO_OSDP_NAK_SEQUENCE
                   ? fail(reader, ISO_OSDP_READER_WANTS_KEY)
                   : ISO__OSDP_NEXT_RESTART;
    }
    return take_common(reader, reply);
}

enum iso__osdp_next iso__osdp_reader_reply(struct iso_osdp_reader *reader,
                                           const struct iso__osdp_reply *reply)
{
    switch (reader->step) {
    case ISO__OSDP_STEP_ID:
        /* PDID: vendor, model, version, serial number, firmware. A reader may refuse to tell. */
        if (reply->code == ISO_OSDP_PDID && reply->n >= 9) {
            reader->count.serial = iso_get_u32(reply->data + 5);
        }
        reader->step = ISO__OSDP_STEP_CAP;
        return ISO__OSDP_NEXT_SOON;
    case ISO__OSDP_STEP_CAP:
        reader->step = reader->setup.has_key ? ISO__OSDP_STEP_CHALLENGE : ISO__OSDP_STEP_STATE;
        return ISO__OSDP_NEXT_SOON;
    case ISO__OSDP_STEP_CHALLENGE:
        return take_ccrypt(reader, reply);
    case ISO__OSDP_STEP_PROOF:
        return take_rmac_i(reader, reply);
    default:
        return reply->code == ISO_OSDP_NAK ? take_nak(reader, reply) : take_common(reader, reply);
    }
}
