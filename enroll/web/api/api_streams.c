/* The streams: events, the outline, and the relief of an enrolment. */
#include "enroll/web/api/api.h"
#include "enroll/web/daemon/enrolment.h"
#include "enroll/web/daemon/feed.h"

void web_api_get_events(void *context, struct web_exchange *exchange)
{
    const struct web_api *api = context;
    const enum web_role role = web_exchange_role(exchange);
    struct web_stream *stream = web_feed_open_events(api->feed, exchange);
    /* Who opens the page during an enrolment sees at once how far it is. */
    if (stream && role >= WEB_ROLE_ENROLLER && web_enrolment_is_known(api->enrolment)) {
        web_feed_send_one(stream, "enrolment", web_enrolment_json(api->enrolment, 0));
    }
}

void web_api_get_outline(void *context, struct web_exchange *exchange)
{
    const struct web_api *api = context;
    if (web_daemon_is_there(api->daemon)) {
        web_feed_open_outline(api->feed, exchange);
    } else {
        web_api_daemon_problem(exchange, &web_daemon_is_gone);
    }
}

void web_api_get_relief(void *context, struct web_exchange *exchange)
{
    const struct web_api *api = context;
    if (!web_daemon_is_there(api->daemon)) {
        web_api_daemon_problem(exchange, &web_daemon_is_gone);
    } else if (!web_enrolment_is_of(api->enrolment, web_exchange_session(exchange))) {
        web_exchange_problem(exchange, 409, "no-enrolment", "This session enrols nobody.");
    } else {
        web_enrolment_open_relief(api->enrolment, exchange);
    }
}
