#include "enroll/web/http/answer.h"

#include <stdlib.h>
#include <string.h>

#include "enroll/web/http/exchange.h"

enum { WEB_SOURCE_BLOCK_BYTES = 64 << 10 };

static const struct {
    const char *name, *value;
} common[] = {
    {"Content-Security-Policy",
     "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
     "connect-src 'self'; font-src 'self'; manifest-src 'self'; base-uri 'none'; "
     "form-action 'none'; frame-ancestors 'none'"},
    {"X-Content-Type-Options", "nosniff"},
    {"Referrer-Policy", "no-referrer"},
    {"Cross-Origin-Opener-Policy", "same-origin"},
    {"Cross-Origin-Resource-Policy", "same-origin"},
    {"Strict-Transport-Security", "max-age=31536000"},
};

bool web__answer_add_headers(struct MHD_Response *response, const char *content_type,
                             const char *cache_control)
{
    bool ok = MHD_add_response_header(response, "Cache-Control", cache_control) == MHD_YES;

    for (size_t i = 0; ok && i < sizeof common / sizeof *common; i++) {
        ok = MHD_add_response_header(response, common[i].name, common[i].value) == MHD_YES;
    }
    if (ok && content_type) {
        ok = MHD_add_response_header(response, "Content-Type", content_type) == MHD_YES;
    }
    return ok;
}

/* The response with its headers, or NULL. */
static struct MHD_Response *complete(struct MHD_Response *response, const char *content_type)
{
    if (response && !web__answer_add_headers(response, content_type, "no-store")) {
        MHD_destroy_response(response);
        return NULL;
    }
    return response;
}

struct MHD_Response *web__answer_typed(const char *content_type, char *text, size_t size)
{
    struct MHD_Response *response;

    if (!text) {
        return NULL;
    }
    response = MHD_create_response_from_buffer(size, text, MHD_RESPMEM_MUST_FREE);
    if (!response) {
        free(text);
    }
    return complete(response, content_type);
}

struct MHD_Response *web__answer_text(unsigned status, char *text, size_t size)
{
    return web__answer_typed(status >= 400 ? "application/problem+json" : "application/json", text,
                             size);
}

struct MHD_Response *web__answer_json(unsigned status, json_t *json)
{
    char *text = json ? json_dumps(json, JSON_COMPACT) : NULL;

    json_decref(json);
    return web__answer_text(status, text, text ? strlen(text) : 0);
}

static ssize_t read_source(void *context, uint64_t at, char *out, size_t most)
{
    const struct web_source *source = context;

    if (at >= source->size) {
        return MHD_CONTENT_READER_END_OF_STREAM;
    }
    const ssize_t n = source->read(source->context, at, out, most);
    return n > 0 ? n : MHD_CONTENT_READER_END_WITH_ERROR;
}

static void end_source(void *context)
{
    struct web_source *source = context;

    source->done(source->context);
    free(source);
}

struct MHD_Response *web__answer_source(const char *content_type, const struct web_source *source)
{
    struct web_source *copy = malloc(sizeof *copy);
    struct MHD_Response *response = NULL;

    if (copy) {
        *copy = *source;
        response = MHD_create_response_from_callback(source->size, WEB_SOURCE_BLOCK_BYTES,
                                                     read_source, copy, end_source);
    }
    if (!response) {
        source->done(source->context);
        free(copy);
        return NULL;
    }
    return complete(response, content_type);
}

struct MHD_Response *web__answer_empty(void)
{
    return complete(MHD_create_response_from_buffer(0, NULL, MHD_RESPMEM_PERSISTENT), NULL);
}

json_t *web_problem_json(unsigned status, const char *code, const char *detail)
{
    return json_pack("{s:s, s:s, s:i, s:s, s:s}", "type", "about:blank", "title",
                     MHD_get_reason_phrase_for(status), "status", (int)status, "code", code,
                     "detail", detail);
}
