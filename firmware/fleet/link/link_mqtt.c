#include "firmware/fleet/link/link_mqtt.h"

#include <errno.h>
#include <mosquitto.h>
#include <mqtt_protocol.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <time.h>

#include "firmware/fleet/link/link_mqtt_inner.h"
#include "firmware/fleet/message/envelope.h"

enum {
    BACKOFF_BASE_MS = 2000,
    BACKOFF_CAP_MS = 64000,
    KEEPALIVE_S = 30,
    KEEPALIVE_LEAST_S = 5,
    TCP_S = 15,    /* for the TCP connection */
    ANSWER_S = 60, /* for TCP, TLS and acceptance: a broker begins TLS with many doors at once */
    TICK_S = 5,    /* between two looks at the keep-alive */
    STEADY_S = 10, /* a connection that has lasted for so long was a success */
    TIMER_ACCURACY_US = 20000,
};

#define S_US UINT64_C(1000000)

static uint64_t now_us(const struct link_mqtt *mqtt)
{
    uint64_t now = 0;

    (void)sd_event_now(mqtt->event, CLOCK_BOOTTIME, &now);
    return now;
}

static void set_timer(struct link_mqtt *mqtt, uint64_t at_us)
{
    (void)sd_event_source_set_time(mqtt->timer, at_us);
    (void)sd_event_source_set_enabled(mqtt->timer, SD_EVENT_ONESHOT);
}

static uint64_t random_number(void)
{
    uint64_t random = 0;

    randombytes_buf(&random, sizeof random);
    return random;
}

static void wait_for_next(struct link_mqtt *mqtt)
{
    mqtt->state = LINK_MQTT_WAITING;
    mqtt->since_us = now_us(mqtt);
    set_timer(mqtt, mqtt->since_us + link_backoff_next_us(&mqtt->backoff, random_number()));
}

static void drop_client(struct link_mqtt *mqtt)
{
    mqtt->socket = sd_event_source_disable_unref(mqtt->socket);
    if (mqtt->client) {
        mosquitto_destroy(mqtt->client);
        mqtt->client = NULL;
    }
    mqtt->is_broken = false;
    mqtt->has_socket_opened = false;
    mqtt->has_acceptance = false;
}

/* Called where no function of the library is on the stack. */
static void lose(struct link_mqtt *mqtt)
{
    const bool was_connected = mqtt->state == LINK_MQTT_CONNECTED;
    char why[LINK_MQTT_WHY_SIZE];

    memcpy(why, mqtt->why, sizeof why);
    if (was_connected && now_us(mqtt) >= mqtt->since_us + STEADY_S * S_US) {
        link_backoff_reset(&mqtt->backoff);
    }
    drop_client(mqtt);
    wait_for_next(mqtt);
    mqtt->calls.lost(mqtt->calls.context, why);
}

static void say_why(struct link_mqtt *mqtt, const char *why)
{
    (void)snprintf(mqtt->why, sizeof mqtt->why, "%s", why);
}

void link__mqtt_break(struct link_mqtt *mqtt, const char *why)
{
    if (!mqtt->is_broken) {
        mqtt->is_broken = true;
        say_why(mqtt, why);
        mqtt->socket = sd_event_source_disable_unref(mqtt->socket);
        set_timer(mqtt, 0);
    }
}

/* After each call of the library: it may have closed the socket, and it may have to write. */
static int settle(struct link_mqtt *mqtt, int result)
{
    uint32_t events = EPOLLIN | EPOLLRDHUP;

    if (result != MOSQ_ERR_SUCCESS || mosquitto_socket(mqtt->client) < 0) {
        link__mqtt_break(mqtt, result == MOSQ_ERR_SUCCESS ? "the broker has ended the connection"
                               : result == MOSQ_ERR_ERRNO ? strerror(errno)
                                                          : mosquitto_strerror(result));
        return -ENOTCONN;
    }
    /* While TLS waits for the broker, the library wants to write CONNECT, and the socket can always
     * be written: it would wake the loop without end. So on_socket() writes after each read. */
    if (mqtt->state == LINK_MQTT_CONNECTING ? !mqtt->has_socket_opened
                                            : mosquitto_want_write(mqtt->client)) {
        events |= EPOLLOUT;
    }
    if (mqtt->socket) {
        (void)sd_event_source_set_io_events(mqtt->socket, events);
    }
    return 0;
}

/* ---- connecting ---- */

static int on_socket(sd_event_source *source, int fd, uint32_t revents, void *context);

static void try_to_connect(struct link_mqtt *mqtt)
{
    mqtt->state = LINK_MQTT_CONNECTING;
    mqtt->since_us = now_us(mqtt);
    int r = link__mqtt_open(mqtt);
    if (r) {
        link__mqtt_break(mqtt, r == MOSQ_ERR_ERRNO ? strerror(errno) : mosquitto_strerror(r));
        return;
    }
    r = sd_event_add_io(mqtt->event, &mqtt->socket, mosquitto_socket(mqtt->client),
                        EPOLLIN | EPOLLRDHUP | EPOLLOUT, on_socket, mqtt);
    if (r < 0) {
        link__mqtt_break(mqtt, strerror(-r));
        return;
    }
    set_timer(mqtt, mqtt->since_us + TCP_S * S_US);
}

