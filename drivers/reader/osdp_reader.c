/* Which commands are sent, and which replies count. */
#include "drivers/reader/osdp_reader.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/door/osdp/osdp_codes.h"
#include "drivers/door/osdp/osdp_peripheral.h"
#include "drivers/reader/osdp_reader_state.h"

enum {
    REPLY_BYTES = 96,    /* the longest reply that is common: PDCAP in a secure channel */
    BITS_OF_A_BYTE = 10, /* with the start and the stop bit */
    OWN_KEY = 1,         /* in a block of the handshake: the key is the reader's own */
};

/* A command before it is put into a frame. */
struct command {
    uint8_t code, block;
    int block_data;
    uint8_t data[ISO_OSDP_KEY_BYTES];
    size_t n;
};

/* ---- its owner ---- */

/* The beginning of a conversation, with a first command at due_ns. */
static void begin(struct iso_osdp_reader *reader, int64_t now_ns, int64_t due_ns)
{
    iso_osdp_secure_close(&reader->secure);
    explicit_bzero(reader->proof, sizeof reader->proof);
    explicit_bzero(reader->frame, sizeof reader->frame);
    iso_osdp_receiver_reset(&reader->receiver);
    reader->step = ISO__OSDP_STEP_ID;
    reader->sequence = 0;
    reader->waits = reader->online = reader->tamper = reader->unit_tamper = false;
    reader->draining = true;
    reader->show = 0;
    reader->heard_ns = now_ns;
    reader->due_ns = due_ns;
}

int iso_osdp_reader_new(const struct iso_osdp_reader_setup *setup, int64_t now_ns,
                        struct iso_osdp_reader **out)
{
    if (setup->address >= ISO_OSDP_BROADCAST || !iso_osdp_is_baud(setup->baud) ||
        (setup->has_key && !setup->random)) {
        return -EINVAL;
    }
    struct iso_osdp_reader *new = calloc(1, sizeof *new);
    if (!new) {
        return -ENOMEM;
    }
    new->setup = *setup;
    new->worked_ns = now_ns;
    begin(new, now_ns, now_ns);
    *out = new;
    return 0;
}

void iso_osdp_reader_free(struct iso_osdp_reader *reader)
{
    if (reader) {
        explicit_bzero(reader, sizeof *reader);
        free(reader);
    }
}

static void start_anew(struct iso_osdp_reader *reader, int64_t now_ns, int64_t due_ns)
{
    reader->count.starts++;
    begin(reader, now_ns, due_ns);
}

void iso_osdp_reader_restart(struct iso_osdp_reader *reader, int64_t now_ns)
{
    start_anew(reader, now_ns, now_ns);
}

bool iso_osdp_reader_take(struct iso_osdp_reader *reader, struct iso_reader_event *out)
{
    if (reader->n_events == 0) {
        return false;
    }
    *out = reader->events[reader->first_event];
    explicit_bzero(&reader->events[reader->first_event], sizeof reader->events[0]);
    reader->first_event = (reader->first_event + 1) % ISO_OSDP_READER_EVENTS;
    reader->n_events--;
    return true;
}

void iso_osdp_reader_show(struct iso_osdp_reader *reader, bool allow)
{
    if (reader->online) {
        reader->show = ISO__OSDP_SHOW_LAMP | ISO__OSDP_SHOW_TONE;
        reader->show_allow = allow;
    }
}

void iso_osdp_reader_status(const struct iso_osdp_reader *reader,
                            struct iso_osdp_reader_status *status)
{
    *status = reader->count;
    status->online = reader->online;
    status->secure = reader->secure.state == ISO_OSDP_OPEN;
    status->damaged = reader->receiver.damaged;
    status->problem = reader->problem == ISO_OSDP_READER_FINE &&
                              (reader->tamper || reader->unit_tamper)
                          ? ISO_OSDP_READER_TAMPERED
                          : reader->problem;
}

/* ---- commands ---- */

static struct command lamp_command(bool allow)
{
    /* Reader 0, lamp 0: the colour for 20 times 100 ms; then the reader shows its own again. */
    const uint8_t color = allow ? ISO_OSDP_GREEN : ISO_OSDP_RED;
    struct command command = {.code = ISO_OSDP_LED, .n = 14};
    const uint8_t data[] = {0, 0, 2, 1, 0, color, color, 20, 0};
    memcpy(command.data, data, sizeof data);
    return command;
}

