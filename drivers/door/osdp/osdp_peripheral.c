/* Which frames are accepted: address, sequence number, security. */
#include "drivers/door/osdp/osdp_peripheral.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/door/osdp/osdp_codes.h"
#include "drivers/door/osdp/osdp_peripheral_state.h"

_Static_assert((int)ISO__OSDP_ANSWER_BYTES <= (int)ISO_OSDP_SEALED_BYTES,
               "an answer can be encrypted");

/* ---- its owner ---- */

bool iso_osdp_is_baud(uint32_t baud)
{
    return baud == 9600 || baud == 19200 || baud == 38400 || baud == 57600 || baud == 115200;
}

int iso_osdp_peripheral_new(const struct iso_osdp_setup *setup, struct iso_osdp_peripheral **out)
{
    if (setup->saved.address >= ISO_OSDP_BROADCAST || !iso_osdp_is_baud(setup->saved.baud) ||
        setup->inputs > ISO_OSDP_INPUTS || !setup->random || !setup->store) {
        return -EINVAL;
    }
    struct iso_osdp_peripheral *new = calloc(1, sizeof *new);
    if (!new) {
        return -ENOMEM;
    }
    new->setup = *setup;
    new->sequence = -1;
    *out = new;
    return 0;
}

void iso_osdp_peripheral_free(struct iso_osdp_peripheral *peripheral)
{
    if (peripheral) {
        explicit_bzero(peripheral, sizeof *peripheral);
        free(peripheral);
    }
}

void iso_osdp_peripheral_install(struct iso_osdp_peripheral *peripheral, int64_t now_ns)
{
    peripheral->install = true;
    peripheral->install_end_ns = now_ns + ISO_OSDP_INSTALL_NS;
}

void iso__osdp_close(struct iso_osdp_peripheral *peripheral)
{
    iso_osdp_secure_close(&peripheral->secure);
    peripheral->default_key = false;
}

/* The panel has to begin anew. */
static void forget_panel(struct iso_osdp_peripheral *peripheral)
{
    iso__osdp_close(peripheral);
    peripheral->sequence = -1;
    explicit_bzero(peripheral->frame, sizeof peripheral->frame);
    explicit_bzero(peripheral->reply, sizeof peripheral->reply);
    peripheral->n_frame = peripheral->n_reply = 0;
}

void iso_osdp_peripheral_tick(struct iso_osdp_peripheral *peripheral, int64_t now_ns)
{
    if (peripheral->online && now_ns - peripheral->heard_ns >= ISO_OSDP_SILENCE_NS) {
        peripheral->online = false;
        iso__osdp_drop_events(peripheral);
        forget_panel(peripheral);
        /* The panel that comes back sets all this again. */
        memset(&peripheral->display, 0, sizeof peripheral->display);
    }
    if (peripheral->install && now_ns >= peripheral->install_end_ns) {
        peripheral->install = false;
        if (peripheral->default_key) {
            iso__osdp_flight_lost(peripheral);
            iso__osdp_close(peripheral);
        }
    }
}

uint32_t iso_osdp_peripheral_sent(struct iso_osdp_peripheral *peripheral)
{
    if (peripheral->has_next) {
        /* The key is not taken from there: it may have been set since. */
        peripheral->setup.saved.address = peripheral->next.address;
        peripheral->setup.saved.baud = peripheral->next.baud;
        peripheral->has_next = false;
        explicit_bzero(&peripheral->next, sizeof peripheral->next);
        iso__osdp_flight_lost(peripheral);
        forget_panel(peripheral);
    }
    return peripheral->setup.saved.baud;
}

void iso_osdp_peripheral_status(const struct iso_osdp_peripheral *peripheral, int64_t now_ns,
                                struct iso_osdp_status *status)
{
    const bool open = peripheral->secure.state == ISO_OSDP_OPEN;
    *status = peripheral->count;
    status->online = peripheral->online;
    status->secure = open && !peripheral->default_key;
    status->default_key = open && peripheral->default_key;
    status->install = peripheral->install;
    status->has_key = peripheral->setup.saved.has_key;
    status->address = peripheral->setup.saved.address;
    status->baud = peripheral->setup.saved.baud;
    status->waiting = peripheral->n_events;
    status->damaged = peripheral->receiver.damaged;
    iso_osdp_display_read(&peripheral->display, now_ns, &status->shown);
}

