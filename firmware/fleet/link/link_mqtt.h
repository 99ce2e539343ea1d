/* The connection of one door to the broker: a client of MQTT 5 without a thread, which an event
 * loop of systemd drives. It connects by itself, again after each loss (link_backoff.h), and reads
 * the files of its certificate anew each time.
 *
 *   state       goes on to
 *   WAITING     CONNECTING  the wait is over
 *   CONNECTING  CONNECTED   the broker has accepted the client: `connected`
 *               WAITING     refused, or no answer in 15 s: `lost`
 *   CONNECTED   WAITING     the connection is lost: `lost`
 *
 * The session is a new one each time, and nothing of the old one is sent again: who publishes knows
 * by `lost` what may have got lost. The broker publishes "0" on the topic of the will when it loses
 * the client; the client publishes "1" there when it is connected. Both are retained.
 *
 * The callbacks are called from the event loop, and from no function of this header. They may
 * publish and subscribe; they must not free the client. */
#ifndef ISO_FIRMWARE_FLEET_LINK_LINK_MQTT_H
#define ISO_FIRMWARE_FLEET_LINK_LINK_MQTT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <systemd/sd-event.h>

#include "core/base/fault.h"

struct link_mqtt;

/* Where the broker is. The texts are copied. */
struct link_broker {
    const char *host;
    uint16_t port;
    /* PEM files of the authority of the broker's certificate, and of the door's own certificate
     * with its key. All NULL: without TLS, for tests. */
    const char *ca_file, *certificate_file, *key_file;
    uint32_t backoff_base_ms, backoff_cap_ms; /* 0: 2 s and 64 s */
    uint16_t keepalive_s;                     /* 0: 30 s; at least 5 */
};

struct link_mqtt_calls {
    void *context;
    void (*connected)(void *context);
    /* `why` is one line for people. */
    void (*lost)(void *context, const char *why);
    /* The broker has answered a subscription; granted: it accepts every topic of it. */
    void (*subscribed)(void *context, int id, bool granted);
    void (*message)(void *context, const char *topic, const void *bytes, size_t size);
    /* The broker has a message of QoS 1. */
    void (*published)(void *context, int id);
    /* The broker had nobody to give a message to: the hub is away. May be NULL. */
    void (*unheard)(void *context);
};

/* Makes a client, which connects after a random time of at most backoff_base_ms. `will_topic` is
 * "": there is no will. The caller frees *out. -ENOMEM, -EINVAL the host is missing, errors of the
 * event loop. */
int link_mqtt_new(sd_event *event, const struct link_broker *broker, const char *client_id,
                  const char *will_topic, const struct link_mqtt_calls *calls,
                  struct link_mqtt **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Ends the connection; the broker then publishes the will. May be NULL. */
void link_mqtt_free(struct link_mqtt *mqtt);

bool link_mqtt_is_connected(const struct link_mqtt *mqtt);

/* Publishes with QoS 1. *id, which may be NULL, is the number that `published` repeats. -ENOTCONN
 * there is no connection; -ENOMEM, -EMSGSIZE. */
int link_mqtt_publish(struct link_mqtt *mqtt, const char *topic, const void *bytes, size_t size,
                      bool retain, int *id) __attribute__((warn_unused_result));

/* Subscribes to topics, or to no longer, with QoS 1. Errors as above. */
int link_mqtt_subscribe(struct link_mqtt *mqtt, const char *const topics[], int n, int *id)
    __attribute__((warn_unused_result));
int link_mqtt_unsubscribe(struct link_mqtt *mqtt, const char *const topics[], int n)
    __attribute__((warn_unused_result));

/* Drops the connection and makes a new one, with the present files. */
void link_mqtt_renew(struct link_mqtt *mqtt);

#endif
