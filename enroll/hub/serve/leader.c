/* The leader publishes. Whether this process is the leader is asked once a second, because the
 * lock ends with the connection to the database. */
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/epoll.h>
#include <systemd/sd-daemon.h>

#include "enroll/hub/broker/broker_config.h"
#include "enroll/hub/serve/service.h"
#include "enroll/hub/store/hub_door.h"
#include "enroll/hub/update/hub_update.h"

enum {
    DELTAS_LEAST = 4, /* of a zone at once */
    DELTAS_MOST = 200,
    LATE_S = 5,
    FOLLOW_S = 60, /* the broker's folder is compared with the doors at least so often */
    ROLLOUTS_S = 60,
};

#define SLOW_S 1.0 /* for the acknowledgement of what was published at once */

/* The broker gives each message to one process of the hub. */
static const char shared_mail[] = "$share/hub/" ISO_FLEET_TOPIC_ALL_OUT;

void hub__database_state(struct hub_service *service, int error, const struct iso_fault *fault)
{
    const bool is_lost = error == -ENOTCONN;

    if (is_lost != service->database_lost && (is_lost || error == 0)) {
        service->database_lost = is_lost;
        fprintf(stderr, SD_WARNING "isotherm-hub: database: %s\n",
                is_lost ? fault->text : "it is there again");
    }
}

int hub__emit(void *context, const char *topic, const void *bytes, size_t size, bool retain)
{
    struct hub_service *service = context;
    const int r = hub_mqtt_publish(service->mqtt, topic, bytes, size, retain);

    service->emit_failed = r < 0;
    service->totals.emitted += r == 0;
    return r;
}

static void failed(struct hub_service *service, int error, const struct iso_fault *fault)
{
    service->totals.publish_failures++;
    if (error != -ENOTCONN) {
        fprintf(stderr, SD_WARNING "isotherm-hub: cannot publish: %s\n", fault->text);
    }
}

/* What was not confirmed is emitted again. */
static void forget(struct hub_publishing *publishing)
{
    hub_outbox_free(&publishing->outbox);
    publishing->waits = false;
}

/* The broker hands a delta to every door before it acknowledges it. With many doors that takes
 * long, and another zone waits; so fewer are published at once. */
static void follow_time(struct hub_publishing *publishing, double took_s)
{
    const uint32_t most = publishing->most;

    if (took_s > SLOW_S) {
        publishing->most = most / 2 > DELTAS_LEAST ? most / 2 : DELTAS_LEAST;
    } else if (publishing->outbox.more && took_s < SLOW_S / 4) {
        publishing->most = 2 * most < DELTAS_MOST ? 2 * most : DELTAS_MOST;
    }
}

/* Deltas count as published only when the broker has acknowledged them. If it has, this stores that
 * and returns true. The loop does not wait for the broker, because doors would get no lease
 * meanwhile. While the connection lasts, nothing is sent a second time: a slow broker would get
 * more to do, and become slower. */
static bool confirm_published(struct hub_service *service)
{
    struct hub_publishing *publishing = &service->publishing;
    struct hub_mqtt_counts counts;
    struct iso_fault fault = {.text = ""};
    const double took_s = hub__clock_s() - publishing->since_s;

    hub_mqtt_counts(service->mqtt, &counts);
    if (counts.acknowledged < publishing->until) {
        if (!publishing->is_late && took_s > LATE_S) {
            publishing->is_late = true;
            fprintf(stderr,
                    SD_WARNING "isotherm-hub: the broker takes long; messages to it that wait: "
                               "%" PRIu64 "\n",
                    publishing->until - counts.acknowledged);
        }
        return false;
    }
    follow_time(publishing, took_s);
    const int r = hub_outbox_confirm(&service->store, &publishing->outbox, &fault);
    hub__database_state(service, r, &fault);
    publishing->waits = false;
    if (r) {
        forget(publishing);
        failed(service, r, &fault);
    }
    return true;
}

static int emit_all(struct hub_service *service, struct iso_fault *fault)
{
    const struct hub_emit emit = {.emit = hub__emit, .context = service};
    struct hub_publishing *publishing = &service->publishing;
    int r = 0;

    if (service->heads_wanted) {
        r = hub_outbox_heads(&service->store, &emit, fault);
        service->heads_wanted = r != 0;
    }
    return r ? r
             : hub_outbox_emit(&service->store, publishing->most, &emit, &publishing->outbox,
                               fault);
}

