#include "enroll/hub/serve/mqtt.h"

#include <errno.h>
#include <mosquitto.h>
#include <mqtt_protocol.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <systemd/sd-daemon.h>

#include "enroll/web/http/now.h"

enum {
    KEEPALIVE_S = 30,
    TICK_MS = 1000, /* libmosquitto's own work: keepalive */
    CONNECTING_MS =
        20, /* while the connection is made, libmosquitto does not say what it waits for */
    TCP_MOST_MS = 10000,     /* for the TCP connection */
    CONNECT_MOST_MS = 60000, /* for TCP, TLS and acceptance: many doors may begin TLS at once */
    RETRY_FIRST_MS = 500,
    RETRY_MOST_MS = 5000,
    PACKETS_AT_ONCE = 64, /* then other sources of the loop get their turn */
};

struct hub_mqtt {
    struct hub_mqtt_setup setup;
    struct mosquitto *mosquitto;
    sd_event_source *io, *timer, *more;
    int fd; /* of `io`; -1: none */
    bool is_connecting, is_connected;
    bool progressed; /* a callback was called */
    int64_t begun_ms, retry_ms;
    struct hub_mqtt_counts counts;
};

static int64_t now_ms(void)
{
    return web_now_ns() / 1000000;
}

static void set_timer(struct hub_mqtt *mqtt, int64_t ms)
{
    (void)sd_event_source_set_time_relative(mqtt->timer, (uint64_t)ms * 1000);
    (void)sd_event_source_set_enabled(mqtt->timer, SD_EVENT_ONESHOT);
}

/* ---- callbacks of libmosquitto ---- */

static void on_connect(struct mosquitto *m, void *context, int code, int flags,
                       const mosquitto_property *properties)
{
    struct hub_mqtt *mqtt = context;
    (void)m, (void)flags, (void)properties;
    mqtt->progressed = true;
    if (code != 0) {
        fprintf(stderr, SD_WARNING "isotherm-hub: the broker refuses the hub: %s\n",
                mosquitto_reason_string(code));
        return; /* the broker closes the connection */
    }
    mqtt->is_connecting = false;
    mqtt->is_connected = true;
    mqtt->retry_ms = RETRY_FIRST_MS;
    mqtt->counts.connections++;
}

static void on_publish(struct mosquitto *m, void *context, int mid, int reason,
                       const mosquitto_property *properties)
{
    struct hub_mqtt *mqtt = context;
    (void)m, (void)mid, (void)properties;
    mqtt->progressed = true;
    mqtt->counts.acknowledged++;
    if (reason >= 128) {
        fprintf(stderr, SD_ERR "isotherm-hub: the broker refuses a message of the hub: %s\n",
                mosquitto_reason_string(reason));
    }
    mqtt->setup.on_acknowledged(mqtt->setup.context);
}

static void on_message(struct mosquitto *m, void *context, const struct mosquitto_message *message,
                       const mosquitto_property *properties)
{
    struct hub_mqtt *mqtt = context;
    (void)m, (void)properties;
    mqtt->progressed = true;
    mqtt->counts.received++;
    mqtt->setup.on_message(mqtt->setup.context, message->topic,
                           message->payload ? message->payload : "", (size_t)message->payloadlen);
}

/* ---- the connection ---- */

static int on_io(sd_event_source *source, int fd, uint32_t events, void *context);

/* Watches the socket that libmosquitto has now, and for what it waits. */
static void watch(struct hub_mqtt *mqtt)
{
    const int fd = mosquitto_socket(mqtt->mosquitto);

    if (fd != mqtt->fd) {
        mqtt->io = sd_event_source_disable_unref(mqtt->io);
        mqtt->fd = -1;
        if (fd >= 0 &&
            sd_event_add_io(mqtt->setup.event, &mqtt->io, fd, EPOLLIN, on_io, mqtt) >= 0) {
            mqtt->fd = fd;
        }
    }
    if (mqtt->io) {
        const bool out = mqtt->is_connected && mosquitto_want_write(mqtt->mosquitto);
        (void)sd_event_source_set_io_events(mqtt->io, out ? EPOLLIN | EPOLLOUT : EPOLLIN);
    }
}

static void lose(struct hub_mqtt *mqtt, const char *why)
{
    const bool was_connected = mqtt->is_connected;

    fprintf(stderr, SD_WARNING "isotherm-hub: broker %s:%u: %s\n", mqtt->setup.host,
            mqtt->setup.port, why);
    mqtt->is_connected = mqtt->is_connecting = false;
    mqtt->io = sd_event_source_disable_unref(mqtt->io);
    mqtt->fd = -1;
    set_timer(mqtt, mqtt->retry_ms);
    mqtt->retry_ms = 2 * mqtt->retry_ms < RETRY_MOST_MS ? 2 * mqtt->retry_ms : RETRY_MOST_MS;
    if (was_connected) {
        mqtt->setup.on_state(mqtt->setup.context, false);
    }
}

