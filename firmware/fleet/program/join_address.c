#include "firmware/fleet/program/join_address.h"

#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char scheme[] = "isotherm://";

static int refuse(struct iso_fault *fault, const char *why)
{
    return iso_fault_set(fault, -EINVAL, "the address: %s", why);
}

/* A name, an IPv4 address, or an IPv6 address in brackets. */
static bool is_host(const char *text, size_t n)
{
    static const char name[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789.-_";
    const bool is_bracketed = n > 2 && text[0] == '[' && text[n - 1] == ']';

    if (n == 0 || n >= LINK_HOST_SIZE) {
        return false;
    }
    return is_bracketed ? strspn(text + 1, "0123456789abcdefABCDEF:.") == n - 2
                        : strspn(text, name) >= n;
}

static bool is_port(const char *text, size_t n)
{
    const long port = strtol(text, NULL, 10);

    return n >= 1 && n <= 5 && strspn(text, "0123456789") >= n && port >= 1 && port <= 65535;
}

/* "HOST:PORT", which ends at `end`. */
static int read_host(const char *text, const char *end, struct link_join_address *out,
                     struct iso_fault *fault)
{
    const char *colon = memrchr(text, ':', (size_t)(end - text));

    if (!colon || !is_host(text, (size_t)(colon - text)) ||
        !is_port(colon + 1, (size_t)(end - colon - 1))) {
        return refuse(fault, "HOST:PORT is missing");
    }
    (void)snprintf(out->url, sizeof out->url, "https://%.*s", (int)(end - text), text);
    return 0;
}

static bool read_digest(const char *value, size_t n, uint8_t out[LINK_DIGEST_BYTES])
{
    size_t read = 0;

    return n == 2 * (size_t)LINK_DIGEST_BYTES &&
           sodium_hex2bin(out, LINK_DIGEST_BYTES, value, n, NULL, &read, NULL) == 0 &&
           read == LINK_DIGEST_BYTES;
}

static bool read_code(const char *value, size_t n, char out[LINK_CODE_SIZE])
{
    static const char allowed[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-=";

    if (n == 0 || n >= LINK_CODE_SIZE || strspn(value, allowed) < n) {
        return false;
    }
    memcpy(out, value, n);
    out[n] = '\0';
    return true;
}

/* "ca=...&code=...", in any order; unknown parameters of later versions are ignored. */
static int read_parameters(const char *text, struct link_join_address *out, struct iso_fault *fault)
{
    bool has_ca = false, has_code = false;

    while (*text) {
        const size_t n = strcspn(text, "&");
        if (strncmp(text, "ca=", 3) == 0) {
            has_ca = read_digest(text + 3, n - 3, out->ca);
        } else if (strncmp(text, "code=", 5) == 0) {
            has_code = read_code(text + 5, n - 5, out->code);
        }
        text += n + (text[n] == '&');
    }
    if (!has_ca) {
        return refuse(fault, "ca= is not 64 hexadecimal digits");
    }
    return has_code ? 0
                    : refuse(fault, "code= is missing or has other signs than letters and digits");
}

int link_join_address_read(const char *text, struct link_join_address *out, struct iso_fault *fault)
{
    struct link_join_address read = {.url = ""};

    if (strncmp(text, scheme, strlen(scheme)) != 0) {
        return refuse(fault, "does not begin with isotherm://");
    }
    text += strlen(scheme);
    const size_t n = strcspn(text, "/?");
    int r = read_host(text, text + n, &read, fault);
    if (r < 0) {
        return r;
    }
    text += n + (text[n] == '/');
    if (*text != '?') {
        return refuse(fault, "?ca=...&code=... is missing");
    }
    r = read_parameters(text + 1, &read, fault);
    if (r == 0) {
        *out = read;
    }
    sodium_memzero(&read, sizeof read);
    return r;
}