/* Publishes what the broker does not have. */
static void publish(struct hub_service *service)
{
    struct hub_publishing *publishing = &service->publishing;
    const double begun_s = hub__clock_s();
    struct hub_mqtt_counts counts;
    struct iso_fault fault = {.text = ""};

    if (!service->is_leader || !hub_mqtt_is_connected(service->mqtt)) {
        forget(publishing);
        return;
    }
    if (publishing->waits && !confirm_published(service)) {
        return;
    }
    service->emit_failed = false;
    const int r = emit_all(service, &fault);
    hub__measured(service, "publishing", begun_s);
    hub__database_state(service, service->emit_failed ? 0 : r, &fault);
    if (r) {
        forget(publishing);
        failed(service, r, &fault);
    } else if (publishing->outbox.n > 0) {
        hub_mqtt_counts(service->mqtt, &counts);
        publishing->waits = true;
        publishing->is_late = false;
        publishing->until = counts.published;
        publishing->since_s = hub__clock_s();
    }
}

/* No message may be published from here: the library is on the stack. */
void hub__broker_acknowledged(void *context)
{
    struct hub_service *service = context;
    struct hub_mqtt_counts counts;

    hub_mqtt_counts(service->mqtt, &counts);
    if (service->publishing.waits && counts.acknowledged >= service->publishing.until) {
        (void)sd_event_source_set_enabled(service->publish, SD_EVENT_ONESHOT);
    }
}

static int on_publish(sd_event_source *source, void *context)
{
    (void)source;
    publish(context);
    hub__look_for_notes(context);
    return 0;
}

/* ---- notifications of the database ---- */

void hub__look_for_notes(struct hub_service *service)
{
    bool changed = false;

    if (service->notified && hub_listen_take(&service->store, &changed, NULL) == 0 && changed) {
        (void)sd_event_source_set_enabled(service->publish, SD_EVENT_ONESHOT);
    }
}

static int on_notified(sd_event_source *source, int fd, uint32_t events, void *context)
{
    struct hub_service *service = context;
    struct iso_fault fault = {.text = ""};
    bool changed = false;
    const int r = hub_listen_take(&service->store, &changed, &fault);

    (void)source;
    (void)fd;
    (void)events;
    hub__database_state(service, r, &fault);
    if (r) {
        /* The socket stays readable; the next tick connects anew. */
        service->notified = sd_event_source_disable_unref(service->notified);
        service->notify_fd = -1;
    } else if (changed) {
        publish(service);
        hub__look_for_notes(service);
    }
    return 0;
}

static int listen_to_database(struct hub_service *service, struct iso_fault *fault)
{
    int fd = -1;
    int r = hub_listen(&service->store, &fd, fault);

    if (r == 0 && fd != service->notify_fd) {
        service->notified = sd_event_source_disable_unref(service->notified);
        service->notify_fd = -1;
        r = sd_event_add_io(service->event, &service->notified, fd, EPOLLIN, on_notified, service);
        service->notify_fd = r < 0 ? -1 : fd;
    }
    return r < 0 ? r : 0;
}

/* ---- the broker ---- */

static void subscribe_as_leader(struct hub_service *service)
{
    struct iso_fault fault = {.text = ""};
    /* The broker tells the retained states of all doors after the subscription. */
    const int r = hub_door_all_offline(&service->store, &fault);

    hub__database_state(service, r, &fault);
    (void)!hub_mqtt_unsubscribe(service->mqtt, ISO_FLEET_TOPIC_ALL_ONLINE);
    (void)!hub_mqtt_subscribe(service->mqtt, ISO_FLEET_TOPIC_ALL_ONLINE);
    service->heads_wanted = true;
    hub__home_publish(service, true);
}

void hub__broker_state(void *context, bool is_connected)
{
    struct hub_service *service = context;

    forget(&service->publishing);
    if (!is_connected) {
        return;
    }
    fprintf(stderr, SD_INFO "isotherm-hub: connected to the broker %s:%u\n",
            service->options->broker_host, service->options->broker_port);
    if (hub_mqtt_subscribe(service->mqtt, shared_mail)) {
        fprintf(stderr, SD_ERR "isotherm-hub: cannot subscribe to the mail of doors\n");
    }
    if (service->is_leader) {
        subscribe_as_leader(service);
        (void)sd_event_source_set_enabled(service->publish, SD_EVENT_ONESHOT);
    }
}

/* ---- once a second ---- */

/* The outlets of the leader. What could not be started is tried again with the next tick. */
static void start_outlets(struct hub_service *service)
{
    struct iso_fault fault = {.text = ""};

    if (service->is_leader && !service->outlets &&
        hub_outlets_new(service->event, &service->store, &service->options->store,
                        &service->outlets, &fault)) {
        fprintf(stderr, SD_ERR "isotherm-hub: %s\n", fault.text);
    }
}