/* Reads what has come. TLS may have decrypted more than the socket shows, so reading ends only when
 * there is nothing more. Returns whether there may be more. */
static bool read_packets(struct hub_mqtt *mqtt, int *code)
{
    for (int i = 0; i < PACKETS_AT_ONCE; i++) {
        mqtt->progressed = false;
        errno = 0;
        *code = mosquitto_loop_read(mqtt->mosquitto, 1);
        /* A callback may have changed errno. */
        if (*code != MOSQ_ERR_SUCCESS ||
            (!mqtt->progressed && (errno == EAGAIN || errno == EWOULDBLOCK))) {
            return false;
        }
    }
    return true;
}

/* What poll() says of the socket of a connection that is being made: 0, TCP is not there yet. */
static short tcp_events(const struct hub_mqtt *mqtt)
{
    struct pollfd fd = {.fd = mosquitto_socket(mqtt->mosquitto), .events = POLLOUT};

    return fd.fd >= 0 && poll(&fd, 1, 0) > 0 ? fd.revents : 0;
}

/* Over TLS libmosquitto takes a connection that was refused for one that is not there yet, and
 * would wait for it. */
static bool was_refused(const struct hub_mqtt *mqtt)
{
    return tcp_events(mqtt) & (POLLERR | POLLHUP);
}

static bool is_late(const struct hub_mqtt *mqtt)
{
    return now_ms() - mqtt->begun_ms > (tcp_events(mqtt) ? CONNECT_MOST_MS : TCP_MOST_MS);
}

/* Lets libmosquitto work. */
static void work(struct hub_mqtt *mqtt)
{
    const bool was_connected = mqtt->is_connected;
    bool more = false;
    int code;

    if (mqtt->is_connecting && was_refused(mqtt)) {
        (void)mosquitto_disconnect(mqtt->mosquitto);
        lose(mqtt, "the connection was refused");
        return;
    }
    if (mqtt->is_connecting) {
        code = mosquitto_loop(mqtt->mosquitto, 0, 1);
    } else {
        more = read_packets(mqtt, &code);
        code = code ? code : mosquitto_loop_write(mqtt->mosquitto, 1);
        code = code ? code : mosquitto_loop_misc(mqtt->mosquitto);
    }
    if (code != MOSQ_ERR_SUCCESS) {
        lose(mqtt, mosquitto_strerror(code));
        return;
    }
    if (mqtt->is_connected && !was_connected) {
        mqtt->setup.on_state(mqtt->setup.context, true);
    }
    watch(mqtt);
    if (more) {
        (void)sd_event_source_set_enabled(mqtt->more, SD_EVENT_ONESHOT);
    }
}

static int on_io(sd_event_source *source, int fd, uint32_t events, void *context)
{
    (void)source;
    (void)fd;
    (void)events;
    work(context);
    return 0;
}

static int on_more(sd_event_source *source, void *context)
{
    struct hub_mqtt *mqtt = context;

    (void)source;
    if (mqtt->is_connected) {
        work(mqtt);
    }
    return 0;
}

static void begin(struct hub_mqtt *mqtt)
{
    mqtt->is_connecting = true;
    mqtt->begun_ms = now_ms();
    mqtt->counts.attempts++;
    const int code = mosquitto_connect_async(mqtt->mosquitto, mqtt->setup.host, mqtt->setup.port,
                                             KEEPALIVE_S);
    if (code != MOSQ_ERR_SUCCESS) {
        lose(mqtt, code == MOSQ_ERR_ERRNO ? strerror(errno) : mosquitto_strerror(code));
        return;
    }
    watch(mqtt);
    set_timer(mqtt, CONNECTING_MS);
}

static int on_timer(sd_event_source *source, uint64_t usec, void *context)
{
    struct hub_mqtt *mqtt = context;

    (void)source;
    (void)usec;
    if (!mqtt->is_connecting && !mqtt->is_connected) {
        begin(mqtt);
        return 0;
    }
    if (mqtt->is_connecting && is_late(mqtt)) {
        (void)mosquitto_disconnect(mqtt->mosquitto);
        lose(mqtt, "it does not answer");
        return 0;
    }
    set_timer(mqtt, mqtt->is_connecting ? CONNECTING_MS : TICK_MS);
    work(mqtt);
    return 0;
}

/* ---- what others call ---- */

