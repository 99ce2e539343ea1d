/* The commands of a panel, one function each. */
#include <errno.h>
#include <string.h>

#include "core/base/bytes.h"
#include "drivers/door/osdp/osdp_codes.h"
#include "drivers/door/osdp/osdp_peripheral_state.h"

void iso__osdp_nak(struct iso__osdp_answer *answer, enum iso_osdp_nak reason)
{
    *answer = (struct iso__osdp_answer){
        .code = ISO_OSDP_NAK, .n = 1, .data = {(uint8_t)reason}, .block_data = -1};
}

/* ---- what the device is ---- */

static void tell_identity(const struct iso_osdp_peripheral *peripheral,
                          struct iso__osdp_answer *answer)
{
    const struct iso_osdp_setup *setup = &peripheral->setup;
    uint8_t *at = iso_put_bytes(answer->data, setup->vendor, sizeof setup->vendor);
    *at++ = setup->model;
    *at++ = setup->version;
    at = iso_put_u32(at, setup->serial);
    at = iso_put_bytes(at, setup->firmware, sizeof setup->firmware);
    answer->code = ISO_OSDP_PDID;
    answer->n = (size_t)(at - answer->data);
}

/* Each ability is three bytes: which, how well, how many. */
static void tell_abilities(const struct iso_osdp_peripheral *peripheral,
                           struct iso__osdp_answer *answer)
{
    const uint8_t inputs = (uint8_t)peripheral->setup.inputs;
    const uint8_t abilities[] = {
        1,
        inputs > 0,
        inputs, /* contacts, without supervision of their wires */
        2,
        0,
        0, /* outputs */
        3,
        1,
        0, /* cards as bits */
        4,
        4,
        1, /* lamp: timed, three colours */
        5,
        2,
        1, /* buzzer: timed */
        6,
        2,
        1, /* text: two rows of 16 characters */
        8,
        1,
        0, /* CRC-16 */
        9,
        1,
        1, /* AES-128, with a default key */
        10,
        ISO_OSDP_FRAME_BYTES & 0xFF,
        ISO_OSDP_FRAME_BYTES >> 8,
        11,
        ISO_OSDP_FRAME_BYTES & 0xFF,
        ISO_OSDP_FRAME_BYTES >> 8,
        13,
        0,
        1, /* readers */
    };
    answer->code = ISO_OSDP_PDCAP;
    answer->n = sizeof abilities;
    memcpy(answer->data, abilities, sizeof abilities);
}

/* ---- address, speed and key ---- */

/* The owner stores what shall hold from now on. */
static bool has_stored(struct iso_osdp_peripheral *peripheral, const struct iso_osdp_saved *saved)
{
    return peripheral->setup.store(peripheral->setup.context, saved) == 0;
}

static void do_comset(struct iso_osdp_peripheral *peripheral, const uint8_t *data, size_t n,
                      struct iso__osdp_answer *answer)
{
    if (n != 5) {
        iso__osdp_nak(answer, ISO_OSDP_NAK_LENGTH);
        return;
    }
    const struct iso_osdp_saved *now = &peripheral->setup.saved;
    struct iso_osdp_saved next = *now;
    next.address = data[0];
    next.baud = iso_get_u32(data + 1);
    const bool changed = next.address != now->address || next.baud != now->baud;
    const bool possible = next.address < ISO_OSDP_BROADCAST && iso_osdp_is_baud(next.baud);
    if (changed && possible && has_stored(peripheral, &next)) {
        peripheral->next = next;
        peripheral->has_next = true;
    } else {
        next = *now; /* the reply says what remains */
    }
    answer->code = ISO_OSDP_COM;
    answer->data[0] = next.address;
    (void)iso_put_u32(answer->data + 1, next.baud);
    answer->n = 5;
    explicit_bzero(&next, sizeof next);
}

