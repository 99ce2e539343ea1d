/* A real mosquitto for a test, started from a configuration file, and clients of it. Failures fail
 * the running cmocka test. */
#ifndef TESTS_HUB_RIGS_BROKER_RIG_H
#define TESTS_HUB_RIGS_BROKER_RIG_H

#include <mosquitto.h>
#include <pthread.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

/* Whether mosquitto is installed; else a line says that the test is skipped. */
bool broker_rig_is_possible(void);

/* A port of localhost on which nothing listens. */
uint16_t broker_rig_port(void);

struct broker_rig {
    pid_t pid;
    uint16_t port;
};

/* Starts mosquitto with a configuration and waits until the port accepts connections: that of the
 * last listener. What it says
 * is written to LOG. */
void broker_rig_start(struct broker_rig *rig, const char *config, uint16_t port, const char *log);
void broker_rig_reload(const struct broker_rig *rig); /* SIGHUP */
void broker_rig_stop(struct broker_rig *rig);

enum { BROKER_CLIENT_MESSAGES = 4096 };

struct broker_message {
    char topic[96];
    void *bytes;
    size_t size;
    int64_t at_ns; /* monotonic */
    bool retain;
};

struct broker_client {
    struct mosquitto *mosquitto;
    pthread_t thread;
    bool ends;
    pthread_mutex_t lock;
    pthread_cond_t changed;
    int connected; /* 0: not yet, 1: it is, -1: it was refused or has ended */
    int subscribed, published;
    size_t n;
    struct broker_message messages[BROKER_CLIENT_MESSAGES];
};

/* Begins to connect with MQTT 5. `certificate` NULL: without TLS. */
void broker_client_begin(struct broker_client *client, const char *id, uint16_t port,
                         const char *ca, const char *certificate, const char *key);

/* Waits until it is connected; false if the broker refuses it. */
bool broker_client_connects(struct broker_client *client);

/* Waits for the broker's answer. */
void broker_client_subscribe(struct broker_client *client, const char *topic);
void broker_client_publish(struct broker_client *client, const char *topic, const void *bytes,
                           size_t size, bool retain);

/* The number of the message from `from` on with this topic, waiting for it for some seconds; -1:
 * none came. */
int broker_client_wait(struct broker_client *client, const char *topic, size_t from,
                       double seconds);

/* Like the death of the process: no DISCONNECT is sent. */
void broker_client_end(struct broker_client *client);

#endif