static void accept_connection(struct link_mqtt *mqtt)
{
    mqtt->has_acceptance = false;
    mqtt->state = LINK_MQTT_CONNECTED;
    mqtt->since_us = now_us(mqtt);
    set_timer(mqtt, mqtt->since_us + TICK_S * S_US);
    if (mqtt->will_topic[0] &&
        link_mqtt_publish(mqtt, mqtt->will_topic, "1", 1, true, NULL) == -ENOTCONN) {
        return; /* lost again; the timer goes on from here */
    }
    mqtt->calls.connected(mqtt->calls.context);
}

/* ---- the event loop ---- */

/* Over TLS the library takes the error of a refused connection for one that is not there yet, and
 * takes it away from the socket; so a socket that has hung up has failed, whatever it says. */
static bool has_connect_failed(struct link_mqtt *mqtt, int fd, uint32_t revents)
{
    int error = 0;
    socklen_t size = sizeof error;

    if (mqtt->has_socket_opened) {
        return false;
    }
    mqtt->has_socket_opened = true;
    (void)getsockopt(fd, SOL_SOCKET, SO_ERROR, &error, &size);
    if (error == 0 && (revents & (EPOLLHUP | EPOLLERR))) {
        error = ECONNREFUSED;
    }
    if (error) {
        link__mqtt_break(mqtt, strerror(error));
    }
    return error != 0;
}

static int on_socket(sd_event_source *source, int fd, uint32_t revents, void *context)
{
    struct link_mqtt *mqtt = context;
    int r = 0;

    (void)source;
    if (has_connect_failed(mqtt, fd, revents)) {
        return 0;
    }
    /* Where TCP has not connected at once, the library begins TLS when it is told to read. */
    if ((revents & (EPOLLIN | EPOLLRDHUP | EPOLLHUP | EPOLLERR)) ||
        mqtt->state == LINK_MQTT_CONNECTING) {
        r = settle(mqtt, mosquitto_loop_read(mqtt->client, 1));
    }
    if (r == 0 && (revents & (EPOLLHUP | EPOLLRDHUP)) && mqtt->state == LINK_MQTT_CONNECTING &&
        !mqtt->has_acceptance) {
        /* During the beginning of TLS the library does not notice it, and would be called again
         * and again. */
        link__mqtt_break(mqtt, "the broker has hung up");
        return 0;
    }
    if (r == 0 && ((revents & EPOLLOUT) || mqtt->state == LINK_MQTT_CONNECTING)) {
        r = settle(mqtt, mosquitto_loop_write(mqtt->client, 1));
    }
    if (r == 0 && !mqtt->is_broken && mqtt->has_acceptance) {
        accept_connection(mqtt);
    }
    return 0;
}

static int on_time(sd_event_source *source, uint64_t at_us, void *context)
{
    struct link_mqtt *mqtt = context;

    (void)source;
    (void)at_us;
    if (mqtt->is_broken) {
        lose(mqtt);
        return 0;
    }
    switch (mqtt->state) {
    case LINK_MQTT_WAITING:
        try_to_connect(mqtt);
        break;
    case LINK_MQTT_CONNECTING:
        /* A door that gave up here would begin TLS anew, which costs a busy broker the same again.
         */
        if (mqtt->has_socket_opened && now_us(mqtt) < mqtt->since_us + ANSWER_S * S_US) {
            set_timer(mqtt, mqtt->since_us + ANSWER_S * S_US);
        } else {
            link__mqtt_break(mqtt, "the broker does not answer");
        }
        break;
    case LINK_MQTT_CONNECTED:
        if (settle(mqtt, mosquitto_loop_misc(mqtt->client)) == 0) {
            set_timer(mqtt, now_us(mqtt) + TICK_S * S_US);
        }
        break;
    }
    return 0;
}

/* ---- public ---- */

static bool copy_texts(struct link_mqtt *mqtt, const struct link_broker *broker,
                       const char *client_id, const char *will_topic)
{
    mqtt->host = strdup(broker->host);
    mqtt->client_id = strdup(client_id);
    mqtt->will_topic = strdup(will_topic);
    if (broker->ca_file && broker->certificate_file && broker->key_file) {
        mqtt->ca_file = strdup(broker->ca_file);
        mqtt->certificate_file = strdup(broker->certificate_file);
        mqtt->key_file = strdup(broker->key_file);
        if (!mqtt->ca_file || !mqtt->certificate_file || !mqtt->key_file) {
            return false;
        }
    }
    return mqtt->host && mqtt->client_id && mqtt->will_topic;
}

