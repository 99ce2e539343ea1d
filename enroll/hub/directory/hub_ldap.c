#include "enroll/hub/directory/hub_ldap.h"

#include <errno.h>
#include <ldap.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/time.h>

#include "enroll/hub/directory/ldap_map.h"

enum { PAGE = 500, CONNECT_S = 10, ANSWER_S = 60 };

struct reading {
    const struct hub_ldap_options *options;
    struct hub__ldap_map map;
    LDAP *ldap;
    struct hub_named *list;
    size_t n, capacity;
};

static int refused(const struct reading *r, int code, struct iso_fault *fault)
{
    const int error = code == LDAP_NO_MEMORY             ? -ENOMEM
                      : code == LDAP_FILTER_ERROR        ? -EINVAL
                      : code == LDAP_INVALID_CREDENTIALS ? -EACCES
                      : code == LDAP_SERVER_DOWN || code == LDAP_CONNECT_ERROR ||
                              code == LDAP_TIMEOUT || code == LDAP_UNAVAILABLE
                          ? -ENOTCONN
                          : -EIO;
    char *more = NULL;
    (void)ldap_get_option(r->ldap, LDAP_OPT_DIAGNOSTIC_MESSAGE, &more);
    (void)iso_fault_set(fault, error, "%s: %s%s%s", r->options->uri, ldap_err2string(code),
                        more && *more ? ": " : "", more ? more : "");
    ldap_memfree(more);
    return error;
}

/* ---- the connection ---- */

/* Whether the server can be reached without TLS: a socket, or this machine itself. */
static int is_near(const char *uri, bool *near, bool *is_tls, struct iso_fault *fault)
{
    LDAPURLDesc *url = NULL;
    if (ldap_url_parse(uri, &url) != LDAP_URL_SUCCESS) {
        return iso_fault_set(fault, -EINVAL, "%s: is no address of a directory", uri);
    }
    const char *host = url->lud_host ? url->lud_host : "";
    *is_tls = strcmp(url->lud_scheme, "ldaps") == 0;
    *near = strcmp(url->lud_scheme, "ldapi") == 0 || strcmp(host, "localhost") == 0 ||
            strcmp(host, "127.0.0.1") == 0 || strcmp(host, "::1") == 0;
    ldap_free_urldesc(url);
    return 0;
}

static int set_options(const struct reading *r, struct iso_fault *fault)
{
    const int version = LDAP_VERSION3, demand = LDAP_OPT_X_TLS_DEMAND, client = 0;
    const struct timeval connect = {.tv_sec = CONNECT_S}, answer = {.tv_sec = ANSWER_S};
    int code = ldap_set_option(r->ldap, LDAP_OPT_PROTOCOL_VERSION, &version);
    code = code ? code : ldap_set_option(r->ldap, LDAP_OPT_REFERRALS, LDAP_OPT_OFF);
    code = code ? code : ldap_set_option(r->ldap, LDAP_OPT_NETWORK_TIMEOUT, &connect);
    code = code ? code : ldap_set_option(r->ldap, LDAP_OPT_TIMEOUT, &answer);
    code = code ? code : ldap_set_option(r->ldap, LDAP_OPT_X_TLS_REQUIRE_CERT, &demand);
    if (!code && r->options->ca_file) {
        code = ldap_set_option(r->ldap, LDAP_OPT_X_TLS_CACERTFILE, r->options->ca_file);
    }
    code = code ? code : ldap_set_option(r->ldap, LDAP_OPT_X_TLS_NEWCTX, &client);
    return code ? iso_fault_set(fault, -EINVAL, "%s: the options of TLS cannot be set%s%s",
                                r->options->uri, r->options->ca_file ? ": " : "",
                                r->options->ca_file ? r->options->ca_file : "")
                : 0;
}

