#include "firmware/fleet/message/head.h"

#include <errno.h>

int iso_fleet_make_head(const struct iso_fleet_head *head, const struct iso_fleet_signer *signer,
                        struct iso_fleet_bytes *out)
{
    struct iso_fleet_bytes made = {.bytes = NULL};
    iso_fleet_begin(&made, ISO_FLEET_HEAD);
    iso_fleet_put_place(&made, &head->place);
    iso_fleet_put_u64(&made, (uint64_t)head->time_s);
    iso_fleet_put_u64(&made, head->snapshot_sequence);
    const int error = iso_fleet_sign(&made, signer);
    if (!error) {
        *out = made;
    }
    return error;
}

int iso_fleet_read_head(const void *bytes, size_t size,
                        const uint8_t signer[ISO_FLEET_PUBLIC_BYTES], struct iso_fleet_head *out)
{
    struct iso_fleet_reader in;
    struct iso_fleet_head head;
    const int error = iso_fleet_verify(bytes, size, ISO_FLEET_HEAD, signer, &in);
    if (error) {
        return error;
    }
    head.place = iso_fleet_take_place(&in);
    head.time_s = (int64_t)iso_fleet_take_u64(&in);
    head.snapshot_sequence = iso_fleet_take_u64(&in);
    if (!iso_fleet_reader_is_done(&in) || head.place.epoch == 0) {
        return -EBADMSG;
    }
    *out = head;
    return 0;
}