int link_mqtt_new(sd_event *event, const struct link_broker *broker, const char *client_id,
                  const char *will_topic, const struct link_mqtt_calls *calls,
                  struct link_mqtt **out, struct iso_fault *fault)
{
    if (!broker->host || !broker->host[0] || !!broker->ca_file != !!broker->certificate_file ||
        !!broker->ca_file != !!broker->key_file) {
        return iso_fault_set(fault, -EINVAL, "the broker: its host or a file is missing");
    }
    struct link_mqtt *mqtt = calloc(1, sizeof *mqtt);
    if (!mqtt || mosquitto_lib_init()) {
        free(mqtt);
        return iso_fault_set(fault, -ENOMEM, "the broker %s: out of memory", broker->host);
    }
    const int keepalive = broker->keepalive_s ? broker->keepalive_s : KEEPALIVE_S;
    mqtt->event = sd_event_ref(event);
    mqtt->calls = *calls;
    mqtt->port = broker->port;
    mqtt->keepalive_s = keepalive < KEEPALIVE_LEAST_S ? KEEPALIVE_LEAST_S : keepalive;
    mqtt->backoff = (struct link_backoff){
        .base_ms = broker->backoff_base_ms ? broker->backoff_base_ms : BACKOFF_BASE_MS,
        .cap_ms = broker->backoff_cap_ms ? broker->backoff_cap_ms : BACKOFF_CAP_MS};
    int r = copy_texts(mqtt, broker, client_id, will_topic) ? 0 : -ENOMEM;
    r = r < 0 ? r
              : sd_event_add_time(event, &mqtt->timer, CLOCK_BOOTTIME, 0, TIMER_ACCURACY_US,
                                  on_time, mqtt);
    if (r < 0) {
        link_mqtt_free(mqtt);
        return iso_fault_set(fault, r, "the broker %s: %s", broker->host, strerror(-r));
    }
    wait_for_next(mqtt);
    link_backoff_reset(&mqtt->backoff);
    *out = mqtt;
    return 0;
}

void link_mqtt_free(struct link_mqtt *mqtt)
{
    if (!mqtt) {
        return;
    }
    if (mqtt->client && mqtt->state == LINK_MQTT_CONNECTED && !mqtt->is_broken) {
        (void)mosquitto_disconnect_v5(mqtt->client, MQTT_RC_DISCONNECT_WITH_WILL_MSG, NULL);
    }
    drop_client(mqtt);
    (void)sd_event_source_disable_unref(mqtt->timer);
    (void)sd_event_unref(mqtt->event);
    free(mqtt->host);
    free(mqtt->client_id);
    free(mqtt->will_topic);
    free(mqtt->ca_file);
    free(mqtt->certificate_file);
    free(mqtt->key_file);
    free(mqtt);
    (void)mosquitto_lib_cleanup();
}

bool link_mqtt_is_connected(const struct link_mqtt *mqtt)
{
    return mqtt->state == LINK_MQTT_CONNECTED && !mqtt->is_broken;
}

/* A message that the library refuses is no loss of the connection. */
static int result_of(struct link_mqtt *mqtt, int result)
{
    switch (result) {
    case MOSQ_ERR_NOMEM:
        return -ENOMEM;
    case MOSQ_ERR_PAYLOAD_SIZE:
    case MOSQ_ERR_OVERSIZE_PACKET:
        return -EMSGSIZE;
    case MOSQ_ERR_INVAL:
    case MOSQ_ERR_MALFORMED_UTF8:
        return -EINVAL;
    default:
        return settle(mqtt, result);
    }
}

int link_mqtt_publish(struct link_mqtt *mqtt, const char *topic, const void *bytes, size_t size,
                      bool retain, int *id)
{
    if (!link_mqtt_is_connected(mqtt)) {
        return -ENOTCONN;
    }
    if (size > ISO_FLEET_MESSAGE_MAX) {
        return -EMSGSIZE;
    }
    return result_of(
        mqtt, mosquitto_publish_v5(mqtt->client, id, topic, (int)size, bytes, 1, retain, NULL));
}

int link_mqtt_subscribe(struct link_mqtt *mqtt, const char *const topics[], int n, int *id)
{
    if (!link_mqtt_is_connected(mqtt)) {
        return -ENOTCONN;
    }
    return result_of(mqtt, mosquitto_subscribe_multiple(
                               mqtt->client, id, n, (char *const *)(uintptr_t)topics, 1, 0, NULL));
}

int link_mqtt_unsubscribe(struct link_mqtt *mqtt, const char *const topics[], int n)
{
    if (!link_mqtt_is_connected(mqtt)) {
        return -ENOTCONN;
    }
    return result_of(mqtt, mosquitto_unsubscribe_multiple(mqtt->client, NULL, n,
                                                          (char *const *)(uintptr_t)topics, NULL));
}

void link_mqtt_renew(struct link_mqtt *mqtt)
{
    if (mqtt->state != LINK_MQTT_WAITING) {
        link__mqtt_break(mqtt, "the door's certificate is new");
    }
}