static void end_outlets(struct hub_service *service)
{
    hub_outlets_free(service->outlets);
    service->outlets = NULL;
}

static void become(struct hub_service *service, bool is_leader)
{
    if (is_leader == service->is_leader) {
        return;
    }
    service->is_leader = is_leader;
    fprintf(stderr, SD_NOTICE "isotherm-hub: this process is %s\n",
            is_leader ? "the leader now" : "not the leader any more");
    if (is_leader) {
        service->totals.takeovers++;
        if (hub_mqtt_is_connected(service->mqtt)) {
            subscribe_as_leader(service);
        }
    } else {
        end_outlets(service);
        (void)!hub_mqtt_unsubscribe(service->mqtt, ISO_FLEET_TOPIC_ALL_ONLINE);
    }
}

/* Rights and list follow the doors when a door has changed, and now and then in any case. */
static void follow_broker(struct hub_service *service)
{
    const struct hub_serve_options *options = service->options;
    const int64_t now_s = (int64_t)hub__clock_s();
    struct iso_fault fault = {.text = ""};
    bool changed = false;

    if (!options->broker_folder) {
        return;
    }
    int r = broker_config_look(&service->store, &service->followed, &changed, &fault);
    if (r || (!changed && now_s < service->follow_s)) {
        return;
    }
    r = broker_config_follow(&service->store, service->ca, options->broker_folder, &changed,
                             &fault);
    service->follow_s = now_s + (r ? 0 : FOLLOW_S);
    if (r) {
        fprintf(stderr, SD_WARNING "isotherm-hub: %s\n", fault.text);
    } else if (changed) {
        fprintf(stderr, SD_INFO "isotherm-hub: %s follows the doors\n", options->broker_folder);
    }
}

/* Silence of doors says nothing while the broker is away. */
static void look_at_rollouts(struct hub_service *service)
{
    const double begun_s = hub__clock_s();
    struct iso_fault fault = {.text = ""};

    if (!service->is_leader || !hub_mqtt_is_connected(service->mqtt) ||
        (int64_t)begun_s < service->rollouts_s) {
        return;
    }
    service->rollouts_s = (int64_t)begun_s + ROLLOUTS_S;
    const int r = hub_rollouts_look(&service->store, &fault);
    hub__measured(service, "the look at rollouts", begun_s);
    hub__database_state(service, r, &fault);
    if (r && r != -ENOTCONN) {
        fprintf(stderr, SD_WARNING "isotherm-hub: rollouts: %s\n", fault.text);
    }
}

static int on_tick(sd_event_source *source, uint64_t usec, void *context)
{
    struct hub_service *service = context;
    const double begun_s = hub__clock_s();
    struct iso_fault fault = {.text = ""};
    bool is_leader = false;
    int r = hub_leader_try(&service->store, &is_leader, &fault);

    (void)usec;
    r = r ? r : listen_to_database(service, &fault);
    hub__measured(service, "the question who leads", begun_s);
    hub__database_state(service, r, &fault);
    become(service, r == 0 && is_leader);
    start_outlets(service);
    publish(service);
    follow_broker(service);
    look_at_rollouts(service);
    hub__look_for_notes(service);
    hub__home_publish(service, false);
    hub__scim_mend(service);
    hub__prune(service);
    hub__metrics_write(service);
    return sd_event_source_set_time_relative(source, HUB_TICK_MS * 1000ULL);
}

int hub__leader_start(struct hub_service *service)
{
    sd_event *event = service->event;
    int r = sd_event_add_defer(event, &service->publish, on_publish, service);

    service->notify_fd = -1;
    service->publishing.most = DELTAS_LEAST;
    r = r < 0 ? r : sd_event_source_set_enabled(service->publish, SD_EVENT_OFF);
    r = r < 0 ? r
              : sd_event_add_time_relative(event, &service->tick, CLOCK_MONOTONIC, 0, 10000,
                                           on_tick, service);
    return r < 0 ? r : sd_event_source_set_enabled(service->tick, SD_EVENT_ON);
}

void hub__leader_stop(struct hub_service *service)
{
    service->tick = sd_event_source_disable_unref(service->tick);
    service->publish = sd_event_source_disable_unref(service->publish);
    service->notified = sd_event_source_disable_unref(service->notified);
    if (service->is_leader) {
        end_outlets(service);
        (void)!hub_leader_leave(&service->store, NULL);
    }
    forget(&service->publishing);
    free(service->home);
}
