#include "firmware/fleet/order/update_order.h"

#include <errno.h>
#include <string.h>

#include "drivers/base/utf8.h"

static const char *const words[ISO_FLEET_UPDATE_STATES] = {
    [ISO_FLEET_UPDATE_NONE] = "none",           [ISO_FLEET_UPDATE_IDLE] = "idle",
    [ISO_FLEET_UPDATE_FETCHING] = "fetching",   [ISO_FLEET_UPDATE_INSTALLING] = "installing",
    [ISO_FLEET_UPDATE_INSTALLED] = "installed", [ISO_FLEET_UPDATE_HEALTHY] = "healthy",
    [ISO_FLEET_UPDATE_FAILED] = "failed",       [ISO_FLEET_UPDATE_WENT_BACK] = "went-back",
};

bool iso_fleet_update_word_is_good(const char *text)
{
    static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789"
                                  "._+~:-";
    const size_t length = strlen(text);
    return length > 0 && length < ISO_FLEET_UPDATE_WORD_SIZE && strspn(text, letters) == length;
}

int iso_fleet_make_update(const struct iso_fleet_update *update,
                          const struct iso_fleet_signer *signer, struct iso_fleet_bytes *out)
{
    struct iso_fleet_bytes made = {.bytes = NULL};
    iso_fleet_begin(&made, ISO_FLEET_UPDATE);
    iso_fleet_put(&made, update->door.bytes, sizeof update->door.bytes);
    iso_fleet_put(&made, update->nonce, sizeof update->nonce);
    iso_fleet_put(&made, update->rollout.bytes, sizeof update->rollout.bytes);
    iso_fleet_put_u64(&made, update->size);
    iso_fleet_put(&made, update->sha256, sizeof update->sha256);
    iso_fleet_put_u32(&made, update->spread_s);
    iso_fleet_put_text(&made, update->version);
    iso_fleet_put_text(&made, update->board);
    const int error = iso_fleet_sign(&made, signer);
    if (!error) {
        *out = made;
    }
    return error;
}

static void take_word(struct iso_fleet_reader *in, char out[ISO_FLEET_UPDATE_WORD_SIZE])
{
    size_t length = 0;
    const char *text = iso_fleet_take_text(in, ISO_FLEET_UPDATE_WORD_SIZE - 1, &length);
    if (text) {
        memcpy(out, text, length);
        out[length] = '\0';
    }
    in->bad = in->bad || !iso_fleet_update_word_is_good(out);
}

int iso_fleet_read_update(const void *bytes, size_t size,
                          const uint8_t signer[ISO_FLEET_PUBLIC_BYTES],
                          struct iso_fleet_update *out)
{
    struct iso_fleet_reader in;
    struct iso_fleet_update update = {.size = 0};
    const int error = iso_fleet_verify(bytes, size, ISO_FLEET_UPDATE, signer, &in);
    if (error) {
        return error;
    }
    iso_fleet_take_bytes(&in, update.door.bytes, sizeof update.door.bytes);
    iso_fleet_take_bytes(&in, update.nonce, sizeof update.nonce);
    iso_fleet_take_bytes(&in, update.rollout.bytes, sizeof update.rollout.bytes);
    update.size = iso_fleet_take_u64(&in);
    iso_fleet_take_bytes(&in, update.sha256, sizeof update.sha256);
    update.spread_s = iso_fleet_take_u32(&in);
    take_word(&in, update.version);
    take_word(&in, update.board);
    if (!iso_fleet_reader_is_done(&in) || update.size == 0 ||
        update.size > ISO_FLEET_UPDATE_BYTES_MAX) {
        return -EBADMSG;
    }
    *out = update;
    return 0;
}

void iso_fleet_update_fault_copy(char out[ISO_FLEET_UPDATE_FAULT_SIZE], const char *text)
{
    size_t length = 0;
    uint32_t c = 0;
    while (*text) {
        const int n = iso_utf8_decode(text, &c);
        if (n <= 0 || length + (size_t)n >= ISO_FLEET_UPDATE_FAULT_SIZE) {
            break;
        }
        if (c < 0x20 || (c >= 0x7f && c < 0xa0)) {
            out[length++] = '?';
        } else {
            memcpy(out + length, text, (size_t)n);
            length += (size_t)n;
        }
        text += n;
    }
    out[length] = '\0';
}

const char *iso_fleet_update_state_word(enum iso_fleet_update_state state)
{
    return words[state];
}

int iso_fleet_update_state_read(const char *word, enum iso_fleet_update_state *out)
{
    for (unsigned i = 0; i < ISO_FLEET_UPDATE_STATES; i++) {
        if (strcmp(words[i], word) == 0) {
            *out = (enum iso_fleet_update_state)i;
            return 0;
        }
    }
    return -EINVAL;
}
