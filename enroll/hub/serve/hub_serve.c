#include "enroll/hub/serve/hub_serve.h"

#include <errno.h>
#include <limits.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <systemd/sd-daemon.h>
#include <unistd.h>

#include "drivers/process/service_loop.h"
#include "enroll/hub/serve/service.h"

/* A database that hangs must not hold the hub for ever, and the lock of a leader whose machine is
 * gone has to end soon. The administrator's own PGOPTIONS come first. */
static const char database_limits[] =
    "-c statement_timeout=20000 -c lock_timeout=5000 -c idle_in_transaction_session_timeout=20000 "
    "-c tcp_keepalives_idle=3 -c tcp_keepalives_interval=1 -c tcp_keepalives_count=3 "
    "-c tcp_user_timeout=6000";

static int open_loop(struct hub_service *service, struct iso_fault *fault)
{
    const int r = iso_service_loop_open(&service->event);

    return r < 0 ? iso_fault_set(fault, r, "the event loop: %s", strerror(-r)) : 0;
}

static int open_broker(struct hub_service *service, struct iso_fault *fault)
{
    const struct hub_serve_options *options = service->options;
    char ca[PATH_MAX], certificate[PATH_MAX], key[PATH_MAX], id[64];
    uint8_t random[8];
    struct hub_mqtt_setup setup = {.event = service->event,
                                   .id = id,
                                   .host = options->broker_host,
                                   .port = options->broker_port,
                                   .on_state = hub__broker_state,
                                   .on_message = hub__mail_arrived,
                                   .on_acknowledged = hub__broker_acknowledged,
                                   .context = service};

    randombytes_buf(random, sizeof random);
    (void)strcpy(id, "hub-");
    (void)sodium_bin2hex(id + 4, sizeof id - 4, random, sizeof random);
    if (snprintf(ca, sizeof ca, "%s/ca.pem", options->folder) >= (int)sizeof ca ||
        snprintf(certificate, sizeof certificate, "%s/%s", options->folder,
                 hub_pair_chain_name(HUB_PAIR_CLIENT)) >= (int)sizeof certificate ||
        snprintf(key, sizeof key, "%s/%s", options->folder, hub_pair_key_name(HUB_PAIR_CLIENT)) >=
            (int)sizeof key) {
        return iso_fault_set(fault, -ENAMETOOLONG, "%.64s...: the path is too long",
                             options->folder);
    }
    if (!options->broker_plain) {
        setup.ca = ca;
        setup.certificate = certificate;
        setup.key = key;
    }
    return hub_mqtt_new(&setup, &service->mqtt, fault);
}

static int start(struct hub_service *service, struct iso_fault *fault)
{
    int r = hub__mail_start(service);

    r = r < 0 ? r : hub__leader_start(service);
    return r < 0 ? iso_fault_set(fault, r, "the event loop: %s", strerror(-r)) : 0;
}

static int open_all(struct hub_service *service, struct iso_fault *fault)
{
    const struct hub_serve_options *options = service->options;
    int r = iso_fleet_start(fault);

    (void)setenv("PGOPTIONS", database_limits, 0);
    (void)setenv("PGCONNECT_TIMEOUT", "5", 0);
    r = r < 0 ? r : open_loop(service, fault);
    r = r < 0 ? r : hub_store_open(&options->store, &service->store, fault);
    r = r < 0 ? r : hub_ca_open(options->folder, &service->ca, fault);
    r = r < 0 ? r : hub_fetch_new(service->event, &options->store, &service->fetch, fault);
    r = r < 0 ? r : hub__administration_open(service, fault);
    r = r < 0 ? r : hub__https_start(service, fault);
    r = r < 0 ? r : open_broker(service, fault);
    return r < 0 ? r : start(service, fault);
}

/* Fetches end before the server that answers them, and the mail before the broker. */
static void close_all(struct hub_service *service)
{
    hub__leader_stop(service);
    hub__mail_stop(service);
    hub_fetch_free(service->fetch);
    hub__administration_end(service);
    hub__https_stop(service);
    hub__administration_close(service);
    hub_mqtt_free(service->mqtt);
    hub_ca_free(service->ca);
    hub_store_close(&service->store);
    sd_event_unref(service->event);
}

int hub_serve_run(const struct hub_serve_options *options, struct iso_fault *fault)
{
    struct hub_service *service = calloc(1, sizeof *service);

    if (!service) {
        return iso_fault_set(fault, -ENOMEM, "out of memory");
    }
    service->options = options;
    service->listen_fd = -1;
    int r = open_all(service, fault);
    if (r == 0) {
        (void)sd_notify(0, "READY=1");
        r = sd_event_loop(service->event);
        (void)sd_notify(0, "STOPPING=1");
        r = r < 0 ? iso_fault_set(fault, r, "the event loop: %s", strerror(-r)) : 0;
    }
    close_all(service);
    sodium_memzero(service, sizeof *service);
    free(service);
    return r;
}
