/* The events of a device, and the states that it reports. */
#include <errno.h>
#include <string.h>

#include "core/base/bytes.h"
#include "drivers/door/osdp/osdp_codes.h"
#include "drivers/door/osdp/osdp_peripheral_state.h"

bool iso__osdp_may_carry_events(const struct iso_osdp_peripheral *peripheral)
{
    const bool own_key = peripheral->secure.state == ISO_OSDP_OPEN && !peripheral->default_key;
    return peripheral->online && (own_key || peripheral->setup.plain);
}

static void drop_first_event(struct iso_osdp_peripheral *peripheral)
{
    explicit_bzero(&peripheral->events[peripheral->first_event], sizeof peripheral->events[0]);
    peripheral->first_event = (peripheral->first_event + 1) % ISO_OSDP_EVENTS;
    peripheral->n_events--;
}

void iso__osdp_flight_arrived(struct iso_osdp_peripheral *peripheral)
{
    if (peripheral->flight == ISO__OSDP_FLIGHT_EVENT) {
        drop_first_event(peripheral);
        peripheral->count.delivered++;
    }
    peripheral->flight = ISO__OSDP_FLIGHT_NONE;
}

void iso__osdp_flight_lost(struct iso_osdp_peripheral *peripheral)
{
    if (peripheral->flight == ISO__OSDP_FLIGHT_EVENT) {
        drop_first_event(peripheral);
        peripheral->count.undelivered++;
    } else if (peripheral->flight == ISO__OSDP_FLIGHT_REPORT) {
        /* A state may be told twice. */
        peripheral->reports |= peripheral->flight_report;
    }
    peripheral->flight = ISO__OSDP_FLIGHT_NONE;
}

void iso__osdp_drop_events(struct iso_osdp_peripheral *peripheral)
{
    iso__osdp_flight_lost(peripheral);
    while (peripheral->n_events > 0) {
        drop_first_event(peripheral);
        peripheral->count.undelivered++;
    }
}

/* Returns a new event at the end of the queue, or NULL with the error. */
static struct iso__osdp_event *add_event(struct iso_osdp_peripheral *peripheral, int *error)
{
    if (!iso__osdp_may_carry_events(peripheral)) {
        *error = -ENOTCONN;
        return NULL;
    }
    if (peripheral->n_events == ISO_OSDP_EVENTS) {
        *error = -ENOBUFS;
        return NULL;
    }
    const size_t at = (peripheral->first_event + peripheral->n_events++) % ISO_OSDP_EVENTS;
    *error = 0;
    return &peripheral->events[at];
}

int iso_osdp_peripheral_card(struct iso_osdp_peripheral *peripheral, const uint8_t *bytes,
                             size_t bits)
{
    int error = -EINVAL;
    struct iso__osdp_event *event = bits >= 1 && bits <= ISO_OSDP_CARD_BITS
                                        ? add_event(peripheral, &error)
                                        : NULL;
    if (event) {
        const size_t n = (bits + 7) / 8;
        /* Reader 0, bits in the form of Wiegand. */
        uint8_t *at = event->data;
        *at++ = 0;
        *at++ = 1;
        at = iso_put_u16(at, (uint16_t)bits);
        (void)iso_put_bytes(at, bytes, n);
        event->code = ISO_OSDP_RAW;
        event->n = (uint8_t)(4 + n);
        if (bits % 8) {
            /* The bits after the last one are 0. */
            event->data[3 + n] &= (uint8_t)(0xFF << (8 - bits % 8));
        }
    }
    return error;
}

/* The code of a key on the keypad; 0 there is no such key. */
static uint8_t key_code(char digit)
{
    return digit >= '0' && digit <= '9' ? (uint8_t)digit
           : digit == '*'               ? 0x7F
           : digit == '#'               ? 0x0D
                                        : 0;
}

