#include "tests/drivers/door/osdp/osdp_panel.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>
#include <openssl/evp.h>

uint16_t panel_crc(const uint8_t *bytes, size_t n)
{
    uint16_t crc = 0x1D0F;
    for (size_t i = 0; i < n; i++) {
        for (int bit = 7; bit >= 0; bit--) {
            const int out = (crc >> 15 & 1) ^ (bytes[i] >> bit & 1);
            crc = (uint16_t)(crc << 1);
            crc = out ? crc ^ 0x1021 : crc;
        }
    }
    return crc;
}

void panel_put_crc(uint8_t *bytes, size_t n)
{
    const uint16_t crc = panel_crc(bytes, n);
    bytes[n] = (uint8_t)(crc & 0xFF);
    bytes[n + 1] = (uint8_t)(crc >> 8);
}

/* AES-128-CBC of whole blocks. */
static void cbc(bool encrypt, const uint8_t *key, const uint8_t *initial, const uint8_t *in,
                size_t n, uint8_t *out)
{
    EVP_CIPHER_CTX *context = EVP_CIPHER_CTX_new();
    int length = 0;
    assert_non_null(context);
    assert_int_equal(EVP_CipherInit_ex(context, EVP_aes_128_cbc(), NULL, key, initial, encrypt), 1);
    assert_int_equal(EVP_CIPHER_CTX_set_padding(context, 0), 1);
    assert_int_equal(EVP_CipherUpdate(context, out, &length, in, (int)n), 1);
    assert_int_equal(length, n);
    EVP_CIPHER_CTX_free(context);
}

static void ecb(const uint8_t *key, const uint8_t *in, uint8_t *out)
{
    static const uint8_t zero[16];
    uint8_t block[16];
    cbc(true, key, zero, in, 16, block);
    memcpy(out, block, 16);
}

/* The MAC of a message: all blocks but the last under S-MAC1, the last under S-MAC2. */
static void make_mac(const struct panel *panel, const uint8_t *initial, const uint8_t *bytes,
                     size_t n, uint8_t *mac)
{
    uint8_t padded[PANEL_FRAME_BYTES + 16] = {0}, out[PANEL_FRAME_BYTES + 16];
    memcpy(padded, bytes, n);
    if (n % 16) {
        padded[n] = 0x80;
        n += 16 - n % 16;
    }
    const uint8_t *before = initial;
    if (n > 16) {
        cbc(true, panel->s_mac1, initial, padded, n - 16, out);
        before = out + n - 32;
    }
    uint8_t last[16];
    cbc(true, panel->s_mac2, before, padded + n - 16, 16, last);
    memcpy(mac, last, 16);
}

static void invert(const uint8_t *mac, uint8_t *out)
{
    for (int i = 0; i < 16; i++) {
        out[i] = mac[i] ^ 0xFF;
    }
}

static void end_frame(struct panel *panel)
{
    uint8_t *frame = panel->frame;
    if (panel->checksum) {
        int sum = 0;
        for (size_t i = 0; i < panel->n_frame; i++) {
            sum += frame[i];
        }
        frame[panel->n_frame++] = (uint8_t)(256 - sum % 256);
    } else {
        panel_put_crc(frame, panel->n_frame);
        panel->n_frame += 2;
    }
}

static void begin_frame(struct panel *panel, uint8_t command, int block, int block_data,
                        const void *data, size_t n, size_t n_mac)
{
    const size_t n_block = block == 0 ? 0 : block_data < 0 ? 2 : 3;
    const size_t length = 5 + n_block + 1 + n + n_mac + (panel->checksum ? 1 : 2);
    panel->sequence = panel->sequence < 0 ? 0 : panel->sequence % 3 + 1;
    const uint8_t head[] = {
        0x53,
        panel->address,
        length & 0xFF,
        (uint8_t)(length >> 8),
        (uint8_t)(panel->sequence | (panel->checksum ? 0 : 4) | (block ? 8 : 0)),
        (uint8_t)n_block,
        (uint8_t)block,
        (uint8_t)block_data};
    memcpy(panel->frame, head, 5 + n_block);
    panel->frame[5 + n_block] = command;
    if (n) {
        memcpy(panel->frame + 6 + n_block, data, n);
    }
    panel->n_frame = 6 + n_block + n;
}

void panel_make_plain(struct panel *panel, uint8_t command, int block, int block_data,
                      const void *data, size_t n)
{
    begin_frame(panel, command, block, block_data, data, n, 0);
    end_frame(panel);
}

void panel_make(struct panel *panel, uint8_t command, const void *data, size_t n)
{
    uint8_t padded[PANEL_FRAME_BYTES + 16] = {0}, out[PANEL_FRAME_BYTES + 16], initial[16];
    if (!panel->secure) {
        panel_make_plain(panel, command, 0, -1, data, n);
        return;
    }
    if (n) {
        memcpy(padded, data, n);
        padded[n] = 0x80;
        n = (n + 16) / 16 * 16;
        invert(panel->r_mac, initial);
        cbc(true, panel->s_enc, initial, padded, n, out);
    }
    begin_frame(panel, command, n ? 0x17 : 0x15, -1, out, n, 4);
    make_mac(panel, panel->r_mac, panel->frame, panel->n_frame, panel->c_mac);
    memcpy(panel->frame + panel->n_frame, panel->c_mac, 4);
    panel->n_frame += 4;
    end_frame(panel);
}

