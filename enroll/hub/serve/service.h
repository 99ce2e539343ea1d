/* The parts of the running hub. Internal to enroll/hub/serve. One thread, except in fetch_worker.c.
 */
#ifndef HUB_SERVE_SERVICE_H
#define HUB_SERVE_SERVICE_H

#include <jansson.h>
#include <limits.h>
#include <systemd/sd-event.h>

#include "enroll/hub/answer/hub_outbox.h"
#include "enroll/hub/api/hub_api.h"
#include "enroll/hub/broker/hub_ca.h"
#include "enroll/hub/outlet/run/hub_outlets.h"
#include "enroll/hub/scim/hub_scim.h"
#include "enroll/hub/serve/bucket.h"
#include "enroll/hub/serve/fetch_worker.h"
#include "enroll/hub/serve/hub_serve.h"
#include "enroll/hub/serve/mail_queue.h"
#include "enroll/hub/serve/mqtt.h"
#include "enroll/web/account/guess.h"
#include "enroll/web/http/server.h"

enum { HUB_TICK_MS = 1000, HUB_API_HOST_SIZE = 256, HUB_SCIM_KNOWN = 8 };

/* What is counted since the start. */
struct hub_totals {
    uint64_t questions, events, requests, presences, refused; /* messages of doors */
    uint64_t emitted, publish_failures, takeovers;
    uint64_t joins, joins_refused, fetches, fetches_refused, renewals;
    uint64_t scim, scim_refused, scim_strangers;
    struct hub_pruned pruned;
    double longest_s;       /* the longest call of the database within the loop */
    double longest_fetch_s; /* of the threads */
};

/* Who may try a token of SCIM. */
struct hub_scim_gate {
    struct web_guess guess;
    /* Tokens that were valid, the newest first: failures of others do not hold them up. */
    uint8_t known[HUB_SCIM_KNOWN][HUB_SCIM_DIGEST_BYTES];
};

/* What the broker has to acknowledge before the leader publishes more. */
struct hub_publishing {
    bool waits;
    struct hub_outbox outbox;
    uint64_t until; /* so many acknowledged messages of hub_mqtt_counts() are all of it */
    double since_s; /* when the last of it was published */
    bool is_late;   /* it was said that the broker takes long */
    uint32_t most;  /* deltas of a zone at once */
};

struct hub_service {
    struct hub_api api; /* the first, because its handlers have it as their context */
    const struct hub_serve_options *options;
    sd_event *event;
    struct hub_store store;
    struct hub_ca *ca;
    struct hub_mqtt *mqtt;
    struct hub_fetch *fetch;

    /* HTTPS */
    int listen_fd;
    struct web_certificate certificate;
    struct web_sessions sessions;
    struct web_guess guess;
    char accounts[PATH_MAX], setup_code[PATH_MAX], api_host[HUB_API_HOST_SIZE];
    struct web_server *server;
    struct hub_bucket joins, renewals;
    struct hub_scim_gate scim;

    /* mail of doors */
    struct hub_mail_queue mail;
    size_t mail_alone; /* so many messages are answered one by one */
    size_t mail_most;  /* are answered together at most */
    sd_event_source *mail_source, *mail_retry;

    /* the leader */
    sd_event_source *tick, *notified, *publish;
    int notify_fd; /* that `notified` watches; -1: none */
    bool is_leader;
    struct hub_outlets *outlets; /* of the leader; NULL: none, or they could not be started */
    bool heads_wanted;           /* the broker may have lost what it has retained */
    struct hub_publishing publishing;
    bool database_lost;
    bool
        emit_failed; /* the last message of this call could not be sent: not the database's fault */

    /* what Home Assistant was told */
    struct hub_home_door *home;
    size_t n_home;
    int64_t homed_s;

    sd_event_source *hourly;
    int64_t followed;   /* the newest act that the broker's folder follows */
    int64_t follow_s;   /* when the folder is compared in any case */
    int64_t rollouts_s; /* when the rollouts are looked at next */
    int64_t pruned_s;   /* when old rows were deleted last */
    bool prunes;        /* a task does it now */
    int64_t mended_s;   /* when people of identity providers were linked last */
    int64_t measured_s; /* when the file of metrics was written last */
    struct hub_totals totals;
};

/* ---- mail.c ---- */
int hub__mail_start(struct hub_service *service);
void hub__mail_stop(struct hub_service *service);
/* Takes a message of the broker into the queue. */
void hub__mail_arrived(void *service, const char *topic, const void *bytes, size_t size);

/* ---- leader.c ---- */
int hub__leader_start(struct hub_service *service);
void hub__leader_stop(struct hub_service *service);
/* The connection to the broker is there, or is lost. */
void hub__broker_state(void *service, bool is_connected);
void hub__broker_acknowledged(void *service);
/* A call of the database takes notifications from the socket, which then does not become readable.
 * Called after such calls: lets the leader publish if there is one. */
void hub__look_for_notes(struct hub_service *service);
/* Publishes a message: `emit` of struct hub_emit. */
int hub__emit(void *service, const char *topic, const void *bytes, size_t size, bool retain);
/* Says once that the database is lost, and once that it is there again. */
void hub__database_state(struct hub_service *service, int error, const struct iso_fault *fault);

/* ---- https.c ---- */
int hub__https_start(struct hub_service *service, struct iso_fault *fault);
void hub__https_stop(struct hub_service *service);
/* Renews the certificates that end soon. Returns 0 or an error with a fault. */
int hub__https_renew(struct hub_service *service, struct iso_fault *fault);

/* ---- prune.c ---- */
/* The leader deletes what need not be kept, now and then. */
void hub__prune(struct hub_service *service);

/* ---- scim.c ---- */
/* Answers requests of identity providers, in the threads of the API. */
void hub__scim(void *service, struct web_exchange *exchange);
/* The leader links people whose requests were approved, now and then. */
void hub__scim_mend(struct hub_service *service);

/* ---- administration.c ---- */
/* Opens the accounts and what the API needs besides; before HTTPS starts. */
int hub__administration_open(struct hub_service *service, struct iso_fault *fault);
/* The folder of the pages; NULL: there is none, which is said once. */
const char *hub__administration_pages(const struct hub_service *service);
/* Answers all requests of the API that wait; before HTTPS stops. */
void hub__administration_end(struct hub_service *service);
/* After HTTPS has stopped. */
void hub__administration_close(struct hub_service *service);

/* ---- fleet_join.c, fleet_fetch.c: plain routes ---- */
void hub__post_join(void *service, struct web_exchange *exchange);
void hub__post_renew(void *service, struct web_exchange *exchange);
void hub__post_fetch(void *service, struct web_exchange *exchange);

/* ---- metrics.c ---- */
/* Writes the file of the metrics, if there is one. */
void hub__metrics_write(struct hub_service *service);
/* Answers GET /metrics of a program on this machine. */
void hub__get_metrics(void *service, struct web_exchange *exchange);

/* ---- home.c ---- */
/* Announces the doors to Home Assistant, and publishes their states: what has changed since the
 * last call, or everything. By the leader. */
void hub__home_publish(struct hub_service *service, bool everything);

/* Seconds of a monotonic clock, for measurements. */
double hub__clock_s(void);
/* Remembers how long a call of the database has taken that began at `begun_s`. */
void hub__measured(struct hub_service *service, const char *what, double begun_s);

#endif