/* ---- replies ---- */

/* Makes the frame of an answer. Returns its length. */
static size_t make_frame(struct iso_osdp_peripheral *peripheral,
                         const struct iso_osdp_packet *packet,
                         const struct iso__osdp_answer *answer, bool secured, uint8_t *frame)
{
    const struct iso_osdp_header header = {
        .address = (uint8_t)(packet->address | ISO_OSDP_REPLY_BIT),
        .sequence = packet->sequence,
        .has_crc = packet->has_crc,
        .block = answer->block,
        .block_data = answer->block_data,
        .code = answer->code,
    };
    if (secured) {
        return iso_osdp_secure_frame(&peripheral->secure, &header, answer->data, answer->n, frame);
    }
    return iso_osdp_packet_end(frame,
                               iso_osdp_packet_begin(&header, answer->data, answer->n, frame));
}

/* Refuses a frame without remembering it: nothing has changed. */
static size_t refuse(struct iso_osdp_peripheral *peripheral, const struct iso_osdp_packet *packet,
                     enum iso_osdp_nak reason, uint8_t *reply)
{
    struct iso__osdp_answer answer;
    iso__osdp_nak(&answer, reason);
    peripheral->count.refused++;
    return make_frame(peripheral, packet, &answer, false, reply);
}

/* ---- frames ---- */

static size_t frame_size(const struct iso_osdp_packet *packet)
{
    return packet->n_signed + (packet->mac ? ISO_OSDP_MAC_BYTES : 0) + (packet->has_crc ? 2 : 1);
}

static bool is_repeated(const struct iso_osdp_peripheral *peripheral,
                        const struct iso_osdp_packet *packet, int64_t now_ns)
{
    return packet->sequence == peripheral->sequence &&
           (packet->sequence != 0 || now_ns - peripheral->heard_ns < ISO_OSDP_REPEAT_NS) &&
           frame_size(packet) == peripheral->n_frame &&
           memcmp(packet->frame, peripheral->frame, peripheral->n_frame) == 0;
}

static bool is_next(const struct iso_osdp_peripheral *peripheral,
                    const struct iso_osdp_packet *packet)
{
    return peripheral->sequence >= 0 && packet->sequence == peripheral->sequence % 3 + 1;
}

/* Commands that are done without the secure channel in any case, and in the install mode. */
static bool is_open_to_all(const struct iso_osdp_peripheral *peripheral, uint8_t command)
{
    return command == ISO_OSDP_ID || command == ISO_OSDP_CAP || command == ISO_OSDP_CHLNG ||
           command == ISO_OSDP_SCRYPT || (command == ISO_OSDP_COMSET && peripheral->install);
}

/* Does the command of a frame that is accepted, and remembers frame and reply. */
static size_t accept(struct iso_osdp_peripheral *peripheral, const struct iso_osdp_packet *packet,
                     const uint8_t *data, size_t n_data, int64_t now_ns, uint8_t *reply)
{
    struct iso__osdp_answer answer;
    const bool secured = packet->mac;
    const bool handshake = packet->code == ISO_OSDP_CHLNG && !secured;
    peripheral->online = true;
    peripheral->heard_ns = now_ns;
    if (packet->sequence == 0 || handshake) {
        /* A new start, which anyone on the wire can send: it does not prove that the panel has the
         * last event. */
        iso__osdp_flight_lost(peripheral);
        iso__osdp_close(peripheral);
    } else {
        iso__osdp_flight_arrived(peripheral);
    }
    if (!secured && !peripheral->setup.plain && !is_open_to_all(peripheral, packet->code)) {
        peripheral->count.refused++;
        iso__osdp_nak(&answer, ISO_OSDP_NAK_UNSECURED);
    } else {
        iso__osdp_do(peripheral, packet, data, n_data, now_ns, &answer);
        peripheral->count.commands++;
    }
    peripheral->sequence = packet->sequence;
    peripheral->n_frame = frame_size(packet);
    memcpy(peripheral->frame, packet->frame, peripheral->n_frame);
    peripheral->n_reply = make_frame(peripheral, packet, &answer, secured, peripheral->reply);
    memcpy(reply, peripheral->reply, peripheral->n_reply);
    explicit_bzero(&answer, sizeof answer);
    return peripheral->n_reply;
}

