#include "drivers/door/osdp/osdp_secure.h"

#include <errno.h>
#include <string.h>

#include "drivers/door/osdp/osdp_codes.h"

enum { BLOCK = ISO_OSDP_KEY_BYTES, END_OF_DATA = 0x80 };

const uint8_t iso_osdp_default_key[ISO_OSDP_KEY_BYTES] = {
    0x30, 0x31, 0x32, 0x33, 0x34, 0x35, 0x36, 0x37, 0x38, 0x39, 0x3A, 0x3B, 0x3C, 0x3D, 0x3E, 0x3F};

void iso_osdp_secure_close(struct iso_osdp_secure *secure)
{
    explicit_bzero(secure, sizeof *secure);
}

/* ---- the keys ---- */

static void derive(const uint8_t *scbk, uint8_t first, uint8_t second, const uint8_t *rnd_a,
                   uint8_t *key)
{
    uint8_t block[BLOCK] = {first, second};
    memcpy(block + 2, rnd_a, 6);
    iso_osdp_aes_encrypt(scbk, block, key);
}

/* Both cryptograms: the two random numbers under S-ENC, each in another order. */
static void make_cryptogram(const uint8_t *s_enc, const uint8_t *first, const uint8_t *second,
                            uint8_t *cryptogram)
{
    memcpy(cryptogram, first, ISO_OSDP_RANDOM_BYTES);
    memcpy(cryptogram + ISO_OSDP_RANDOM_BYTES, second, ISO_OSDP_RANDOM_BYTES);
    iso_osdp_aes_encrypt(s_enc, cryptogram, cryptogram);
}

static void derive_keys(struct iso_osdp_secure *secure, const uint8_t *scbk, const uint8_t *rnd_a)
{
    iso_osdp_secure_close(secure);
    derive(scbk, 0x01, 0x82, rnd_a, secure->s_enc);
    derive(scbk, 0x01, 0x01, rnd_a, secure->s_mac1);
    derive(scbk, 0x01, 0x02, rnd_a, secure->s_mac2);
    memcpy(secure->rnd_a, rnd_a, ISO_OSDP_RANDOM_BYTES);
}

/* Opens the channel with the first R-MAC, which follows from the server cryptogram. */
static void begin(struct iso_osdp_secure *secure, const uint8_t *rmac_i)
{
    memcpy(secure->sent_mac, rmac_i, BLOCK);
    memcpy(secure->heard_mac, rmac_i, BLOCK);
    secure->state = ISO_OSDP_OPEN;
}

static void make_rmac_i(const struct iso_osdp_secure *secure, const uint8_t *server,
                        uint8_t *rmac_i)
{
    iso_osdp_aes_encrypt(secure->s_mac1, server, rmac_i);
    iso_osdp_aes_encrypt(secure->s_mac2, rmac_i, rmac_i);
}

static int refuse(struct iso_osdp_secure *secure)
{
    iso_osdp_secure_close(secure);
    return -EACCES;
}

/* ---- the device ---- */

void iso_osdp_secure_challenge(struct iso_osdp_secure *secure,
                               const uint8_t scbk[ISO_OSDP_KEY_BYTES],
                               const uint8_t rnd_a[ISO_OSDP_RANDOM_BYTES],
                               const uint8_t rnd_b[ISO_OSDP_RANDOM_BYTES],
                               uint8_t cryptogram[ISO_OSDP_KEY_BYTES])
{
    derive_keys(secure, scbk, rnd_a);
    memcpy(secure->rnd_b, rnd_b, ISO_OSDP_RANDOM_BYTES);
    make_cryptogram(secure->s_enc, rnd_a, rnd_b, cryptogram);
    secure->state = ISO_OSDP_CHALLENGED;
}

