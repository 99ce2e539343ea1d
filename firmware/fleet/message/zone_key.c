#include "firmware/fleet/message/zone_key.h"

#include <errno.h>
#include <string.h>

int iso_fleet_make_key(const struct iso_fleet_key_grant *grant,
                       const uint8_t to[ISO_FLEET_PUBLIC_BYTES],
                       const struct iso_fleet_signer *signer, struct iso_fleet_bytes *out)
{
    struct iso_fleet_bytes made = {.bytes = NULL};
    iso_fleet_begin(&made, ISO_FLEET_KEY);
    iso_fleet_put(&made, grant->door.bytes, sizeof grant->door.bytes);
    iso_fleet_put_place(&made, &grant->base);
    iso_fleet_put_u8(&made, grant->reset ? 1 : 0);
    iso_fleet_put_sealed(&made, to, grant->key.bytes, sizeof grant->key.bytes);
    const int error = iso_fleet_sign(&made, signer);
    if (!error) {
        *out = made;
    }
    return error;
}

int iso_fleet_read_key(const void *bytes, size_t size, const uint8_t signer[ISO_FLEET_PUBLIC_BYTES],
                       const struct iso_fleet_receiver *receiver, struct iso_fleet_key_grant *out)
{
    struct iso_fleet_reader in;
    struct iso_fleet_key_grant grant = {.reset = false};
    struct iso_fleet_bytes key = {.bytes = NULL};
    int error = iso_fleet_verify(bytes, size, ISO_FLEET_KEY, signer, &in);
    if (error) {
        return error;
    }
    iso_fleet_take_bytes(&in, grant.door.bytes, sizeof grant.door.bytes);
    grant.base = iso_fleet_take_place(&in);
    const uint8_t reset = iso_fleet_take_u8(&in);
    error = reset > 1 || grant.base.epoch == 0 ? -EBADMSG
                                               : iso_fleet_take_sealed(&in, receiver, &key);
    if (!error && (!iso_fleet_reader_is_done(&in) || key.size != sizeof grant.key.bytes)) {
        error = -EBADMSG;
    }
    if (!error) {
        grant.reset = reset == 1;
        memcpy(grant.key.bytes, key.bytes, sizeof grant.key.bytes);
        *out = grant;
    }
    iso_fleet_bytes_free(&key);
    return error;
}
