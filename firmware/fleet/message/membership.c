#include "firmware/fleet/message/membership.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

int iso_fleet_make_membership(const struct iso_fleet_membership *membership,
                              const struct iso_fleet_signer *signer, struct iso_fleet_bytes *out)
{
    struct iso_fleet_bytes made = {.bytes = NULL};
    iso_fleet_begin(&made, ISO_FLEET_MEMBERSHIP);
    iso_fleet_put(&made, membership->door.bytes, sizeof membership->door.bytes);
    iso_fleet_put(&made, membership->hub_signs, sizeof membership->hub_signs);
    iso_fleet_put(&made, membership->hub_receives, sizeof membership->hub_receives);
    iso_fleet_put(&made, membership->door_signs, sizeof membership->door_signs);
    iso_fleet_put_text(&made, membership->hub_name);
    iso_fleet_put_text(&made, membership->door_name);
    const int error = iso_fleet_sign(&made, signer);
    if (!error) {
        *out = made;
    }
    return error;
}

static void take_title(struct iso_fleet_reader *in, char title[ISO_FLEET_TITLE_SIZE])
{
    size_t length = 0;
    const char *text = iso_fleet_take_text(in, ISO_FLEET_TITLE_SIZE - 1, &length);
    memcpy(title, text, length);
    title[length] = '\0';
}

int iso_fleet_read_membership(const void *bytes, size_t size, struct iso_fleet_membership *out)
{
    enum { SIGNS_AT = ISO_FLEET_HEADER_BYTES + ISO_FLEET_ID_BYTES };
    struct iso_fleet_reader in;
    struct iso_fleet_membership membership;
    if (size < SIGNS_AT + ISO_FLEET_PUBLIC_BYTES + ISO_FLEET_SIGNATURE_BYTES) {
        return -EBADMSG;
    }
    const int error = iso_fleet_verify(bytes, size, ISO_FLEET_MEMBERSHIP,
                                       (const uint8_t *)bytes + SIGNS_AT, &in);
    if (error) {
        return error;
    }
    iso_fleet_take_bytes(&in, membership.door.bytes, sizeof membership.door.bytes);
    iso_fleet_take_bytes(&in, membership.hub_signs, sizeof membership.hub_signs);
    iso_fleet_take_bytes(&in, membership.hub_receives, sizeof membership.hub_receives);
    iso_fleet_take_bytes(&in, membership.door_signs, sizeof membership.door_signs);
    take_title(&in, membership.hub_name);
    take_title(&in, membership.door_name);
    if (!iso_fleet_reader_is_done(&in)) {
        return -EBADMSG;
    }
    *out = membership;
    return 0;
}

static const char *topic_of(const char *kind, const struct iso_fleet_id *id, const char *what,
                            char topic[ISO_FLEET_TOPIC_SIZE])
{
    char text[ISO_FLEET_ID_TEXT_SIZE];
    (void)snprintf(topic, ISO_FLEET_TOPIC_SIZE, "isotherm/%s/%s/%s", kind,
                   iso_fleet_id_text(id, text), what);
    return topic;
}

const char *iso_fleet_topic_delta(const struct iso_fleet_id *zone, char topic[ISO_FLEET_TOPIC_SIZE])
{
    return topic_of("zone", zone, "delta", topic);
}

const char *iso_fleet_topic_head(const struct iso_fleet_id *zone, char topic[ISO_FLEET_TOPIC_SIZE])
{
    return topic_of("zone", zone, "head", topic);
}

const char *iso_fleet_topic_in(const struct iso_fleet_id *door, char topic[ISO_FLEET_TOPIC_SIZE])
{
    return topic_of("door", door, "in", topic);
}

const char *iso_fleet_topic_out(const struct iso_fleet_id *door, char topic[ISO_FLEET_TOPIC_SIZE])
{
    return topic_of("door", door, "out", topic);
}

const char *iso_fleet_topic_online(const struct iso_fleet_id *door,
                                   char topic[ISO_FLEET_TOPIC_SIZE])
{
    return topic_of("door", door, "online", topic);
}
