/* The enrolment of a person, for the session that begins it.
 *
 *   idle      -> consent    web_enrolment_begin: the consent is put on record
 *   consent   -> act        it is on record; what is done is put on record
 *   act       -> claim      it is on record; the camera is claimed
 *   claim     -> watch      claimed; the stream of the relief is opened
 *   watch     -> start      opened; the enrolment is started
 *   start     -> running    the daemon has started it: on_begun without an error
 *   running   -> release    it has ended: by a result of the daemon, by web_enrolment_end
 *                           ("stopped"), because nobody watches it or the session has ended
 *                           ("left"), or because the daemon is gone ("no-daemon")
 *   claim, watch, start
 *             -> release    the daemon refused it
 *   consent, act, claim
 *             -> idle       the daemon refused it, and nothing is claimed: on_begun with the error
 *   release   -> idle       the camera is given back, or the daemon has taken it back; after a
 *                           refusal on_begun with the error. Otherwise Release is tried again each
 *                           second
 *
 * So nobody is enrolled without a consent on record, and the door is watched again after every end.
 * "Nobody watches" means that the session has had neither a stream of events nor one of the relief
 * for a time. One thread. */
#ifndef WEB_DAEMON_ENROLMENT_H
#define WEB_DAEMON_ENROLMENT_H

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>
#include <systemd/sd-event.h>

#include "enroll/web/account/account.h"
#include "enroll/web/daemon/daemon.h"
#include "enroll/web/daemon/feed.h"
#include "enroll/web/session/session.h"
#include "firmware/contract/person_name.h"

struct web_enrolment;

enum { WEB_ENROLMENT_LEFT_MS = 10000 };

struct web_enrolment_setup {
    sd_event *event;
    /* All have to live longer. */
    struct web_daemon *daemon;
    struct web_feed *feed;
    const struct web_sessions *sessions;
    unsigned left_ms; /* how long it goes on without a stream; 0: WEB_ENROLMENT_LEFT_MS */
};

struct web_enrolment_request {
    char person[ISO_PERSON_NAME_SIZE];
    char account[WEB_ACCOUNT_NAME_SIZE];
    uint64_t session;
    bool poses, allow_duplicate;
    bool names_from, names_until; /* a limit that is not named stays as it is stored */
    int64_t valid_from_s, valid_until_s;
};

/* -ENOMEM, or an errno of sd-event. */
int web_enrolment_new(const struct web_enrolment_setup *setup, struct web_enrolment **out)
    __attribute__((warn_unused_result));

/* Frees it, before the connection to the daemon is freed; the daemon takes the camera back when the
 * connection ends. All its streams have to be closed before, and no callback may be owed. NULL is
 * accepted. */
void web_enrolment_free(struct web_enrolment *enrolment);

/* Whether an enrolment goes on, or one has ended whose result is known. */
bool web_enrolment_is_known(const struct web_enrolment *enrolment);

/* Whether an enrolment is not idle. */
bool web_enrolment_is_busy(const struct web_enrolment *enrolment);

/* Begins an enrolment; it has to be idle. The consent of the person and the name have been checked.
 * on_begun is called once; with NULL it runs. */
void web_enrolment_begin(struct web_enrolment *enrolment,
                         const struct web_enrolment_request *request,
                         void (*on_begun)(void *context, const sd_bus_error *error), void *context);

/* Ends the enrolment of a session. on_ended is called once, when the camera has been given back.
 * Returns false, and calls nothing, if no enrolment of this session goes on. */
bool web_enrolment_end(struct web_enrolment *enrolment, uint64_t session,
                       void (*on_ended)(void *context), void *context);

/* The object Enrolment of openapi.json, of the enrolment that goes on or the last one; with `own`
 * if `session` is not 0. The caller releases it. NULL: there is no memory. */
json_t *web_enrolment_json(const struct web_enrolment *enrolment, uint64_t session);

/* Whether an enrolment of this session runs. */
bool web_enrolment_is_of(const struct web_enrolment *enrolment, uint64_t session);

/* Answers with a stream of the relief, for the session whose enrolment runs. */
void web_enrolment_open_relief(struct web_enrolment *enrolment, struct web_exchange *exchange);

#endif