static struct command tone_command(bool allow)
{
    /* Reader 0, the common tone: for 200 ms, or three times for 100 ms. */
    const uint8_t data[] = {0, 2, allow ? 2 : 1, 1, allow ? 1 : 3};
    struct command command = {.code = ISO_OSDP_BUZ, .n = sizeof data};
    memcpy(command.data, data, sizeof data);
    return command;
}

static struct command common_command(struct iso_osdp_reader *reader)
{
    if (reader->show & ISO__OSDP_SHOW_LAMP) {
        reader->show &= ~(unsigned)ISO__OSDP_SHOW_LAMP;
        return lamp_command(reader->show_allow);
    }
    if (reader->show & ISO__OSDP_SHOW_TONE) {
        reader->show &= ~(unsigned)ISO__OSDP_SHOW_TONE;
        return tone_command(reader->show_allow);
    }
    return (struct command){.code = ISO_OSDP_POLL};
}

static int make_challenge(struct iso_osdp_reader *reader, struct command *command)
{
    const struct iso_osdp_reader_setup *setup = &reader->setup;
    const int error = setup->random(setup->context, command->data, ISO_OSDP_RANDOM_BYTES);
    if (!error) {
        command->code = ISO_OSDP_CHLNG;
        command->block = ISO_OSDP_SCS_11;
        command->block_data = OWN_KEY;
        command->n = ISO_OSDP_RANDOM_BYTES;
        iso_osdp_secure_request(&reader->secure, setup->key, command->data);
    }
    return error;
}

static int make_command(struct iso_osdp_reader *reader, struct command *command)
{
    switch (reader->step) {
    case ISO__OSDP_STEP_ID:
        *command = (struct command){.code = ISO_OSDP_ID, .n = 1};
        return 0;
    case ISO__OSDP_STEP_CAP:
        *command = (struct command){.code = ISO_OSDP_CAP, .n = 1};
        return 0;
    case ISO__OSDP_STEP_CHALLENGE:
        return make_challenge(reader, command);
    case ISO__OSDP_STEP_PROOF:
        *command = (struct command){.code = ISO_OSDP_SCRYPT,
                                    .block = ISO_OSDP_SCS_13,
                                    .block_data = OWN_KEY,
                                    .n = ISO_OSDP_KEY_BYTES};
        memcpy(command->data, reader->proof, ISO_OSDP_KEY_BYTES);
        return 0;
    case ISO__OSDP_STEP_STATE:
        *command = (struct command){.code = ISO_OSDP_LSTAT};
        return 0;
    default:
        *command = common_command(reader);
        return 0;
    }
}

/* Makes the frame of the next command. 0 or the error of the random numbers. */
static int make_frame(struct iso_osdp_reader *reader)
{
    struct command command = {.block = ISO_OSDP_SCS_NONE};
    const int error = make_command(reader, &command);
    if (error) {
        return error;
    }
    const struct iso_osdp_header header = {
        .address = reader->setup.address,
        .sequence = reader->sequence,
        .has_crc = true,
        .block = command.block,
        .block_data = command.block_data,
        .code = command.code,
    };
    if (reader->secure.state == ISO_OSDP_OPEN) {
        reader->n_frame = iso_osdp_secure_frame(&reader->secure, &header, command.data, command.n,
                                                reader->frame);
    } else {
        const size_t n = iso_osdp_packet_begin(&header, command.data, command.n, reader->frame);
        reader->n_frame = iso_osdp_packet_end(reader->frame, n);
    }
    explicit_bzero(&command, sizeof command);
    reader->waits = true;
    reader->polls = header.code == ISO_OSDP_POLL;
    return 0;
}

/* How long to wait for the reply to the present frame. */
static int64_t reply_ns(const struct iso_osdp_reader *reader)
{
    const int64_t bits = (int64_t)(reader->n_frame + REPLY_BYTES) * BITS_OF_A_BYTE;
    return ISO_OSDP_READER_REPLY_NS + bits * INT64_C(1000000000) / reader->setup.baud;
}