int iso_osdp_secure_prove(struct iso_osdp_secure *secure,
                          const uint8_t cryptogram[ISO_OSDP_KEY_BYTES],
                          uint8_t rmac_i[ISO_OSDP_KEY_BYTES])
{
    uint8_t expected[BLOCK];
    make_cryptogram(secure->s_enc, secure->rnd_b, secure->rnd_a, expected);
    const bool right = iso_osdp_equal(expected, cryptogram, BLOCK);
    explicit_bzero(expected, sizeof expected);
    if (secure->state != ISO_OSDP_CHALLENGED || !right) {
        return refuse(secure);
    }
    make_rmac_i(secure, cryptogram, rmac_i);
    begin(secure, rmac_i);
    return 0;
}

/* ---- the panel ---- */

void iso_osdp_secure_request(struct iso_osdp_secure *secure, const uint8_t scbk[ISO_OSDP_KEY_BYTES],
                             const uint8_t rnd_a[ISO_OSDP_RANDOM_BYTES])
{
    derive_keys(secure, scbk, rnd_a);
    secure->is_panel = true;
    secure->state = ISO_OSDP_REQUESTED;
}

int iso_osdp_secure_answer(struct iso_osdp_secure *secure,
                           const uint8_t rnd_b[ISO_OSDP_RANDOM_BYTES],
                           const uint8_t client[ISO_OSDP_KEY_BYTES],
                           uint8_t server[ISO_OSDP_KEY_BYTES])
{
    uint8_t expected[BLOCK];
    make_cryptogram(secure->s_enc, secure->rnd_a, rnd_b, expected);
    const bool right = iso_osdp_equal(expected, client, BLOCK);
    explicit_bzero(expected, sizeof expected);
    if (secure->state != ISO_OSDP_REQUESTED || !right) {
        return refuse(secure);
    }
    memcpy(secure->rnd_b, rnd_b, ISO_OSDP_RANDOM_BYTES);
    make_cryptogram(secure->s_enc, rnd_b, secure->rnd_a, server);
    secure->state = ISO_OSDP_CHALLENGED;
    return 0;
}

int iso_osdp_secure_confirm(struct iso_osdp_secure *secure,
                            const uint8_t rmac_i[ISO_OSDP_KEY_BYTES])
{
    uint8_t expected[BLOCK];
    make_cryptogram(secure->s_enc, secure->rnd_b, secure->rnd_a, expected);
    make_rmac_i(secure, expected, expected);
    const bool right = iso_osdp_equal(expected, rmac_i, BLOCK);
    explicit_bzero(expected, sizeof expected);
    if (secure->state != ISO_OSDP_CHALLENGED || !secure->is_panel || !right) {
        return refuse(secure);
    }
    begin(secure, rmac_i);
    return 0;
}

/* ---- frames ---- */

static void add_block(uint8_t *sum, const uint8_t *block)
{
    for (size_t i = 0; i < BLOCK; i++) {
        sum[i] ^= block[i];
    }
}

static void compute_mac(const struct iso_osdp_secure *secure, const uint8_t *initial,
                        const uint8_t *bytes, size_t n, uint8_t *mac)
{
    uint8_t sum[BLOCK];
    memcpy(sum, initial, BLOCK);
    while (n > BLOCK) {
        add_block(sum, bytes);
        iso_osdp_aes_encrypt(secure->s_mac1, sum, sum);
        bytes += BLOCK;
        n -= BLOCK;
    }
    uint8_t last[BLOCK] = {0};
    memcpy(last, bytes, n);
    if (n < BLOCK) {
        last[n] = END_OF_DATA;
    }
    add_block(sum, last);
    iso_osdp_aes_encrypt(secure->s_mac2, sum, mac);
    explicit_bzero(sum, sizeof sum);
}

static void invert(const uint8_t *mac, uint8_t *out)
{
    for (size_t i = 0; i < BLOCK; i++) {
        out[i] = (uint8_t)~mac[i];
    }
}

