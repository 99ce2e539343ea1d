#include "tests/enroll/hub/rigs/broker_rig.h"

#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#define MOSQUITTO "/usr/sbin/mosquitto"

bool broker_rig_is_possible(void)
{
    if (access(MOSQUITTO, X_OK) == 0) {
        return true;
    }
    puts("skipped: mosquitto is not installed");
    return false;
}

static int connect_to(uint16_t port)
{
    const struct sockaddr_in address = {
        .sin_family = AF_INET, .sin_port = htons(port), .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);

    assert_true(fd >= 0);
    const int r = connect(fd, (const struct sockaddr *)&address, sizeof address);
    (void)close(fd);
    return r;
}

uint16_t broker_rig_port(void)
{
    struct sockaddr_in address = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    socklen_t size = sizeof address;
    const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);

    assert_true(fd >= 0);
    assert_int_equal(bind(fd, (const struct sockaddr *)&address, size), 0);
    assert_int_equal(getsockname(fd, (struct sockaddr *)&address, &size), 0);
    (void)close(fd);
    return ntohs(address.sin_port);
}

void broker_rig_start(struct broker_rig *rig, const char *config, uint16_t port, const char *log)
{
    rig->port = port;
    rig->pid = fork();
    assert_true(rig->pid >= 0);
    if (rig->pid == 0) {
        const int fd = open(log, O_WRONLY | O_CREAT | O_APPEND, 0600);
        (void)prctl(PR_SET_PDEATHSIG, SIGKILL);
        (void)dup2(fd, STDOUT_FILENO);
        (void)dup2(fd, STDERR_FILENO);
        (void)execl(MOSQUITTO, MOSQUITTO, "-c", config, (char *)NULL);
        _exit(127);
    }
    for (int i = 0; i < 500; i++) {
        if (connect_to(port) == 0) {
            return;
        }
        int status;
        if (waitpid(rig->pid, &status, WNOHANG) == rig->pid) {
            rig->pid = 0;
            fail_msg("mosquitto has ended; see %s", log);
        }
        (void)usleep(20000);
    }
    fail_msg("mosquitto does not listen on port %u", port);
}

void broker_rig_reload(const struct broker_rig *rig)
{
    assert_int_equal(kill(rig->pid, SIGHUP), 0);
    (void)usleep(
        300000); /* mosquitto does it in its loop, and says nothing that could be waited for */
}

void broker_rig_stop(struct broker_rig *rig)
{
    if (rig->pid > 0) {
        (void)kill(rig->pid, SIGKILL);
        (void)waitpid(rig->pid, NULL, 0);
        rig->pid = 0;
    }
}

/* ---- clients ---- */

