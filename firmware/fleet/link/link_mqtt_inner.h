/* The parts of a client (link_mqtt.h), for its own sources. */
#ifndef ISO_FIRMWARE_FLEET_LINK_LINK_MQTT_INNER_H
#define ISO_FIRMWARE_FLEET_LINK_LINK_MQTT_INNER_H

#include <mosquitto.h>

#include "firmware/fleet/link/link_backoff.h"
#include "firmware/fleet/link/link_mqtt.h"

enum { LINK_MQTT_WHY_SIZE = 128 };

enum link_mqtt_state { LINK_MQTT_WAITING, LINK_MQTT_CONNECTING, LINK_MQTT_CONNECTED };

struct link_mqtt {
    sd_event *event;
    struct link_mqtt_calls calls;
    char *host, *client_id, *will_topic, *ca_file, *certificate_file, *key_file;
    uint16_t port;
    int keepalive_s;
    struct link_backoff backoff;

    enum link_mqtt_state state;
    struct mosquitto *client; /* of this attempt */
    sd_event_source *socket, *timer;
    bool has_socket_opened; /* the TCP connection is there, or has failed */
    bool is_broken;         /* the client is to be replaced as soon as nobody uses it */
    bool has_acceptance;    /* the broker has accepted the client; not reported yet */
    uint64_t since_us;      /* since when the state is as it is */
    char why[LINK_MQTT_WHY_SIZE];
};

/* Marks the connection as lost; the timer replaces it, because a caller may be on the stack. */
void link__mqtt_break(struct link_mqtt *mqtt, const char *why);

/* Makes the library's client of this attempt and begins to connect. Returns 0 or an error of the
 * library. */
int link__mqtt_open(struct link_mqtt *mqtt);

#endif