static int connect_to(struct reading *r, struct iso_fault *fault)
{
    const struct hub_ldap_options *o = r->options;
    struct berval password = {.bv_len = 0};
    bool near = false, is_tls = false;
    int error = is_near(o->uri, &near, &is_tls, fault);
    if (error) {
        return error;
    }
    /* A name without a password would be let in as nobody (RFC 4513, 5.1.2). */
    if (o->bind && (!o->password || !*o->password)) {
        return iso_fault_set(fault, -EINVAL, "%s: a name needs a password", o->uri);
    }
    int code = ldap_initialize(&r->ldap, o->uri);
    if (code) {
        return iso_fault_set(fault, -EINVAL, "%s: %s", o->uri, ldap_err2string(code));
    }
    error = set_options(r, fault);
    if (error) {
        return error;
    }
    code = is_tls || (near && !o->ca_file) ? 0 : ldap_start_tls_s(r->ldap, NULL, NULL);
    if (code) {
        return refused(r, code, fault);
    }
    if (o->bind) {
        password.bv_val = (char *)(uintptr_t)o->password;
        password.bv_len = strlen(o->password);
    }
    code = ldap_sasl_bind_s(r->ldap, o->bind ? o->bind : "", LDAP_SASL_SIMPLE, &password, NULL,
                            NULL, NULL);
    return code ? refused(r, code, fault) : 0;
}

/* ---- entries ---- */

static int bad_entry(const struct reading *r, LDAPMessage *entry, const char *attribute,
                     const char *why, struct iso_fault *fault)
{
    char *dn = ldap_get_dn(r->ldap, entry);
    (void)iso_fault_set(fault, -EBADMSG, "%s: %s %s", dn ? dn : "an entry", attribute, why);
    ldap_memfree(dn);
    return -EBADMSG;
}

/* Reads the first value of an attribute as a text; *has says whether there is one. -EBADMSG it does
 * not fit: an end or a lock that cannot be read must not count as none. */
static int first_value(const struct reading *r, LDAPMessage *entry, const char *attribute,
                       char *out, size_t size, bool *has, struct iso_fault *fault)
{
    struct berval **values = *attribute ? ldap_get_values_len(r->ldap, entry, attribute) : NULL;
    bool fits = true;
    *has = values && values[0];
    if (*has) {
        fits = values[0]->bv_len < size && strlen(values[0]->bv_val) == values[0]->bv_len;
    }
    if (*has && fits) {
        memcpy(out, values[0]->bv_val, values[0]->bv_len + 1);
    }
    ldap_value_free_len(values);
    return fits ? 0 : bad_entry(r, entry, attribute, "is too long", fault);
}

static int take_id(const struct reading *r, LDAPMessage *entry, struct hub_named *out,
                   struct iso_fault *fault)
{
    struct berval **values = ldap_get_values_len(r->ldap, entry, r->map.id);
    const int error = values && values[0]
                          ? hub__ldap_id(values[0]->bv_val, values[0]->bv_len, out->external)
                          : -EINVAL;
    ldap_value_free_len(values);
    return error ? bad_entry(r, entry, r->map.id, "is missing or too long", fault) : 0;
}

static int take_name(const struct reading *r, LDAPMessage *entry, struct hub_named *out,
                     struct iso_fault *fault)
{
    bool has = false;
    const int error = first_value(r, entry, r->map.name, out->name, sizeof out->name, &has, fault);
    return error || has ? error : bad_entry(r, entry, r->map.name, "is missing", fault);
}

static int take_time(const struct reading *r, LDAPMessage *entry, const char *attribute,
                     int64_t *out, struct iso_fault *fault)
{
    char text[64];
    bool has = false;
    const int error = first_value(r, entry, attribute, text, sizeof text, &has, fault);
    return !error && has && hub__ldap_time(text, out)
               ? bad_entry(r, entry, attribute, "is no time", fault)
               : error;
}

static int take_lock(const struct reading *r, LDAPMessage *entry, bool *active,
                     struct iso_fault *fault)
{
    char text[64];
    bool has = false;
    const int error = first_value(r, entry, r->map.disabled, text, sizeof text, &has, fault);
    *active = !has || !hub__ldap_is_disabled(r->map.disabled, text);
    return error;
}

static void add_zone(struct hub_named *out, const struct iso_fleet_id *zone)
{
    for (size_t i = 0; i < out->n_zones; i++) {
        if (iso_fleet_id_is_same(&out->zones[i], zone)) {
            return;
        }
    }
    if (out->n_zones < HUB_PERSON_ZONES_MAX) {
        out->zones[out->n_zones++] = *zone;
    }
}

static void take_groups(const struct reading *r, LDAPMessage *entry, struct hub_named *out)
{
    struct berval **values = *r->map.group ? ldap_get_values_len(r->ldap, entry, r->map.group)
                                           : NULL;
    for (size_t v = 0; values && values[v]; v++) {
        for (size_t g = 0; g < r->options->n_groups; g++) {
            if (hub__ldap_is_group(values[v]->bv_val, r->options->groups[g].group)) {
                add_zone(out, &r->options->groups[g].zone);
            }
        }
    }
    ldap_value_free_len(values);
}

