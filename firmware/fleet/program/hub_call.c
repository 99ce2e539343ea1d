#include "firmware/fleet/program/hub_call.h"

#include <curl/curl.h>
#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <systemd/sd-event.h>
#include <unistd.h>

#include "firmware/fleet/link/link_http.h"
#include "firmware/fleet/program/tls_key.h"

enum { REPLY_MOST_BYTES = 64 << 10, TIME_S = 60, CONNECT_S = 20, STATUS_OK = 200 };

/* ---- the authority ---- */

static char *find_certificate(const struct curl_certinfo *chain, const uint8_t digest[32])
{
    static const char start[] = "Cert:";

    for (int i = 0; i < chain->num_of_certs; i++) {
        for (const struct curl_slist *line = chain->certinfo[i]; line; line = line->next) {
            uint8_t own[32];
            int64_t ends_s = 0;
            if (strncmp(line->data, start, strlen(start)) == 0 &&
                link_tls_examine(line->data + strlen(start), own, &ends_s, NULL) == 0 &&
                sodium_memcmp(own, digest, sizeof own) == 0) {
                return strdup(line->data + strlen(start));
            }
        }
    }
    return NULL;
}

/* Only the certificates are looked at, so that it does not matter who answers. */
static CURLcode look(CURL *easy, const char *url, char why[CURL_ERROR_SIZE])
{
    CURLcode r = curl_easy_setopt(easy, CURLOPT_URL, url);

    r = r ? r : curl_easy_setopt(easy, CURLOPT_PROTOCOLS_STR, "https");
    r = r ? r : curl_easy_setopt(easy, CURLOPT_CONNECT_ONLY, 1L);
    r = r ? r : curl_easy_setopt(easy, CURLOPT_CERTINFO, 1L);
    r = r ? r : curl_easy_setopt(easy, CURLOPT_SSL_VERIFYPEER, 0L);
    r = r ? r : curl_easy_setopt(easy, CURLOPT_SSL_VERIFYHOST, 0L);
    r = r ? r : curl_easy_setopt(easy, CURLOPT_CONNECTTIMEOUT, (long)CONNECT_S);
    r = r ? r : curl_easy_setopt(easy, CURLOPT_NOPROXY, "*");
    r = r ? r : curl_easy_setopt(easy, CURLOPT_NOSIGNAL, 1L);
    r = r ? r : curl_easy_setopt(easy, CURLOPT_ERRORBUFFER, why);
    return r ? r : curl_easy_perform(easy);
}

int link_hub_authority(const char *url, const uint8_t digest[32], char **pem,
                       struct iso_fault *fault)
{
    char why[CURL_ERROR_SIZE] = "";
    struct curl_certinfo *chain = NULL;
    CURL *easy = curl_easy_init();

    if (!easy) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", url);
    }
    CURLcode r = look(easy, url, why);
    if (r) {
        curl_easy_cleanup(easy);
        return iso_fault_set(fault, -ECONNREFUSED, "%s: %s", url,
                             why[0] ? why : curl_easy_strerror(r));
    }
    r = curl_easy_getinfo(easy, CURLINFO_CERTINFO, &chain);
    char *found = r || !chain ? NULL : find_certificate(chain, digest);
    curl_easy_cleanup(easy);
    if (!found) {
        return iso_fault_set(fault, -EKEYREJECTED,
                             "%s: is not the hub of this address: its authority is another one",
                             url);
    }
    *pem = found;
    return 0;
}

/* ---- a request ---- */

struct waiting {
    sd_event *event;
    struct link_http_reply reply;
    char why[256];
    bool is_done;
};

static void on_reply(void *context, const struct link_http_reply *reply)
{
    struct waiting *waiting = context;

    waiting->reply = *reply;
    (void)snprintf(waiting->why, sizeof waiting->why, "%s", reply->why);
    waiting->reply.why = waiting->why;
    waiting->is_done = true;
    (void)sd_event_exit(waiting->event, 0);
}

static int wait_for(struct waiting *waiting, const struct link_http_setup *setup,
                    struct iso_fault *fault)
{
    struct link_http *http = NULL;
    struct link_http_request *request = NULL;
    int r = sd_event_new(&waiting->event);

    if (r < 0) {
        return iso_fault_set(fault, r, "%s: %s", setup->url, strerror(-r));
    }
    r = link_http_new(waiting->event, &http, fault);
    r = r < 0 ? r : link_http_post(http, setup, on_reply, waiting, &request, fault);
    if (r == 0) {
        (void)sd_event_loop(waiting->event);
        if (!waiting->is_done) {
            link_http_cancel(request);
            r = iso_fault_set(fault, -EIO, "%s: was interrupted", setup->url);
        }
    }
    link_http_free(http);
    waiting->event = sd_event_unref(waiting->event);
    return r;
}

/* The object of a reply; NULL: there is none. */
static json_t *read_reply(const struct link_http_reply *reply)
{
    char *text = malloc((size_t)reply->size + 1);
    json_t *object = NULL;

    if (text && pread(reply->fd, text, (size_t)reply->size, 0) == (ssize_t)reply->size) {
        object = json_loadb(text, (size_t)reply->size, JSON_REJECT_DUPLICATES, NULL);
    }
    free(text);
    if (!json_is_object(object)) {
        json_decref(object);
        return NULL;
    }
    return object;
}

static int refused(const char *url, int status, const json_t *reply, struct iso_fault *fault)
{
    const char *words = json_string_value(json_object_get(reply, "detail"));
    char said[160];

    (void)snprintf(said, sizeof said, "%s", words ? words : "without a reason");
    for (char *c = said; *c; c++) {
        *c = (unsigned char)*c < ' ' || *c == 0x7f ? '?' : *c; /* it goes to a terminal */
    }
    return iso_fault_set(fault, -EACCES, "%s: the hub refuses: %s (status %d)", url, said, status);
}

static int finish(const char *url, struct waiting *waiting, json_t **out, struct iso_fault *fault)
{
    const struct link_http_reply *reply = &waiting->reply;

    if (reply->error) {
        return iso_fault_set(fault, reply->error, "%s: %s", url, reply->why);
    }
    json_t *object = read_reply(reply);
    (void)close(reply->fd);
    if (reply->status != STATUS_OK) {
        const int r = refused(url, reply->status, object, fault);
        json_decref(object);
        return r;
    }
    if (!object) {
        return iso_fault_set(fault, -EBADMSG, "%s: the reply is no JSON object", url);
    }
    *out = object;
    return 0;
}

int link_hub_post(const char *url, const char *path, const char *ca_file, const json_t *body,
                  json_t **reply, struct iso_fault *fault)
{
    struct waiting waiting = {.is_done = false};
    char full[512];
    char *text = json_dumps(body, JSON_COMPACT);

    if (!text) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", url);
    }
    (void)snprintf(full, sizeof full, "%s%s", url, path);
    const struct link_http_setup setup = {.url = full,
                                          .ca_file = ca_file,
                                          .type = "application/json",
                                          .body = text,
                                          .size = strlen(text),
                                          .most_bytes = REPLY_MOST_BYTES,
                                          .time_s = TIME_S};
    int r = wait_for(&waiting, &setup, fault);
    sodium_memzero(text, strlen(text));
    free(text);
    return r < 0 ? r : finish(full, &waiting, reply, fault);
}