static int64_t now_ns(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

static void set(struct broker_client *client, int *what, int value)
{
    (void)pthread_mutex_lock(&client->lock);
    *what = value;
    (void)pthread_cond_broadcast(&client->changed);
    (void)pthread_mutex_unlock(&client->lock);
}

static void on_connect(struct mosquitto *m, void *context, int code, int flags,
                       const mosquitto_property *properties)
{
    struct broker_client *client = context;
    (void)m;
    (void)flags;
    (void)properties;
    set(client, &client->connected, code == 0 ? 1 : -1);
}

static void on_disconnect(struct mosquitto *m, void *context, int code,
                          const mosquitto_property *properties)
{
    struct broker_client *client = context;
    (void)m;
    (void)code;
    (void)properties;
    set(client, &client->connected, -1);
}

static void on_subscribe(struct mosquitto *m, void *context, int mid, int n, const int *granted,
                         const mosquitto_property *properties)
{
    struct broker_client *client = context;
    (void)m;
    (void)n;
    (void)granted;
    (void)properties;
    set(client, &client->subscribed, mid);
}

static void on_publish(struct mosquitto *m, void *context, int mid, int reason,
                       const mosquitto_property *properties)
{
    struct broker_client *client = context;
    (void)m;
    (void)reason;
    (void)properties;
    set(client, &client->published, mid);
}

static void on_message(struct mosquitto *m, void *context, const struct mosquitto_message *message,
                       const mosquitto_property *properties)
{
    struct broker_client *client = context;
    (void)m;
    (void)properties;
    (void)pthread_mutex_lock(&client->lock);
    if (client->n < BROKER_CLIENT_MESSAGES) {
        struct broker_message *out = &client->messages[client->n++];
        (void)snprintf(out->topic, sizeof out->topic, "%s", message->topic);
        out->size = (size_t)message->payloadlen;
        out->bytes = malloc(out->size + 1);
        memcpy(out->bytes, message->payload ? message->payload : "", out->size);
        ((char *)out->bytes)[out->size] = '\0';
        out->at_ns = now_ns();
        out->retain = message->retain;
    }
    (void)pthread_cond_broadcast(&client->changed);
    (void)pthread_mutex_unlock(&client->lock);
}

/* Waits until a number has a value; false: the time is over or the connection has ended. */
static bool wait_for(struct broker_client *client, const int *what, int value, double seconds)
{
    struct timespec until;
    int r = 0;

    (void)clock_gettime(CLOCK_REALTIME, &until);
    until.tv_sec += (time_t)seconds;
    (void)pthread_mutex_lock(&client->lock);
    while (*what != value && client->connected >= 0 && r == 0) {
        r = pthread_cond_timedwait(&client->changed, &client->lock, &until);
    }
    const bool ok = *what == value;
    (void)pthread_mutex_unlock(&client->lock);
    return ok;
}

/* The library's own thread may never end: it takes a client whose connection is just accepted for
 * one that shall stay. */
static void *run_client(void *context)
{
    struct broker_client *client = context;

    while (!__atomic_load_n(&client->ends, __ATOMIC_ACQUIRE)) {
        if (mosquitto_loop(client->mosquitto, 50, 1) != MOSQ_ERR_SUCCESS &&
            !__atomic_load_n(&client->ends, __ATOMIC_ACQUIRE)) {
            (void)usleep(50000);
            (void)mosquitto_reconnect_async(client->mosquitto);
        }
    }
    (void)mosquitto_loop_write(client->mosquitto, 1); /* the end of the connection */
    return NULL;
}

void broker_client_begin(struct broker_client *client, const char *id, uint16_t port,
                         const char *ca, const char *certificate, const char *key)
{
    memset(client, 0, sizeof *client);
    (void)pthread_mutex_init(&client->lock, NULL);
    (void)pthread_cond_init(&client->changed, NULL);
    (void)mosquitto_lib_init();
    client->mosquitto = mosquitto_new(id, true, client);
    assert_non_null(client->mosquitto);
    (void)mosquitto_int_option(client->mosquitto, MOSQ_OPT_PROTOCOL_VERSION, MQTT_PROTOCOL_V5);
    (void)mosquitto_int_option(client->mosquitto, MOSQ_OPT_RECEIVE_MAXIMUM, 1000);
    mosquitto_connect_v5_callback_set(client->mosquitto, on_connect);
    mosquitto_disconnect_v5_callback_set(client->mosquitto, on_disconnect);
    mosquitto_subscribe_v5_callback_set(client->mosquitto, on_subscribe);
    mosquitto_publish_v5_callback_set(client->mosquitto, on_publish);
    mosquitto_message_v5_callback_set(client->mosquitto, on_message);
    if (ca) {
        assert_int_equal(mosquitto_tls_set(client->mosquitto, ca, NULL, certificate, key, NULL), 0);
    }
    if (mosquitto_connect_async(client->mosquitto, "127.0.0.1", port, 60) != MOSQ_ERR_SUCCESS) {
        client->connected = -1;
    }
    (void)mosquitto_threaded_set(client->mosquitto, true);
    assert_int_equal(pthread_create(&client->thread, NULL, run_client, client), 0);
}

void broker_client_subscribe(struct broker_client *client, const char *topic)
{
    int mid = 0;

    assert_int_equal(mosquitto_subscribe(client->mosquitto, &mid, topic, 1), 0);
    assert_true(wait_for(client, &client->subscribed, mid, 10));
}

bool broker_client_connects(struct broker_client *client)
{
    return wait_for(client, &client->connected, 1, 10);
}

void broker_client_publish(struct broker_client *client, const char *topic, const void *bytes,
                           size_t size, bool retain)
{
    int mid = 0;

    assert_int_equal(mosquitto_publish(client->mosquitto, &mid, topic, (int)size, bytes, 1, retain),
                     0);
    assert_true(wait_for(client, &client->published, mid, 10));
}

int broker_client_wait(struct broker_client *client, const char *topic, size_t from, double seconds)
{
    const int64_t until_ns = now_ns() + (int64_t)(seconds * 1e9);

    do {
        (void)pthread_mutex_lock(&client->lock);
        for (size_t i = from; i < client->n; i++) {
            if (strcmp(client->messages[i].topic, topic) == 0) {
                (void)pthread_mutex_unlock(&client->lock);
                return (int)i;
            }
        }
        (void)pthread_mutex_unlock(&client->lock);
        (void)usleep(5000);
    } while (now_ns() < until_ns);
    return -1;
}

void broker_client_end(struct broker_client *client)
{
    if (!client->mosquitto) {
        return;
    }
    (void)mosquitto_disconnect(client->mosquitto);
    __atomic_store_n(&client->ends, true, __ATOMIC_RELEASE);
    (void)pthread_join(client->thread, NULL);
    mosquitto_destroy(client->mosquitto);
    client->mosquitto = NULL;
    for (size_t i = 0; i < client->n; i++) {
        free(client->messages[i].bytes);
    }
    client->n = 0;
    (void)pthread_cond_destroy(&client->changed);
    (void)pthread_mutex_destroy(&client->lock);
}
