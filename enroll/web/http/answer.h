/* The bodies of answers, and the headers that every answer has. Internal to enroll/web/http. */
#ifndef WEB_HTTP_ANSWER_H
#define WEB_HTTP_ANSWER_H

#include <jansson.h>
#include <microhttpd.h>
#include <stdbool.h>

#include "enroll/web/http/exchange.h"

/* The headers of this kind of answer, added to a response. False: there is no memory. */
bool web__answer_add_headers(struct MHD_Response *response, const char *content_type,
                             const char *cache_control) __attribute__((warn_unused_result));

/* A response with a JSON text, which is taken over and freed with free(). A status of 400 and more
 * makes it a problem. NULL: there is no memory, or `text` is NULL. */
struct MHD_Response *web__answer_text(unsigned status, char *text, size_t size);

/* The same with another type. */
struct MHD_Response *web__answer_typed(const char *content_type, char *text, size_t size);

/* The same with a JSON value, which is taken over. A status of 400 and more makes it a problem.
 * NULL: there is no memory, or `json` is NULL. */
struct MHD_Response *web__answer_json(unsigned status, json_t *json);

/* A response with the bytes of a source, whose `done` is called once in any case. NULL: there is no
 * memory. */
struct MHD_Response *web__answer_source(const char *content_type, const struct web_source *source);

/* A response without a body. NULL: there is no memory. */
struct MHD_Response *web__answer_empty(void);

#endif