/* The channel remains as it is; the new key holds for the next one. */
static void do_keyset(struct iso_osdp_peripheral *peripheral, const struct iso_osdp_packet *packet,
                      const uint8_t *data, size_t n, struct iso__osdp_answer *answer)
{
    if (packet->block != ISO_OSDP_SCS_17 || (peripheral->default_key && !peripheral->install)) {
        iso__osdp_nak(answer, ISO_OSDP_NAK_UNSECURED);
        return;
    }
    if (n != 2 + ISO_OSDP_KEY_BYTES) {
        iso__osdp_nak(answer, ISO_OSDP_NAK_LENGTH);
        return;
    }
    struct iso_osdp_saved next = peripheral->setup.saved;
    next.has_key = true;
    memcpy(next.key, data + 2, ISO_OSDP_KEY_BYTES);
    /* The key that everyone knows is no key. */
    const bool right = data[0] == 1 && data[1] == ISO_OSDP_KEY_BYTES &&
                       !iso_osdp_equal(next.key, iso_osdp_default_key, ISO_OSDP_KEY_BYTES);
    if (right && has_stored(peripheral, &next)) {
        peripheral->setup.saved = next;
        peripheral->install = false;
        peripheral->count.keys_set++;
    } else {
        iso__osdp_nak(answer, ISO_OSDP_NAK_RECORD);
    }
    explicit_bzero(&next, sizeof next);
}

/* ---- the handshake of the secure channel ---- */

/* The key that the panel asks for, or NULL. */
static const uint8_t *find_key(const struct iso_osdp_peripheral *peripheral, uint8_t which)
{
    if (which == 1 && peripheral->setup.saved.has_key) {
        return peripheral->setup.saved.key;
    }
    return which == 0 && peripheral->install ? iso_osdp_default_key : NULL;
}

static void do_challenge(struct iso_osdp_peripheral *peripheral,
                         const struct iso_osdp_packet *packet, struct iso__osdp_answer *answer)
{
    const bool has_block = packet->block == ISO_OSDP_SCS_11 && packet->n_block_data == 1;
    const uint8_t *key = has_block ? find_key(peripheral, packet->block_data[0]) : NULL;
    if (!key) {
        peripheral->count.refused += has_block;
        iso__osdp_nak(answer, ISO_OSDP_NAK_BLOCK);
        return;
    }
    if (packet->n_data != ISO_OSDP_RANDOM_BYTES) {
        iso__osdp_nak(answer, ISO_OSDP_NAK_LENGTH);
        return;
    }
    const struct iso_osdp_setup *setup = &peripheral->setup;
    uint8_t rnd_b[ISO_OSDP_RANDOM_BYTES];
    if (setup->random(setup->context, rnd_b, sizeof rnd_b)) {
        iso__osdp_nak(answer, ISO_OSDP_NAK_RECORD);
        return;
    }
    /* The client's identity is made of the numbers that PDID tells, too. */
    uint8_t *at = iso_put_bytes(answer->data, setup->vendor, sizeof setup->vendor);
    *at++ = setup->model;
    at = iso_put_u32(at, setup->serial);
    at = iso_put_bytes(at, rnd_b, sizeof rnd_b);
    iso_osdp_secure_challenge(&peripheral->secure, key, packet->data, rnd_b, at);
    answer->code = ISO_OSDP_CCRYPT;
    answer->n = (size_t)(at - answer->data) + ISO_OSDP_KEY_BYTES;
    answer->block = ISO_OSDP_SCS_12;
    answer->block_data = packet->block_data[0];
    peripheral->default_key = key == iso_osdp_default_key;
}

static void do_proof(struct iso_osdp_peripheral *peripheral, const struct iso_osdp_packet *packet,
                     struct iso__osdp_answer *answer)
{
    if (packet->block != ISO_OSDP_SCS_13 || peripheral->secure.state != ISO_OSDP_CHALLENGED) {
        iso__osdp_nak(answer, ISO_OSDP_NAK_BLOCK);
        return;
    }
    if (packet->n_data != ISO_OSDP_KEY_BYTES) {
        iso__osdp_nak(answer, ISO_OSDP_NAK_LENGTH);
        return;
    }
    answer->code = ISO_OSDP_RMAC_I;
    answer->block = ISO_OSDP_SCS_14;
    if (iso_osdp_secure_prove(&peripheral->secure, packet->data, answer->data) == 0) {
        answer->n = ISO_OSDP_KEY_BYTES;
        answer->block_data = 0x01;
    } else {
        peripheral->count.refused++;
        answer->block_data = 0xFF; /* the panel has the wrong key */
    }
}

