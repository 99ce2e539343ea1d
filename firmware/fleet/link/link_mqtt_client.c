/* The library's client of one attempt to connect. Its callbacks run while a function of the library
 * is on the stack. */
#include <mosquitto.h>
#include <mqtt_protocol.h>
#include <stdio.h>

#include "firmware/fleet/link/link_mqtt_inner.h"

enum { INFLIGHT = 20 /* messages of each direction that are not acknowledged */ };

static void on_connect(struct mosquitto *client, void *context, int reason, int flags,
                       const mosquitto_property *properties)
{
    struct link_mqtt *mqtt = context;

    (void)client;
    (void)flags;
    (void)properties;
    if (reason) {
        char why[LINK_MQTT_WHY_SIZE];
        (void)snprintf(why, sizeof why, "the broker refuses the door: %s",
                       mosquitto_reason_string(reason));
        link__mqtt_break(mqtt, why);
    } else {
        mqtt->has_acceptance = true;
    }
}

static void on_message(struct mosquitto *client, void *context,
                       const struct mosquitto_message *message,
                       const mosquitto_property *properties)
{
    struct link_mqtt *mqtt = context;

    (void)client;
    (void)properties;
    if (message->payloadlen > 0) {
        mqtt->calls.message(mqtt->calls.context, message->topic, message->payload,
                            (size_t)message->payloadlen);
    }
}

static void on_subscribe(struct mosquitto *client, void *context, int id, int n, const int *reasons,
                         const mosquitto_property *properties)
{
    struct link_mqtt *mqtt = context;
    bool is_granted = true;

    (void)client;
    (void)properties;
    for (int i = 0; i < n; i++) {
        is_granted = is_granted && reasons[i] < 0x80;
    }
    mqtt->calls.subscribed(mqtt->calls.context, id, is_granted);
}

static void on_publish(struct mosquitto *client, void *context, int id, int reason,
                       const mosquitto_property *properties)
{
    struct link_mqtt *mqtt = context;

    (void)client;
    (void)properties;
    if (reason == MQTT_RC_NO_MATCHING_SUBSCRIBERS && mqtt->calls.unheard) {
        mqtt->calls.unheard(mqtt->calls.context);
    }
    mqtt->calls.published(mqtt->calls.context, id);
}

static int prepare(struct link_mqtt *mqtt)
{
    struct mosquitto *client = mqtt->client;
    int r = mosquitto_int_option(client, MOSQ_OPT_PROTOCOL_VERSION, MQTT_PROTOCOL_V5);

    r = r ? r : mosquitto_int_option(client, MOSQ_OPT_RECEIVE_MAXIMUM, INFLIGHT);
    r = r ? r : mosquitto_int_option(client, MOSQ_OPT_SEND_MAXIMUM, INFLIGHT);
    r = r ? r : mosquitto_int_option(client, MOSQ_OPT_TCP_NODELAY, 1);
    if (r == 0 && mqtt->will_topic[0]) {
        r = mosquitto_will_set_v5(client, mqtt->will_topic, 1, "0", 1, true, NULL);
    }
    if (r == 0 && mqtt->ca_file) {
        r = mosquitto_tls_set(client, mqtt->ca_file, NULL, mqtt->certificate_file, mqtt->key_file,
                              NULL);
        r = r ? r : mosquitto_tls_opts_set(client, 1, "tlsv1.2", NULL);
    }
    mosquitto_connect_v5_callback_set(client, on_connect);
    mosquitto_message_v5_callback_set(client, on_message);
    mosquitto_subscribe_v5_callback_set(client, on_subscribe);
    mosquitto_publish_v5_callback_set(client, on_publish);
    return r;
}

/* The library of this version has no function that connects without waiting and takes properties.
 * So it connects with the defaults: a broker may send packets of any size, and the receiver of a
 * message bounds it. */
int link__mqtt_open(struct link_mqtt *mqtt)
{
    mqtt->client = mosquitto_new(mqtt->client_id, true, mqtt);
    int r = mqtt->client ? prepare(mqtt) : MOSQ_ERR_NOMEM;

    r = r ? r
          : mosquitto_connect_bind_async(mqtt->client, mqtt->host, mqtt->port, mqtt->keepalive_s,
                                         NULL);
    return r;
}
