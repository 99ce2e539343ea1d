/* What is checked before the body of a request is read. */
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "enroll/web/http/inner.h"
#include "enroll/web/http/now.h"
#include "enroll/web/session/origin.h"

static const char api[] = "/api/v1";

static const char *header(const struct web_exchange *exchange, const char *name)
{
    return MHD_lookup_connection_value(exchange->connection, MHD_HEADER_KIND, name);
}

/* Compares the path of a request with that of a route. `*part` is what stands for "{name}", of
 * `*length` bytes. */
static bool is_path_of(const struct web_route *route, char *path, char **part, size_t *length)
{
    const char *brace = strchr(route->path, '{');

    *part = NULL;
    *length = 0;
    if (!brace) {
        return strcmp(route->path, path) == 0;
    }
    const size_t n = (size_t)(brace - route->path);
    if (strncmp(route->path, path, n) != 0) {
        return false;
    }
    *part = path + n;
    *length = strcspn(*part, "/");
    return *length > 0 && strcmp(*part + *length, strchr(brace, '}') + 1) == 0;
}

/* Adds a method to a list such as "GET, PUT". */
static void add_method(char allow[40], const char *method)
{
    const size_t n = strlen(allow);

    (void)snprintf(allow + n, 40 - n, "%s%s", n > 0 ? ", " : "", method);
}

static void find_route(struct web_exchange *exchange, char *path, const char *method)
{
    char allow[40] = "";
    char *part;
    size_t length;

    for (const struct web_route *route = exchange->server->setup.routes; route->method; route++) {
        if (!is_path_of(route, path, &part, &length)) {
            continue;
        }
        if (strcmp(route->method, method) == 0) {
            exchange->route = route;
            if (part) {
                part[length] = '\0'; /* the end of the path is known to be that of the route */
            }
            exchange->part = part;
            return;
        }
        add_method(allow, route->method);
    }
    if (!*allow) {
        web_exchange_refuse(exchange, 404, "no-such-path", "there is nothing at this path");
        return;
    }
    web_exchange_refuse(exchange, 405, "no-such-method", "this path has no such method");
    strcpy(exchange->refusal.allow, allow);
}

static void check_origin(struct web_exchange *exchange, const char *method)
{
    const struct web_origin origin = {
        .host = header(exchange, "Host"),
        .origin = header(exchange, "Origin"),
        .sec_fetch_site = header(exchange, "Sec-Fetch-Site"),
    };
    const bool ok = strcmp(method, "GET") == 0 ? web_origin_may_read(&origin)
                                               : web_origin_may_change(&origin);

    if (!ok) {
        web_exchange_refuse(exchange, 403, "other-origin",
                            "the request does not come from this server's pages");
    }
}

static void find_session(struct web_exchange *exchange)
{
    const char *cookie = header(exchange, "Cookie");
    char token[WEB_SESSION_TOKEN_SIZE];
    const struct web_session *session = NULL;

    if (cookie && web_session_cookie_token(cookie, token)) {
        session = web_session_use(exchange->server->setup.sessions, token, web_now_ns());
    }
    if (session) {
        exchange->session = session->id;
        exchange->role = session->role;
        strcpy(exchange->account, session->account);
    }
}

/* How many other requests of the account have not been answered completely. */
static int requests_of_account(const struct web_exchange *exchange)
{
    int n = 0;

    for (const struct web_exchange *e = exchange->server->exchanges; e; e = e->next) {
        n += e != exchange && !e->stream && strcmp(e->account, exchange->account) == 0;
    }
    return n;
}

static void check_role(struct web_exchange *exchange)
{
    find_session(exchange);
    if (exchange->role >= exchange->route->least) {
        if (exchange->session != 0 && requests_of_account(exchange) >= WEB_REQUESTS_OF_ACCOUNT) {
            web_exchange_refuse(exchange, 503, "busy",
                                "this account makes too many requests at one time");
        }
        return;
    }
    if (exchange->session == 0) {
        web_exchange_refuse(exchange, 401, "login-required", "log in first");
    } else {
        web_exchange_refuse(exchange, 403, "not-allowed", "this account may not do this");
    }
}

/* Whether a header Content-Type names a type, with or without parameters. */
static bool is_type(const char *header_text, const char *type)
{
    const size_t n = strlen(type);

    return header_text && strncasecmp(header_text, type, n) == 0 && strchr("; \t", header_text[n]);
}

static const struct web_intake *find_intake(const struct web_exchange *exchange, const char *method)
{
    const struct web_intake *intake = exchange->server->setup.intakes;

    while (intake && intake->path && strcmp(intake->path, exchange->route->path) != 0) {
        intake++;
    }
    return intake && intake->path && strcmp(method, "POST") == 0 ? intake : NULL;
}

