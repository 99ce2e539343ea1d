/* The hub's connection to the broker: MQTT 5 by libmosquitto, on the event loop of the program. It
 * connects by itself, and again after each loss. Everything has QoS 1; what is published while
 * there is no connection is sent by libmosquitto when there is one again. One thread. */
#ifndef HUB_SERVE_MQTT_H
#define HUB_SERVE_MQTT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <systemd/sd-event.h>

#include "core/base/fault.h"

struct hub_mqtt;

struct hub_mqtt_setup {
    sd_event *event;
    const char *id; /* of the client: different for each process of a hub */
    const char *host;
    uint16_t port;
    const char *ca, *certificate, *key; /* PEM files; ca NULL: without TLS, for tests alone */
    /* The connection is there, or is lost. Subscriptions are lost with it. */
    void (*on_state)(void *context, bool is_connected);
    /* A message; topic and bytes are valid during the call, in which nothing may be published. */
    void (*on_message)(void *context, const char *topic, const void *bytes, size_t size);
    /* The broker has acknowledged a message. */
    void (*on_acknowledged)(void *context);
    void *context;
};

/* Begins to connect. All that `setup` points to has to live longer. -EINVAL the files of TLS cannot
 * be used, -ENOMEM. */
int hub_mqtt_new(const struct hub_mqtt_setup *setup, struct hub_mqtt **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* NULL is accepted. */
void hub_mqtt_free(struct hub_mqtt *mqtt);

bool hub_mqtt_is_connected(const struct hub_mqtt *mqtt);

/* -ENOTCONN, -ENOMEM. */
int hub_mqtt_subscribe(struct hub_mqtt *mqtt, const char *topic)
    __attribute__((warn_unused_result));
int hub_mqtt_unsubscribe(struct hub_mqtt *mqtt, const char *topic)
    __attribute__((warn_unused_result));

/* -ENOTCONN there is no connection (nothing is queued then), -EMSGSIZE, -ENOMEM. */
int hub_mqtt_publish(struct hub_mqtt *mqtt, const char *topic, const void *bytes, size_t size,
                     bool retain) __attribute__((warn_unused_result));

/* Since the start. The broker acknowledges messages in the order in which they were published, so
 * those published up to a count of `published` are with it when `acknowledged` is as high. */
struct hub_mqtt_counts {
    uint64_t published, acknowledged, received, attempts, connections;
    bool is_connected;
};
void hub_mqtt_counts(const struct hub_mqtt *mqtt, struct hub_mqtt_counts *out);

#endif
