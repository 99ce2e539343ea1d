/* The running hub: one process on one event loop. Several may run with the same database, keys and
 * authority, on one machine or on several.
 *
 *   every process   takes mail of doors (a shared subscription, so the broker gives each message to
 *                   one of them), answers it, and answers HTTPS
 *   the leader      one of them, who holds a lock of the database; it publishes deltas, keys and
 *                   heads, and follows who is online. When it dies, another one becomes the leader
 *                   within about a second
 *
 * The table of deltas is the queue of what is published. A delta counts as published when the
 * broker has acknowledged it, so a leader that dies in between lets the next one publish it once
 * more; doors know each delta by its number. */
#ifndef HUB_SERVE_HUB_SERVE_H
#define HUB_SERVE_HUB_SERVE_H

#include <stdbool.h>
#include <stdint.h>

#include "core/base/fault.h"
#include "enroll/hub/answer/hub_prune.h"
#include "enroll/hub/broker/hub_pair.h"
#include "enroll/hub/store/hub_store.h"

struct hub_serve_options {
    struct hub_store_options store;
    const char *folder; /* of the authority, the certificates and the accounts */
    const char *listen; /* HTTPS: "ADDRESS:PORT" */
    const char *hosts[HUB_PAIR_HOSTS_MOST]; /* names and addresses of the HTTPS server */
    size_t n_hosts;
    uint16_t door_port;      /* where the doors reach HTTPS, by the first of its names */
    const char *pages;       /* the folder of the pages for administrators; NULL: none */
    const char *broker_host; /* where the hub reaches the broker */
    uint16_t broker_port;
    bool broker_plain;            /* without TLS, for tests alone */
    const char *door_broker_host; /* where the doors reach it; told to them when they join */
    uint16_t door_broker_port;
    const char *broker_folder;  /* acl and crl.pem there follow the doors; NULL: they do not */
    const char *metrics_file;   /* for the textfile collector of node_exporter; NULL: none */
    struct hub_prune_days keep; /* what the leader deletes, and after how long */
    bool home_assistant;        /* the doors are announced to Home Assistant */
};

/* Serves until SIGTERM or SIGINT. Tells the service manager that it is ready when the database is
 * open and HTTPS listens; it starts without the broker, too. Errors of the store, the certificates
 * and the listener. */
int hub_serve_run(const struct hub_serve_options *options, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