static int configure(struct hub_mqtt *mqtt, struct iso_fault *fault)
{
    const struct hub_mqtt_setup *setup = &mqtt->setup;
    struct mosquitto *m = mqtt->mosquitto;

    (void)mosquitto_int_option(m, MOSQ_OPT_PROTOCOL_VERSION, MQTT_PROTOCOL_V5);
    /* The standard window of 20 messages would let a hub with many doors wait for the broker. */
    (void)mosquitto_int_option(m, MOSQ_OPT_SEND_MAXIMUM, UINT16_MAX);
    (void)mosquitto_int_option(m, MOSQ_OPT_RECEIVE_MAXIMUM, UINT16_MAX);
    (void)mosquitto_int_option(m, MOSQ_OPT_TCP_NODELAY, 1);
    mosquitto_connect_v5_callback_set(m, on_connect);
    mosquitto_publish_v5_callback_set(m, on_publish);
    mosquitto_message_v5_callback_set(m, on_message);
    if (setup->ca &&
        mosquitto_tls_set(m, setup->ca, NULL, setup->certificate, setup->key, NULL) != 0) {
        return iso_fault_set(fault, -EINVAL, "broker %s: %s, %s or %s cannot be read", setup->host,
                             setup->ca, setup->certificate, setup->key);
    }
    return 0;
}

int hub_mqtt_new(const struct hub_mqtt_setup *setup, struct hub_mqtt **out, struct iso_fault *fault)
{
    struct hub_mqtt *mqtt = calloc(1, sizeof *mqtt);

    (void)mosquitto_lib_init();
    if (mqtt) {
        mqtt->setup = *setup;
        mqtt->fd = -1;
        mqtt->retry_ms = RETRY_FIRST_MS;
        mqtt->mosquitto = mosquitto_new(setup->id, true, mqtt);
    }
    if (!mqtt || !mqtt->mosquitto) {
        hub_mqtt_free(mqtt);
        return iso_fault_set(fault, -ENOMEM, "out of memory for the connection to the broker");
    }
    int r = configure(mqtt, fault);
    if (r == 0) {
        r = sd_event_add_time_relative(setup->event, &mqtt->timer, CLOCK_MONOTONIC, 0, 1000,
                                       on_timer, mqtt);
        r = r < 0 ? r : sd_event_add_defer(setup->event, &mqtt->more, on_more, mqtt);
        r = r < 0 ? r : sd_event_source_set_enabled(mqtt->more, SD_EVENT_OFF);
        r = r < 0 ? iso_fault_set(fault, r, "the event loop: %s", strerror(-r)) : 0;
    }
    if (r < 0) {
        hub_mqtt_free(mqtt);
        return r;
    }
    *out = mqtt;
    return 0;
}

void hub_mqtt_free(struct hub_mqtt *mqtt)
{
    if (!mqtt) {
        return;
    }
    sd_event_source_disable_unref(mqtt->io);
    sd_event_source_disable_unref(mqtt->timer);
    sd_event_source_disable_unref(mqtt->more);
    if (mqtt->mosquitto) {
        (void)mosquitto_disconnect(mqtt->mosquitto);
        mosquitto_destroy(mqtt->mosquitto);
    }
    free(mqtt);
}

bool hub_mqtt_is_connected(const struct hub_mqtt *mqtt)
{
    return mqtt->is_connected;
}

static int error_of(int code)
{
    switch (code) {
    case MOSQ_ERR_SUCCESS:
        return 0;
    case MOSQ_ERR_NOMEM:
        return -ENOMEM;
    case MOSQ_ERR_PAYLOAD_SIZE:
    case MOSQ_ERR_OVERSIZE_PACKET:
        return -EMSGSIZE;
    default:
        return -ENOTCONN;
    }
}

int hub_mqtt_subscribe(struct hub_mqtt *mqtt, const char *topic)
{
    const int r = mqtt->is_connected
                      ? error_of(mosquitto_subscribe(mqtt->mosquitto, NULL, topic, 1))
                      : -ENOTCONN;
    watch(mqtt);
    return r;
}

int hub_mqtt_unsubscribe(struct hub_mqtt *mqtt, const char *topic)
{
    const int r = mqtt->is_connected ? error_of(mosquitto_unsubscribe(mqtt->mosquitto, NULL, topic))
                                     : -ENOTCONN;
    watch(mqtt);
    return r;
}

int hub_mqtt_publish(struct hub_mqtt *mqtt, const char *topic, const void *bytes, size_t size,
                     bool retain)
{
    if (!mqtt->is_connected) {
        return -ENOTCONN;
    }
    const int r = error_of(
        mosquitto_publish(mqtt->mosquitto, NULL, topic, (int)size, bytes, 1, retain));
    if (r == 0) {
        mqtt->counts.published++;
    }
    watch(mqtt);
    return r;
}

void hub_mqtt_counts(const struct hub_mqtt *mqtt, struct hub_mqtt_counts *out)
{
    *out = mqtt->counts;
    out->is_connected = mqtt->is_connected;
}