/* ---- replies ---- */

static bool is_intact(const struct panel *panel, const uint8_t *frame, size_t n)
{
    if (n < 7 || frame[0] != 0x53 || frame[1] != (panel->address | 0x80) ||
        (frame[2] | frame[3] << 8) != (int)n || (frame[4] & 3) != panel->sequence ||
        !(frame[4] & 4) != panel->checksum) {
        return false;
    }
    if (panel->checksum) {
        int sum = 0;
        for (size_t i = 0; i < n; i++) {
            sum += frame[i];
        }
        return sum % 256 == 0;
    }
    return panel_crc(frame, n - 2) == (frame[n - 2] | frame[n - 1] << 8);
}

/* Checks the MAC of a reply and decrypts its data. */
static bool unseal(struct panel *panel, const uint8_t *frame, size_t end, struct panel_reply *reply)
{
    uint8_t mac[16], initial[16], plain[PANEL_FRAME_BYTES];
    make_mac(panel, panel->c_mac, frame, end, mac);
    if (memcmp(mac, frame + end, 4) != 0) {
        return false;
    }
    memcpy(panel->r_mac, mac, 16);
    if (reply->block == 0x18) {
        if (reply->n == 0 || reply->n % 16) {
            return false;
        }
        invert(panel->c_mac, initial);
        cbc(false, panel->s_enc, initial, reply->data, reply->n, plain);
        size_t n = reply->n;
        while (n > 0 && plain[n - 1] == 0) {
            n--;
        }
        if (n == 0 || plain[n - 1] != 0x80) {
            return false;
        }
        reply->n = n - 1;
        memcpy(reply->data, plain, reply->n);
    }
    return true;
}

void panel_read(struct panel *panel, const uint8_t *frame, size_t n, struct panel_reply *reply)
{
    memset(reply, 0, sizeof *reply);
    reply->code = -1;
    if (!is_intact(panel, frame, n)) {
        return;
    }
    size_t at = 5, end = n - (panel->checksum ? 1 : 2);
    if (frame[4] & 8) {
        reply->block = frame[6];
        reply->block_data = frame[5] > 2 ? frame[7] : -1;
        at += frame[5];
    }
    const bool has_mac = reply->block == 0x16 || reply->block == 0x18;
    end -= has_mac ? 4 : 0;
    reply->n = end - at - 1;
    memcpy(reply->data, frame + at + 1, reply->n);
    if (!has_mac || (panel->secure && unseal(panel, frame, end, reply))) {
        reply->code = frame[at];
    }
}

/* ---- the handshake ---- */

void panel_challenge(struct panel *panel, const uint8_t scbk[16], const uint8_t rnd_a[8])
{
    panel->secure = false;
    memcpy(panel->scbk, scbk, 16);
    memcpy(panel->rnd_a, rnd_a, 8);
    const uint8_t *r = rnd_a;
    const uint8_t enc[16] = {0x01, 0x82, r[0], r[1], r[2], r[3], r[4], r[5]};
    const uint8_t mac1[16] = {0x01, 0x01, r[0], r[1], r[2], r[3], r[4], r[5]};
    const uint8_t mac2[16] = {0x01, 0x02, r[0], r[1], r[2], r[3], r[4], r[5]};
    ecb(scbk, enc, panel->s_enc);
    ecb(scbk, mac1, panel->s_mac1);
    ecb(scbk, mac2, panel->s_mac2);
}

bool panel_answer(struct panel *panel, const struct panel_reply *ccrypt, uint8_t proof[16])
{
    uint8_t block[16], expected[16];
    if (ccrypt->code != 0x76 || ccrypt->block != 0x12 || ccrypt->n != 32) {
        return false;
    }
    memcpy(panel->rnd_b, ccrypt->data + 8, 8);
    memcpy(block, panel->rnd_a, 8);
    memcpy(block + 8, panel->rnd_b, 8);
    ecb(panel->s_enc, block, expected);
    memcpy(block, panel->rnd_b, 8);
    memcpy(block + 8, panel->rnd_a, 8);
    ecb(panel->s_enc, block, proof);
    ecb(panel->s_mac1, proof, panel->r_mac);
    ecb(panel->s_mac2, panel->r_mac, panel->r_mac);
    return memcmp(expected, ccrypt->data + 16, 16) == 0;
}

bool panel_begin(struct panel *panel, const struct panel_reply *rmac_i)
{
    panel->secure = rmac_i->code == 0x78 && rmac_i->block == 0x14 && rmac_i->block_data == 1 &&
                    rmac_i->n == 16 && memcmp(rmac_i->data, panel->r_mac, 16) == 0;
    memcpy(panel->c_mac, panel->r_mac, 16);
    return panel->secure;
}