static void check_body(struct web_exchange *exchange, const char *method)
{
    const struct web_intake *intake = find_intake(exchange, method);
    const char *length = header(exchange, "Content-Length");
    const bool has_body = header(exchange, "Transfer-Encoding") ||
                          (length && strspn(length, "0") != strlen(length));

    if (intake && !is_type(header(exchange, "Content-Type"), intake->type)) {
        web_exchange_refuse(exchange, 415, "other-type", "the body has to be of another type");
    } else if (intake && (!length || !has_body || header(exchange, "Transfer-Encoding"))) {
        web_exchange_refuse(exchange, 411, "no-length",
                            "the request has to say how long its body is");
    } else if (intake) {
        exchange->intake = intake;
    } else if (has_body && !is_type(header(exchange, "Content-Type"), "application/json")) {
        web_exchange_refuse(exchange, 415, "no-json",
                            "the body has to be of the type application/json");
    }
}

static void check_api(struct web_exchange *exchange, char *path, char *query, const char *method)
{
    find_route(exchange, path, method);
    if (exchange->refusal.status) {
        return;
    }
    if (exchange->part && !web_percent_decode((char *)(uintptr_t)exchange->part, false)) {
        web_exchange_refuse(exchange, 404, "no-such-path", "the path is not percent-encoded UTF-8");
        return;
    }
    check_origin(exchange, method);
    if (!exchange->refusal.status) {
        check_role(exchange);
    }
    if (!exchange->refusal.status) {
        check_body(exchange, method);
    }
    if (!exchange->refusal.status && query && !web_query_read(query, &exchange->query)) {
        web_exchange_refuse(exchange, 400, "invalid-parameter",
                            "the query of the path cannot be read");
    }
}

static bool is_plain_path(const char *route, const char *path)
{
    const size_t n = strlen(route);

    return route[n - 1] == '/' ? strncmp(route, path, n) == 0 && path[n] != '\0'
                               : strcmp(route, path) == 0;
}

/* Whether a list such as "GET, PUT" has a method. */
static bool has_method(const char *list, const char *method)
{
    const size_t n = strlen(method);

    while (n > 0 && *list) {
        const size_t length = strcspn(list, ",");
        if (length == n && strncmp(list, method, n) == 0) {
            return true;
        }
        list += length;
        list += strspn(list, ", ");
    }
    return false;
}

static const struct web_plain_route *find_plain(const struct web_exchange *exchange,
                                                const char *path)
{
    const struct web_plain_route *route = exchange->server->setup.plain;

    while (route && route->path && !is_plain_path(route->path, path)) {
        route++;
    }
    return route && route->path ? route : NULL;
}

static void check_plain(struct web_exchange *exchange, const struct web_plain_route *route,
                        char *path, char *query, const char *method)
{
    const char *methods = route->methods ? route->methods : "POST";
    const size_t n = strlen(route->path);

    if (!has_method(methods, method)) {
        web_exchange_refuse(exchange, 405, "no-such-method", "this path has no such method");
        (void)snprintf(exchange->refusal.allow, sizeof exchange->refusal.allow, "%s", methods);
        return;
    }
    if (route->path[n - 1] == '/') {
        exchange->part = path + n;
        if (!web_percent_decode(path + n, false)) {
            web_exchange_refuse(exchange, 404, "no-such-path",
                                "the path is not percent-encoded UTF-8");
        }
    }
    if (!exchange->refusal.status && query && !web_query_read(query, &exchange->query)) {
        web_exchange_refuse(exchange, 400, "invalid-parameter",
                            "the query of the path cannot be read");
    }
    /* Nothing depends on a cookie, so it does not matter which page has made a browser ask. */
    if (!exchange->refusal.status && route->type &&
        !is_type(header(exchange, "Content-Type"), route->type)) {
        web_exchange_refuse(exchange, 415, "other-type", "the body has to be of another type");
    }
    exchange->plain = route;
}

static void check_file(struct web_exchange *exchange, char *path, const char *method)
{
    if (web_percent_decode(path, false)) {
        exchange->file = web__files_find(&exchange->server->files, path);
    }
    if (!exchange->file) {
        web_exchange_refuse(exchange, 404, "no-such-path", "there is no such file");
    } else if (strcmp(method, "GET") != 0 && strcmp(method, "HEAD") != 0) {
        web_exchange_refuse(exchange, 405, "no-such-method", "files can only be read");
        strcpy(exchange->refusal.allow, "GET, HEAD");
    }
}

void web__request_check(struct web_exchange *exchange, const char *method)
{
    const char *host = header(exchange, "Host");
    char *query = exchange->uri;
    char *path = strsep(&query, "?");
    const struct web_plain_route *plain = find_plain(exchange, path);

    if (!host || !*host) {
        web_exchange_refuse(exchange, 400, "no-host", "the request has no header Host");
    } else if (strnlen(path, WEB_URI_MOST_BYTES + 1) + (query ? strlen(query) : 0) >
               WEB_URI_MOST_BYTES) {
        web_exchange_refuse(exchange, 414, "too-long", "the path is too long");
    } else if (strncmp(path, api, sizeof api - 1) == 0 && path[sizeof api - 1] == '/') {
        check_api(exchange, path + sizeof api - 1, query, method);
    } else if (plain) {
        check_plain(exchange, plain, path, query, method);
    } else {
        check_file(exchange, path, method);
    }
}
