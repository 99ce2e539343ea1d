#include "drivers/door/osdp/osdp_aes.h"

#include <nettle/aes.h>
#include <nettle/memops.h>
#include <string.h>

void iso_osdp_aes_encrypt(const uint8_t key[ISO_OSDP_KEY_BYTES],
                          const uint8_t in[ISO_OSDP_KEY_BYTES], uint8_t out[ISO_OSDP_KEY_BYTES])
{
    struct aes128_ctx schedule;
    aes128_set_encrypt_key(&schedule, key);
    aes128_encrypt(&schedule, AES_BLOCK_SIZE, out, in);
    explicit_bzero(&schedule, sizeof schedule);
}

void iso_osdp_aes_decrypt(const uint8_t key[ISO_OSDP_KEY_BYTES],
                          const uint8_t in[ISO_OSDP_KEY_BYTES], uint8_t out[ISO_OSDP_KEY_BYTES])
{
    struct aes128_ctx schedule;
    aes128_set_decrypt_key(&schedule, key);
    aes128_decrypt(&schedule, AES_BLOCK_SIZE, out, in);
    explicit_bzero(&schedule, sizeof schedule);
}

bool iso_osdp_equal(const void *a, const void *b, size_t n)
{
    return memeql_sec(a, b, n) != 0;
}