/* Decrypts whole blocks and takes the padding away. */
static int decrypt(const struct iso_osdp_secure *secure, const uint8_t *in, size_t n, uint8_t *out,
                   size_t *n_out)
{
    uint8_t before[BLOCK];
    if (n == 0 || n % BLOCK) {
        return -EBADMSG;
    }
    invert(secure->sent_mac, before);
    for (size_t at = 0; at < n; at += BLOCK) {
        iso_osdp_aes_decrypt(secure->s_enc, in + at, out + at);
        add_block(out + at, before);
        memcpy(before, in + at, BLOCK);
    }
    /* The MAC was right, so the padding tells nothing to somebody who does not have the keys. */
    size_t end = n;
    while (end > n - BLOCK && out[end - 1] == 0) {
        end--;
    }
    if (end == n - BLOCK || out[end - 1] != END_OF_DATA) {
        explicit_bzero(out, n);
        return -EBADMSG;
    }
    *n_out = end - 1;
    return 0;
}

/* The block of a frame of one side. */
static uint8_t block_of(bool by_panel, bool encrypted)
{
    return by_panel ? (encrypted ? ISO_OSDP_SCS_17 : ISO_OSDP_SCS_15)
                    : (encrypted ? ISO_OSDP_SCS_18 : ISO_OSDP_SCS_16);
}

int iso_osdp_secure_open(struct iso_osdp_secure *secure, const struct iso_osdp_packet *packet,
                         uint8_t *data, size_t *n_data)
{
    uint8_t mac[BLOCK];
    const bool encrypted = packet->block == block_of(!secure->is_panel, true);
    const bool is_signed = encrypted || packet->block == block_of(!secure->is_panel, false);
    if (secure->state != ISO_OSDP_OPEN || !is_signed) {
        return -EACCES;
    }
    compute_mac(secure, secure->sent_mac, packet->frame, packet->n_signed, mac);
    if (!iso_osdp_equal(mac, packet->mac, ISO_OSDP_MAC_BYTES)) {
        return -EACCES;
    }
    memcpy(secure->heard_mac, mac, BLOCK);
    if (encrypted) {
        return decrypt(secure, packet->data, packet->n_data, data, n_data);
    }
    memcpy(data, packet->data, packet->n_data);
    *n_data = packet->n_data;
    return 0;
}

/* Encrypts n bytes into out[n rounded up to the next whole block, at least one byte more than n].
 * Returns the number of bytes. */
static size_t encrypt(const struct iso_osdp_secure *secure, const uint8_t *data, size_t n,
                      uint8_t *out)
{
    uint8_t before[BLOCK];
    const size_t n_out = (n / BLOCK + 1) * BLOCK;
    memset(out, 0, n_out);
    memcpy(out, data, n);
    out[n] = END_OF_DATA;
    invert(secure->heard_mac, before);
    for (size_t at = 0; at < n_out; at += BLOCK) {
        add_block(out + at, before);
        iso_osdp_aes_encrypt(secure->s_enc, out + at, out + at);
        memcpy(before, out + at, BLOCK);
    }
    return n_out;
}

size_t iso_osdp_secure_frame(struct iso_osdp_secure *secure, const struct iso_osdp_header *header,
                             const uint8_t *data, size_t n, uint8_t *frame)
{
    uint8_t sealed[ISO_OSDP_SEALED_BYTES + BLOCK];
    struct iso_osdp_header own = *header;
    own.block = block_of(secure->is_panel, n > 0);
    own.block_data = -1;
    const size_t n_sealed = n > 0 ? encrypt(secure, data, n, sealed) : 0;
    const size_t n_frame = iso_osdp_packet_begin(&own, sealed, n_sealed, frame);
    compute_mac(secure, secure->heard_mac, frame, n_frame, secure->sent_mac);
    memcpy(frame + n_frame, secure->sent_mac, ISO_OSDP_MAC_BYTES);
    return iso_osdp_packet_end(frame, n_frame + ISO_OSDP_MAC_BYTES);
}
