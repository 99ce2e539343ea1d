#include "enroll/hub/outlet/address.h"

#include <curl/curl.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct {
    const char *word;
    enum hub_outlet_kind kind;
    enum hub__scheme scheme;
    uint16_t port;
} schemes[] = {
    {"https", HUB_OUTLET_WEBHOOK, HUB__HTTPS, 443}, {"http", HUB_OUTLET_WEBHOOK, HUB__HTTP, 80},
    {"tls", HUB_OUTLET_SYSLOG, HUB__TLS, 6514},     {"tcp", HUB_OUTLET_SYSLOG, HUB__TCP, 601},
    {"udp", HUB_OUTLET_SYSLOG, HUB__UDP, 514},
};

enum { SCHEMES = sizeof schemes / sizeof *schemes };

static const char local[] = "local:";

static int wrong(const char *text, const char *why, struct iso_fault *fault)
{
    return iso_fault_set(fault, -EINVAL, "%s: %s", text, why);
}

/* A part of the address; "" if it has none. */
static char *part(CURLU *url, CURLUPart what)
{
    char *text = NULL;
    if (curl_url_get(url, what, &text, 0)) {
        curl_free(text);
        return NULL;
    }
    return text;
}

static bool is_localhost(const char *host)
{
    return strcmp(host, "localhost") == 0 || strcmp(host, "127.0.0.1") == 0 ||
           strcmp(host, "::1") == 0;
}

static void take_host(const char *text, char out[256])
{
    const size_t length = strlen(text);
    const bool brackets = text[0] == '[' && text[length - 1] == ']';
    (void)snprintf(out, 256, "%.*s", (int)(brackets ? length - 2 : length), text + brackets);
}

static int take(enum hub_outlet_kind kind, CURLU *url, const char *text, struct hub__address *out,
                struct iso_fault *fault)
{
    char *scheme = part(url, CURLUPART_SCHEME), *host = part(url, CURLUPART_HOST);
    char *port = part(url, CURLUPART_PORT), *user = part(url, CURLUPART_USER);
    char *fragment = part(url, CURLUPART_FRAGMENT), *path = part(url, CURLUPART_PATH);
    size_t i = 0;
    while (scheme && i < SCHEMES && (strcmp(scheme, schemes[i].word) || schemes[i].kind != kind)) {
        i++;
    }
    int error = 0;
    if (!scheme || i == SCHEMES) {
        error = wrong(text,
                      kind == HUB_OUTLET_WEBHOOK
                          ? "the address of a webhook begins with https://"
                          : "the address of syslog begins with tls://, tcp://, udp:// or local:",
                      fault);
    } else if (!host || !*host || strlen(host) >= sizeof out->host) {
        error = wrong(text, "the address has no host", fault);
    } else if (user || fragment) {
        error = wrong(text, "an address has neither a name, a password nor a '#'", fault);
    } else if (kind == HUB_OUTLET_SYSLOG && path && strcmp(path, "/") != 0) {
        error = wrong(text, "the address of syslog has no path", fault);
    } else {
        out->scheme = schemes[i].scheme;
        out->port = port ? (uint16_t)strtoul(port, NULL, 10) : schemes[i].port;
        take_host(host, out->host);
    }
    if (!error && out->scheme == HUB__HTTP && !is_localhost(out->host)) {
        error = wrong(text, "http:// is possible for localhost alone; use https://", fault);
    }
    char *all[] = {scheme, host, port, user, fragment, path};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
        curl_free(all[k]);
    }
    return error;
}

int hub__address_read(enum hub_outlet_kind kind, const char *text, struct hub__address *out,
                      struct iso_fault *fault)
{
    struct hub__address address = {.scheme = HUB__LOCAL, .path = ""};
    if (strlen(text) >= HUB_OUTLET_ADDRESS_SIZE) {
        return iso_fault_set(fault, -EINVAL, "an address has at most %d bytes",
                             HUB_OUTLET_ADDRESS_SIZE - 1);
    }
    if (kind == HUB_OUTLET_SYSLOG && strncmp(text, local, strlen(local)) == 0) {
        address.path = text + strlen(local);
        if (address.path[0] != '/' || strlen(address.path) > 100) {
            return wrong(text, "the path of a socket begins with / and has at most 100 bytes",
                         fault);
        }
        *out = address;
        return 0;
    }
    CURLU *url = curl_url();
    if (!url) {
        return iso_fault_set(fault, -ENOMEM, "an address: no memory");
    }
    const CURLUcode code = curl_url_set(url, CURLUPART_URL, text, CURLU_NON_SUPPORT_SCHEME);
    const int error = code ? wrong(text, curl_url_strerror(code), fault)
                           : take(kind, url, text, &address, fault);
    curl_url_cleanup(url);
    if (!error) {
        *out = address;
    }
    return error;
}
