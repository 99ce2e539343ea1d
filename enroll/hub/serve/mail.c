/* Answers the mail of doors: what has come meanwhile together, else one message at a time. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <systemd/sd-daemon.h>

#include "enroll/hub/answer/hub_letters.h"
#include "enroll/hub/serve/service.h"
#include "enroll/hub/store/hub_door.h"
#include "enroll/web/http/now.h"

enum { RETRY_US = 1000000, TOGETHER_BYTES_MAX = 1 << 20, TOGETHER_LEAST = 8 };

#define TOGETHER_S 0.1

double hub__clock_s(void)
{
    return 1e-9 * (double)web_now_ns();
}

void hub__measured(struct hub_service *service, const char *what, double begun_s)
{
    const double took_s = hub__clock_s() - begun_s;

    if (took_s > service->totals.longest_s) {
        service->totals.longest_s = took_s;
    }
    if (took_s > 1) {
        fprintf(stderr, SD_WARNING "isotherm-hub: %s has taken %.1f s\n", what, took_s);
    }
}

static void count(struct hub_service *service, const struct hub_mail *mail)
{
    enum iso_fleet_kind kind;

    if (mail->is_presence) {
        service->totals.presences++;
    } else if (iso_fleet_kind_of(mail->bytes, mail->size, &kind) == 0) {
        service->totals.questions += kind == ISO_FLEET_QUESTION;
        service->totals.events += kind == ISO_FLEET_EVENTS;
        service->totals.requests += kind == ISO_FLEET_REQUEST;
    }
}

/* Returns the error of the database; a message that is refused is none. */
static int answer(struct hub_service *service, const struct hub_mail *mail)
{
    const struct hub_emit emit = {.emit = hub__emit, .context = service};
    const double begun_s = hub__clock_s();
    struct iso_fault fault = {.text = ""};
    char id[ISO_FLEET_ID_TEXT_SIZE];
    int r;

    service->emit_failed = false;
    if (mail->is_presence) {
        r = service->is_leader
                ? hub_door_set_online(&service->store, &mail->door,
                                      mail->size == 1 && mail->bytes[0] == '1', &fault)
                : 0;
    } else {
        r = hub_take(&service->store, &mail->door, mail->bytes, mail->size, &emit, &fault);
    }
    hub__measured(service, "the answer to a door", begun_s);
    hub__database_state(service, service->emit_failed ? 0 : r, &fault);
    switch (r) {
    case 0:
        count(service, mail);
        return 0;
    case -ENOTCONN:
    case -EAGAIN:
        return r;
    default:
        service->totals.refused++;
        fprintf(stderr, SD_NOTICE "isotherm-hub: door %s: %s\n", iso_fleet_id_text(&mail->door, id),
                fault.text);
        return 0;
    }
}

/* As many are taken together as the loop has time for: a revocation that is published meanwhile
 * waits for them. How long they take depends on the disk, so the number follows the time. */
static void follow_time(struct hub_service *service, size_t n, double took_s)
{
    const size_t most = service->mail_most;

    if (took_s > TOGETHER_S) {
        service->mail_most = most / 2 > TOGETHER_LEAST ? most / 2 : TOGETHER_LEAST;
    } else if (n == most && took_s < TOGETHER_S / 2) {
        service->mail_most = 2 * most < HUB_LETTERS_MOST ? 2 * most : HUB_LETTERS_MOST;
    }
}

/* The messages at the beginning of the queue that may be taken together. */
static size_t collect(const struct hub_service *service, struct hub_letter *out)
{
    size_t n = 0, bytes = 0;

    for (const struct hub_mail *mail = service->mail.first; mail && n < service->mail_most;
         mail = mail->next) {
        bytes += mail->size;
        if (bytes > TOGETHER_BYTES_MAX ||
            (mail->is_presence ? !service->is_leader
                               : !hub_letter_is_joint(mail->bytes, mail->size))) {
            break;
        }
        out[n++] = (struct hub_letter){.door = mail->door,
                                       .bytes = mail->is_presence ? NULL : mail->bytes,
                                       .size = mail->size,
                                       .online = mail->size == 1 && mail->bytes[0] == '1'};
    }
    return n;
}

