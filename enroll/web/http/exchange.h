/* One request and its answer. A handler of the API receives an exchange and answers it once: at
 * once, or later, after a reply of the daemon. An exchange stays valid until it has been answered,
 * even if its client has gone away meanwhile.
 *
 * Errors are answered as application/problem+json (RFC 9457): {"type": "about:blank", "title": the
 * words of the status, "status": 403, "code": "not-allowed", "detail": a sentence for people}. A
 * code keeps its meaning in later versions; enroll/web/api/openapi.json lists all of them. */
#ifndef WEB_HTTP_EXCHANGE_H
#define WEB_HTTP_EXCHANGE_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/socket.h>
#include <sys/types.h>

#include "enroll/web/account/role.h"
#include "enroll/web/http/stream.h"

struct web_exchange;

/* The method of the request, such as "GET". */
const char *web_exchange_method(const struct web_exchange *exchange);

/* A header of the request; NULL: there is none, or the client is gone. By the event loop alone. */
const char *web_exchange_request_header(const struct web_exchange *exchange, const char *name);

/* The value of {name} in the path of the route, or the rest of the path of a plain route,
 * percent-decoded; valid UTF-8; NULL if the route has none. */
const char *web_exchange_part(const struct web_exchange *exchange);

/* The value of a parameter of the query, percent-decoded; NULL if there is none. */
const char *web_exchange_query(const struct web_exchange *exchange, const char *name);

/* The whole number that a parameter has, or `otherwise` if there is no such parameter. Returns
 * false after answering 400 "invalid-parameter" if it is no number from `least` to `most`. */
bool web_exchange_number(struct web_exchange *exchange, const char *name, int64_t least,
                         int64_t most, int64_t otherwise, int64_t *out)
    __attribute__((warn_unused_result));

/* The object in the body of a POST, PUT or PATCH. It is never NULL: a request without a body has an
 * empty object, and a body that is no JSON object has been refused before the handler is called. It
 * is valid until the answer. */
json_t *web_exchange_body(const struct web_exchange *exchange);

/* The text of a member of the body. Returns NULL after answering 400 "invalid-member" if it is
 * missing, is no text, or has no or more than `most` bytes. */
const char *web_exchange_member(struct web_exchange *exchange, const char *member, size_t most)
    __attribute__((warn_unused_result));

/* The body of a plain route: *size bytes, which are valid until the answer; NULL for an empty one.
 */
const void *web_exchange_bytes(const struct web_exchange *exchange, size_t *size);

/* The account that asks, and its role; "" and WEB_ROLE_NONE without a session. */
const char *web_exchange_account(const struct web_exchange *exchange);
enum web_role web_exchange_role(const struct web_exchange *exchange);

/* The id of its session; 0: none. */
uint64_t web_exchange_session(const struct web_exchange *exchange);

/* The address of the client. */
const struct sockaddr *web_exchange_address(const struct web_exchange *exchange);

/* Refuses a body that an intake (route.h) would have to take. The texts live as long as the
 * program.
 */
void web_exchange_refuse(struct web_exchange *exchange, unsigned status, const char *code,
                         const char *detail);

/* Answers. `json` is taken over; NULL (no memory) is answered as 500. A status of 400 and more has
 * the type application/problem+json. */
void web_exchange_json(struct web_exchange *exchange, unsigned status, json_t *json);

/* Answers with a JSON text that the handler has written itself, for long answers, which are sent as
 * gzip if the client accepts it. `text` is taken
 * over, and freed with free(); NULL (no memory) is answered as 500. */
void web_exchange_text(struct web_exchange *exchange, unsigned status, char *text, size_t size);

/* Answers with a text of another type. `text` is taken over, and freed with free(); NULL: the
 * answer has no body. */
void web_exchange_typed(struct web_exchange *exchange, unsigned status, const char *content_type,
                        char *text, size_t size);

/* Where the bytes of a long answer come from. */
struct web_source {
    uint64_t size;
    /* Copies at most `most` bytes from the place `at` on, at least one. A negative errno cuts the
     * answer off, which the client notices, because the answer has said its size. */
    ssize_t (*read)(void *context, uint64_t at, void *out, size_t most);
    void (*done)(void *context); /* the answer has been sent or given up */
    void *context;
};

/* Answers 200 with bytes of any type, which are read as the client takes them. `done` is called
 * once, also if there is no memory. */
void web_exchange_source(struct web_exchange *exchange, const char *content_type,
                         const struct web_source *source);

/* 204, without a body. */
void web_exchange_done(struct web_exchange *exchange);

/* A problem. `detail` is one sentence. */
void web_exchange_problem(struct web_exchange *exchange, unsigned status, const char *code,
                          const char *detail);

/* The object of a problem, to which the caller may add members before web_exchange_json(). NULL:
 * there is no memory. */
json_t *web_problem_json(unsigned status, const char *code, const char *detail);

/* Adds a header to the answer; called before it. At most four; a name has at most 31 bytes and a
 * value at most 191. */
void web_exchange_header(struct web_exchange *exchange, const char *name, const char *value);

/* Answers 200 with a stream. `on_closed` is called once, when the stream is closed; the stream is
 * freed after it. NULL if there is no memory; then the exchange has been answered. A stream also
 * ends with the session of its exchange. */
struct web_stream *web_exchange_stream(struct web_exchange *exchange, const char *content_type,
                                       enum web_stream_kind kind,
                                       void (*on_closed)(void *context, struct web_stream *stream),
                                       void *context);

#endif