/* ---- all commands ---- */

/* How many bytes of data a command has that needs none, or one that says which form of the reply is
 * wanted; -1 the command checks this itself. */
static int count_data(uint8_t command)
{
    switch (command) {
    case ISO_OSDP_POLL:
    case ISO_OSDP_LSTAT:
    case ISO_OSDP_ISTAT:
    case ISO_OSDP_OSTAT:
    case ISO_OSDP_RSTAT:
        return 0;
    case ISO_OSDP_ID:
    case ISO_OSDP_CAP:
        return 1;
    default:
        return -1;
    }
}

static void show(struct iso_osdp_peripheral *peripheral, uint8_t command, const uint8_t *data,
                 size_t n, int64_t now_ns, struct iso__osdp_answer *answer)
{
    struct iso_osdp_display *display = &peripheral->display;
    const int reason = command == ISO_OSDP_LED   ? iso_osdp_display_led(display, data, n, now_ns)
                       : command == ISO_OSDP_BUZ ? iso_osdp_display_buz(display, data, n, now_ns)
                                                 : iso_osdp_display_text(display, data, n, now_ns);
    if (reason) {
        iso__osdp_nak(answer, (enum iso_osdp_nak)reason);
    }
}

static void tell(struct iso_osdp_peripheral *peripheral, uint8_t command,
                 struct iso__osdp_answer *answer)
{
    switch (command) {
    case ISO_OSDP_POLL:
        iso__osdp_poll(peripheral, answer);
        break;
    case ISO_OSDP_ID:
        tell_identity(peripheral, answer);
        break;
    case ISO_OSDP_CAP:
        tell_abilities(peripheral, answer);
        break;
    case ISO_OSDP_LSTAT:
        iso__osdp_put_local(peripheral, answer);
        break;
    case ISO_OSDP_ISTAT:
        iso__osdp_put_inputs(peripheral, answer);
        break;
    case ISO_OSDP_OSTAT:
        answer->code = ISO_OSDP_OSTATR; /* there are no outputs */
        break;
    default:
        iso__osdp_put_reader(peripheral, answer);
        break;
    }
}

void iso__osdp_do(struct iso_osdp_peripheral *peripheral, const struct iso_osdp_packet *packet,
                  const uint8_t *data, size_t n, int64_t now_ns, struct iso__osdp_answer *answer)
{
    const int n_right = count_data(packet->code);
    *answer = (struct iso__osdp_answer){.code = ISO_OSDP_ACK, .block_data = -1};
    if (n_right >= 0) {
        if (n == (size_t)n_right) {
            tell(peripheral, packet->code, answer);
        } else {
            iso__osdp_nak(answer, ISO_OSDP_NAK_LENGTH);
        }
        return;
    }
    switch (packet->code) {
    case ISO_OSDP_LED:
    case ISO_OSDP_BUZ:
    case ISO_OSDP_TEXT:
        show(peripheral, packet->code, data, n, now_ns, answer);
        break;
    case ISO_OSDP_COMSET:
        do_comset(peripheral, data, n, answer);
        break;
    case ISO_OSDP_KEYSET:
        do_keyset(peripheral, packet, data, n, answer);
        break;
    case ISO_OSDP_CHLNG:
        do_challenge(peripheral, packet, answer);
        break;
    case ISO_OSDP_SCRYPT:
        do_proof(peripheral, packet, answer);
        break;
    default: /* also OUT: the lock belongs to the appliance, not to the panel */
        iso__osdp_nak(answer, ISO_OSDP_NAK_COMMAND);
        break;
    }
}