/* Returns whether the messages at the beginning of the queue were answered together. If one of them
 * is bad, each of them is answered alone, so that it alone is refused. */
static bool answer_together(struct hub_service *service)
{
    struct hub_letter letters[HUB_LETTERS_MOST];
    const struct hub_emit emit = {.emit = hub__emit, .context = service};
    const double begun_s = hub__clock_s();
    struct iso_fault fault = {.text = ""};
    const size_t n = service->mail_alone ? 0 : collect(service, letters);

    if (n < 2) {
        service->mail_alone -= service->mail_alone > 0;
        return false;
    }
    service->emit_failed = false;
    const int r = hub_take_letters(&service->store, letters, n, &emit, &fault);
    hub__measured(service, "the answers to doors", begun_s);
    follow_time(service, n, hub__clock_s() - begun_s);
    if (r) {
        service->mail_alone = n - 1; /* the first of them is answered now */
        return false;
    }
    hub__database_state(service, 0, &fault);
    for (size_t i = 0; i < n; i++) {
        count(service, service->mail.first);
        hub_mail_drop_first(&service->mail);
    }
    return true;
}

static int on_mail(sd_event_source *source, void *context)
{
    struct hub_service *service = context;

    /* Without the broker there is nobody to answer to. */
    if (!service->mail.first || !hub_mqtt_is_connected(service->mqtt)) {
        hub_mail_clear(&service->mail);
        return sd_event_source_set_enabled(source, SD_EVENT_OFF);
    }
    if (answer_together(service)) {
        hub__look_for_notes(service);
        return 0;
    }
    if (answer(service, service->mail.first)) {
        (void)sd_event_source_set_time_relative(service->mail_retry, RETRY_US);
        (void)sd_event_source_set_enabled(service->mail_retry, SD_EVENT_ONESHOT);
        return sd_event_source_set_enabled(source, SD_EVENT_OFF);
    }
    hub_mail_drop_first(&service->mail);
    hub__look_for_notes(service);
    return 0;
}

static int on_retry(sd_event_source *source, uint64_t usec, void *context)
{
    struct hub_service *service = context;

    (void)source;
    (void)usec;
    return sd_event_source_set_enabled(service->mail_source, SD_EVENT_ON);
}

void hub__mail_arrived(void *context, const char *topic, const void *bytes, size_t size)
{
    struct hub_service *service = context;
    struct iso_fleet_id door;
    bool is_presence;

    if (size > ISO_FLEET_MESSAGE_MAX || !hub_mail_topic(topic, &door, &is_presence)) {
        service->totals.refused++;
        return;
    }
    if (hub_mail_put(&service->mail, &door, is_presence, bytes, size) &&
        sd_event_source_get_enabled(service->mail_retry, NULL) <= 0) {
        (void)sd_event_source_set_enabled(service->mail_source, SD_EVENT_ON);
    }
}

int hub__mail_start(struct hub_service *service)
{
    sd_event *event = service->event;
    int r = sd_event_add_defer(event, &service->mail_source, on_mail, service);

    service->mail_most = TOGETHER_LEAST;
    r = r < 0 ? r : sd_event_source_set_enabled(service->mail_source, SD_EVENT_OFF);
    /* New mail is taken from the socket and timers are kept before old mail is answered. */
    r = r < 0 ? r : sd_event_source_set_priority(service->mail_source, SD_EVENT_PRIORITY_IDLE);
    r = r < 0 ? r
              : sd_event_add_time_relative(event, &service->mail_retry, CLOCK_MONOTONIC, 0, 10000,
                                           on_retry, service);
    return r < 0 ? r : sd_event_source_set_enabled(service->mail_retry, SD_EVENT_OFF);
}

void hub__mail_stop(struct hub_service *service)
{
    service->mail_source = sd_event_source_disable_unref(service->mail_source);
    service->mail_retry = sd_event_source_disable_unref(service->mail_retry);
    hub_mail_clear(&service->mail);
}