int iso_osdp_peripheral_digits(struct iso_osdp_peripheral *peripheral, const char *digits)
{
    const size_t n = strnlen(digits, ISO_OSDP_DIGITS + 1);
    bool right = n >= 1 && n <= ISO_OSDP_DIGITS;
    for (size_t i = 0; right && i < n; i++) {
        right = key_code(digits[i]) != 0;
    }
    int error = -EINVAL;
    struct iso__osdp_event *event = right ? add_event(peripheral, &error) : NULL;
    if (event) {
        event->code = ISO_OSDP_KEYPAD;
        event->n = (uint8_t)(2 + n);
        event->data[0] = 0;
        event->data[1] = (uint8_t)n;
        for (size_t i = 0; i < n; i++) {
            event->data[2 + i] = key_code(digits[i]);
        }
    }
    return error;
}

/* ---- states ---- */

void iso_osdp_peripheral_set_tamper(struct iso_osdp_peripheral *peripheral, bool tamper)
{
    if (peripheral->tamper != tamper) {
        peripheral->tamper = tamper;
        peripheral->reports |= ISO__OSDP_REPORT_LOCAL;
    }
}

void iso_osdp_peripheral_set_reader(struct iso_osdp_peripheral *peripheral, uint8_t reader)
{
    if (peripheral->reader != reader) {
        peripheral->reader = reader;
        peripheral->reports |= ISO__OSDP_REPORT_READER;
    }
}

void iso_osdp_peripheral_set_input(struct iso_osdp_peripheral *peripheral, unsigned input,
                                   bool active)
{
    if (input < peripheral->setup.inputs && peripheral->input[input] != active) {
        peripheral->input[input] = active;
        peripheral->reports |= ISO__OSDP_REPORT_INPUTS;
    }
}

void iso__osdp_put_local(const struct iso_osdp_peripheral *peripheral,
                         struct iso__osdp_answer *answer)
{
    answer->code = ISO_OSDP_LSTATR;
    answer->n = 2;
    answer->data[0] = peripheral->tamper;
    answer->data[1] = 0; /* the supply: the daemon runs, so it is there */
}

void iso__osdp_put_reader(const struct iso_osdp_peripheral *peripheral,
                          struct iso__osdp_answer *answer)
{
    answer->code = ISO_OSDP_RSTATR;
    answer->n = 1;
    answer->data[0] = peripheral->reader;
}

void iso__osdp_put_inputs(const struct iso_osdp_peripheral *peripheral,
                          struct iso__osdp_answer *answer)
{
    answer->code = ISO_OSDP_ISTATR;
    answer->n = peripheral->setup.inputs;
    for (unsigned i = 0; i < peripheral->setup.inputs; i++) {
        answer->data[i] = peripheral->input[i];
    }
}

static void send_report(struct iso_osdp_peripheral *peripheral, struct iso__osdp_answer *answer)
{
    if (peripheral->reports & ISO__OSDP_REPORT_LOCAL) {
        peripheral->flight_report = ISO__OSDP_REPORT_LOCAL;
        iso__osdp_put_local(peripheral, answer);
    } else if (peripheral->reports & ISO__OSDP_REPORT_READER) {
        peripheral->flight_report = ISO__OSDP_REPORT_READER;
        iso__osdp_put_reader(peripheral, answer);
    } else {
        peripheral->flight_report = ISO__OSDP_REPORT_INPUTS;
        iso__osdp_put_inputs(peripheral, answer);
    }
    peripheral->reports &= ~peripheral->flight_report;
    peripheral->flight = ISO__OSDP_FLIGHT_REPORT;
}

void iso__osdp_poll(struct iso_osdp_peripheral *peripheral, struct iso__osdp_answer *answer)
{
    if (peripheral->reports) {
        send_report(peripheral, answer);
    } else if (peripheral->n_events > 0 && iso__osdp_may_carry_events(peripheral)) {
        const struct iso__osdp_event *event = &peripheral->events[peripheral->first_event];
        answer->code = event->code;
        answer->n = event->n;
        memcpy(answer->data, event->data, event->n);
        peripheral->flight = ISO__OSDP_FLIGHT_EVENT;
    }
}
