/* The handlers of the API, and what they share. enroll/web/api/openapi.json describes each of them;
 * a test compares the document with the table of routes. */
#ifndef WEB_API_API_H
#define WEB_API_API_H

#include "enroll/web/daemon/daemon.h"
#include "enroll/web/login/login.h"

struct web_feed;      /* enroll/web/daemon/feed.h: what the daemon reports, for the streams */
struct web_enrolment; /* enroll/web/daemon/enrolment.h: the enrolment that goes on */
struct web_last_seen; /* enroll/web/daemon/last_seen.h: when each person was let in last */
struct web_update;    /* enroll/web/update/update.h: updates of the image */

/* The context of all handlers. */
struct web_api {
    struct web_login login; /* the first, because its handlers have it as their context */
    const char *document;   /* the text of openapi.json */
    const struct web_certificate *certificate;
    struct web_daemon *daemon;
    struct web_feed *feed;
    struct web_enrolment *enrolment;
    struct web_last_seen *last_seen;
    struct web_update *update;
};

/* Lets the daemon put on record what the accounts do. */
void web_api_record_by_daemon(struct web_api *api);

/* All routes; ends with a method of NULL. */
extern const struct web_route web_api_routes[];

/* ---- the description (api_document.c) ---- */
void web_api_get_document(void *api, struct web_exchange *exchange);

/* ---- the door (api_door.c) ---- */
void web_api_get_status(void *api, struct web_exchange *exchange);
void web_api_get_health(void *api, struct web_exchange *exchange);
void web_api_set_lockdown(void *api, struct web_exchange *exchange);
void web_api_clear_lockout(void *api, struct web_exchange *exchange);

/* ---- settings (api_settings.c) ---- */
void web_api_get_settings(void *api, struct web_exchange *exchange);
void web_api_set_setting(void *api, struct web_exchange *exchange);
void web_api_reset_setting(void *api, struct web_exchange *exchange);

/* ---- streams (api_streams.c) ---- */
void web_api_get_events(void *api, struct web_exchange *exchange);
void web_api_get_outline(void *api, struct web_exchange *exchange);
void web_api_get_relief(void *api, struct web_exchange *exchange);

/* ---- people (api_people.c) ---- */
void web_api_list_people(void *api, struct web_exchange *exchange);
void web_api_change_person(void *api, struct web_exchange *exchange);
void web_api_remove_person(void *api, struct web_exchange *exchange);

/* ---- cards and the policy (access/api_credential.c, access/api_policy.c) ---- */
void web_api_get_credential(void *api, struct web_exchange *exchange);
void web_api_change_credential(void *api, struct web_exchange *exchange);
void web_api_get_policy(void *api, struct web_exchange *exchange);
void web_api_set_policy(void *api, struct web_exchange *exchange);
void web_api_get_findings(void *api, struct web_exchange *exchange);
void web_api_test_access(void *api, struct web_exchange *exchange);

/* ---- enrolment (api_enrolment.c) ---- */
void web_api_get_enrolment(void *api, struct web_exchange *exchange);
void web_api_begin_enrolment(void *api, struct web_exchange *exchange);
void web_api_end_enrolment(void *api, struct web_exchange *exchange);

/* ---- the log (api_log.c) ---- */
void web_api_read_log(void *api, struct web_exchange *exchange);
void web_api_verify_log(void *api, struct web_exchange *exchange);

/* ---- updates (api_update.c) ---- */
void web_api_get_update(void *api, struct web_exchange *exchange);
void web_api_take_update(void *api, struct web_exchange *exchange);
void web_api_restart(void *api, struct web_exchange *exchange);

/* Who takes bodies that are no JSON; ends with a path of NULL. */
extern const struct web_intake web_api_intakes[];

/* ---- for all handlers (api_fault.c, goes_on.c) ---- */

/* Answers an error of the daemon as a problem: 409 "camera-in-use", 404 "no-such-person", 503
 * "no-daemon", and so on by one table of the names in firmware/contract/contract.h. */
void web_api_daemon_problem(struct web_exchange *exchange, const sd_bus_error *error);

/* Whether the session of the exchange goes on. Returns false after answering 401 "login-required".
 * Asked after the daemon has put an act on record and before the act is done: meanwhile the account
 * may have been removed, or have got another role. */
bool web_api_goes_on(const struct web_api *api, struct web_exchange *exchange);

#endif