/* A frame with a MAC. */
static size_t take_secured(struct iso_osdp_peripheral *peripheral,
                           const struct iso_osdp_packet *packet, int64_t now_ns, uint8_t *reply)
{
    uint8_t data[ISO_OSDP_FRAME_BYTES] = {0};
    size_t n_data = 0;
    if (peripheral->secure.state != ISO_OSDP_OPEN) {
        return refuse(peripheral, packet, ISO_OSDP_NAK_BLOCK, reply);
    }
    const int error = iso_osdp_secure_open(&peripheral->secure, packet, data, &n_data);
    if (error == -EACCES) {
        peripheral->count.refused++;
        return 0;
    }
    /* Wrong padding under a right MAC: a fault of the panel. No command takes so much data. */
    const size_t n = accept(peripheral, packet, data, error ? ISO_OSDP_FRAME_BYTES : n_data, now_ns,
                            reply);
    explicit_bzero(data, sizeof data);
    return n;
}

static size_t take(struct iso_osdp_peripheral *peripheral, const struct iso_osdp_packet *packet,
                   int64_t now_ns, uint8_t *reply)
{
    const bool ours = packet->address == peripheral->setup.saved.address ||
                      packet->address == ISO_OSDP_BROADCAST;
    if (packet->is_reply || !ours) {
        return 0;
    }
    if (is_repeated(peripheral, packet, now_ns)) {
        /* This is no sign of the panel, because anyone on the wire can repeat a frame. */
        peripheral->count.repeated++;
        memcpy(reply, peripheral->reply, peripheral->n_reply);
        return peripheral->n_reply;
    }
    const bool restart = packet->sequence == 0 && !packet->mac;
    if (!restart && !is_next(peripheral, packet)) {
        return refuse(peripheral, packet, ISO_OSDP_NAK_SEQUENCE, reply);
    }
    if (packet->mac) {
        return take_secured(peripheral, packet, now_ns, reply);
    }
    if (packet->block != ISO_OSDP_SCS_NONE && packet->code != ISO_OSDP_CHLNG &&
        packet->code != ISO_OSDP_SCRYPT) {
        return refuse(peripheral, packet, ISO_OSDP_NAK_BLOCK, reply);
    }
    if (peripheral->secure.state == ISO_OSDP_OPEN && !restart && packet->code != ISO_OSDP_CHLNG) {
        return refuse(peripheral, packet, ISO_OSDP_NAK_UNSECURED, reply);
    }
    return accept(peripheral, packet, packet->data, packet->n_data, now_ns, reply);
}

size_t iso_osdp_peripheral_receive(struct iso_osdp_peripheral *peripheral, const uint8_t *bytes,
                                   size_t n, int64_t now_ns, uint8_t *reply)
{
    struct iso_osdp_packet packet;
    size_t n_reply = 0;
    iso_osdp_peripheral_tick(peripheral, now_ns);
    if (n > 0 && now_ns - peripheral->bytes_ns >= ISO_OSDP_GAP_NS) {
        iso_osdp_receiver_reset(&peripheral->receiver);
    }
    peripheral->bytes_ns = n > 0 ? now_ns : peripheral->bytes_ns;
    for (size_t i = 0; i < n; i++) {
        bool whole = iso_osdp_receiver_push(&peripheral->receiver, bytes[i], &packet);
        while (whole) {
            const size_t taken = take(peripheral, &packet, now_ns, reply);
            n_reply = taken ? taken : n_reply;
            whole = iso_osdp_receiver_next(&peripheral->receiver, &packet);
        }
    }
    return n_reply;
}