static int take_entry(struct reading *r, LDAPMessage *entry, struct iso_fault *fault)
{
    if (r->n == r->capacity) {
        const size_t capacity = r->capacity ? 2 * r->capacity : 64;
        struct hub_named *longer = realloc(r->list, capacity * sizeof *longer);
        if (!longer) {
            return iso_fault_set(fault, -ENOMEM, "%s: no memory", r->options->uri);
        }
        r->list = longer;
        r->capacity = capacity;
    }
    struct hub_named *out = &r->list[r->n];
    *out = (struct hub_named){.active = true};
    int error = take_id(r, entry, out, fault);
    error = error ? error : take_name(r, entry, out, fault);
    error = error ? error : take_lock(r, entry, &out->active, fault);
    error = error ? error : take_time(r, entry, r->map.from, &out->from_s, fault);
    error = error ? error : take_time(r, entry, r->map.until, &out->until_s, fault);
    if (error) {
        return error;
    }
    take_groups(r, entry, out);
    r->n++;
    return 0;
}

/* ---- pages ---- */

/* Takes one page, and the cookie of the next one. */
static int take_page(struct reading *r, LDAPMessage *answer, struct berval *cookie,
                     struct iso_fault *fault)
{
    LDAPControl **controls = NULL;
    int code = LDAP_SUCCESS, error = 0;
    ber_int_t estimate = 0;
    const int parsed = ldap_parse_result(r->ldap, answer, &code, NULL, NULL, NULL, &controls, 0);
    if (parsed || code) {
        error = refused(r, parsed ? parsed : code, fault);
    }
    for (LDAPMessage *entry = error ? NULL : ldap_first_entry(r->ldap, answer); entry && !error;
         entry = ldap_next_entry(r->ldap, entry)) {
        error = take_entry(r, entry, fault);
    }
    ber_memfree(cookie->bv_val);
    *cookie = (struct berval){.bv_len = 0};
    LDAPControl *page = controls ? ldap_control_find(LDAP_CONTROL_PAGEDRESULTS, controls, NULL)
                                 : NULL;
    if (!error && page) {
        code = ldap_parse_pageresponse_control(r->ldap, page, &estimate, cookie);
        error = code ? refused(r, code, fault) : 0;
    }
    ldap_controls_free(controls);
    return error;
}

static int read_pages(struct reading *r, struct iso_fault *fault)
{
    const struct hub_ldap_options *o = r->options;
    char *attributes[] = {r->map.id,   r->map.name,  r->map.group, r->map.disabled,
                          r->map.from, r->map.until, NULL};
    /* An empty name would end the list or ask for nothing. */
    size_t n = 0;
    for (size_t i = 0; i < sizeof attributes / sizeof *attributes - 1; i++) {
        if (*attributes[i]) {
            attributes[n++] = attributes[i];
        }
    }
    attributes[n] = NULL;
    struct berval cookie = {.bv_len = 0};
    int error = 0;
    do {
        LDAPControl *page = NULL;
        LDAPMessage *answer = NULL;
        int code = ldap_create_page_control(r->ldap, PAGE, &cookie, 1, &page);
        LDAPControl *controls[] = {page, NULL};
        if (!code) {
            code = ldap_search_ext_s(r->ldap, o->base, LDAP_SCOPE_SUBTREE,
                                     o->filter ? o->filter : "(objectClass=*)", attributes, 0,
                                     controls, NULL, NULL, LDAP_NO_LIMIT, &answer);
        }
        error = code ? refused(r, code, fault) : take_page(r, answer, &cookie, fault);
        (void)ldap_msgfree(answer);
        ldap_control_free(page);
    } while (!error && cookie.bv_len > 0);
    ber_memfree(cookie.bv_val);
    return error;
}

int hub_ldap_read(const struct hub_ldap_options *options, struct hub_named **out, size_t *n,
                  struct iso_fault *fault)
{
    struct reading r = {.options = options};
    int error = hub__ldap_map_read(options->map, &r.map, fault);
    error = error ? error : connect_to(&r, fault);
    error = error ? error : read_pages(&r, fault);
    if (r.ldap) {
        (void)ldap_unbind_ext_s(r.ldap, NULL, NULL);
    }
    if (error) {
        free(r.list);
        return error;
    }
    *out = r.list;
    *n = r.n;
    return 0;
}