size_t iso_osdp_reader_send(struct iso_osdp_reader *reader, int64_t now_ns, uint8_t *frame)
{
    if (now_ns - reader->heard_ns >= ISO_OSDP_READER_SILENCE_NS) {
        reader->problem = ISO_OSDP_READER_SILENT;
        start_anew(reader, now_ns, now_ns);
    }
    if (reader->problem == ISO_OSDP_READER_FINE &&
        now_ns - reader->worked_ns >= ISO_OSDP_READER_SILENCE_NS) {
        /* It answers, and no start succeeds. */
        reader->problem = ISO_OSDP_READER_SILENT;
    }
    if (now_ns < reader->due_ns) {
        return 0;
    }
    if (reader->waits) {
        reader->count.repeated++;
    } else if (make_frame(reader)) {
        start_anew(reader, now_ns, now_ns + ISO_OSDP_READER_PAUSE_NS);
        return 0;
    }
    reader->due_ns = now_ns + reply_ns(reader);
    memcpy(frame, reader->frame, reader->n_frame);
    return reader->n_frame;
}

int64_t iso_osdp_reader_due_ns(const struct iso_osdp_reader *reader)
{
    const int64_t silent_ns = reader->heard_ns + ISO_OSDP_READER_SILENCE_NS;
    return reader->due_ns < silent_ns ? reader->due_ns : silent_ns;
}

/* ---- replies ---- */

/* Acts on a reply that counts. */
static void accept(struct iso_osdp_reader *reader, const struct iso__osdp_reply *reply,
                   int64_t now_ns)
{
    reader->waits = false;
    reader->heard_ns = now_ns;
    reader->sequence = reader->sequence % 3 + 1;
    switch (iso__osdp_reader_reply(reader, reply)) {
    case ISO__OSDP_NEXT_RESTART:
        start_anew(reader, now_ns, now_ns + ISO_OSDP_READER_PAUSE_NS);
        break;
    case ISO__OSDP_NEXT_POLL:
        reader->due_ns = now_ns + ISO_OSDP_READER_POLL_NS;
        break;
    default:
        reader->due_ns = now_ns + ISO_OSDP_READER_GAP_NS;
        break;
    }
}

/* A reply while the channel is open. */
static void take_secured(struct iso_osdp_reader *reader, const struct iso_osdp_packet *packet,
                         int64_t now_ns)
{
    uint8_t data[ISO_OSDP_FRAME_BYTES] = {0};
    struct iso__osdp_reply reply = {.code = packet->code, .data = data};
    if (!packet->mac && packet->code == ISO_OSDP_NAK) {
        /* The reader has lost its keys, or somebody else says so, who could jam the line as well.
         */
        reader->count.refused++;
        start_anew(reader, now_ns, now_ns + ISO_OSDP_READER_PAUSE_NS);
        return;
    }
    const int error = iso_osdp_secure_open(&reader->secure, packet, data, &reply.n);
    if (error == -EACCES) {
        reader->count.refused++;
        return;
    }
    if (error) {
        /* Wrong padding under a right MAC: a fault of the reader. */
        reply.n = 0;
    }
    accept(reader, &reply, now_ns);
    explicit_bzero(data, sizeof data);
}

static void take(struct iso_osdp_reader *reader, const struct iso_osdp_packet *packet,
                 int64_t now_ns)
{
    if (!packet->is_reply || packet->address != reader->setup.address || !reader->waits) {
        return;
    }
    if (packet->code == ISO_OSDP_BUSY && !packet->mac) {
        /* It has the sequence number 0. It is no sign of life, because anyone can send it. */
        reader->due_ns = now_ns + ISO_OSDP_READER_REPLY_NS;
        return;
    }
    if (packet->sequence != reader->sequence) {
        return;
    }
    if (reader->secure.state == ISO_OSDP_OPEN) {
        take_secured(reader, packet, now_ns);
    } else if (!packet->mac) {
        const struct iso__osdp_reply reply = {packet->code, packet->block, packet->data,
                                              packet->n_data};
        accept(reader, &reply, now_ns);
    }
}

void iso_osdp_reader_receive(struct iso_osdp_reader *reader, const uint8_t *bytes, size_t n,
                             int64_t now_ns)
{
    struct iso_osdp_packet packet;
    if (n > 0 && now_ns - reader->bytes_ns >= ISO_OSDP_GAP_NS) {
        iso_osdp_receiver_reset(&reader->receiver);
    }
    reader->bytes_ns = n > 0 ? now_ns : reader->bytes_ns;
    for (size_t i = 0; i < n; i++) {
        bool whole = iso_osdp_receiver_push(&reader->receiver, bytes[i], &packet);
        while (whole) {
            take(reader, &packet, now_ns);
            whole = iso_osdp_receiver_next(&reader->receiver, &packet);
        }
    }
}
