/* POST /fleet/v1/join and /fleet/v1/renew: certificates of doors.
 *
 *   join   {"code", "address", "csr", "name"} -> {"door", "membership", "certificate", "ca",
 *          "broker": {"host", "port"}}. The code is the door's right to join
 *   renew  {"csr"} -> {"certificate", "ca"}. The request is for the key of a certificate that the
 *          door has had, which it proves by the request's own signature; so a certificate that has
 *          ended is renewed, too, and whoever repeats the request gets nothing that is of use */
#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <systemd/sd-daemon.h>

#include "enroll/hub/broker/hub_certificate.h"
#include "enroll/hub/serve/service.h"
#include "enroll/hub/store/hub_door.h"

/* What the errors of these requests are for a program. */
static const struct {
    int error;
    unsigned status;
    const char *code;
} answers[] = {
    {-EACCES, 403, "code-refused"},  {-EINVAL, 400, "invalid-address"},
    {-EEXIST, 409, "joined-before"}, {-EBADMSG, 400, "invalid-request"},
    {-ENOENT, 403, "key-unknown"},   {-EKEYREJECTED, 400, "invalid-key"},
    {-ENOTCONN, 503, "no-database"}, {-EAGAIN, 503, "no-database"},
};

static void refuse(struct web_exchange *exchange, int error, const struct iso_fault *fault)
{
    for (size_t i = 0; i < sizeof answers / sizeof *answers; i++) {
        if (answers[i].error == error) {
            if (answers[i].status == 503) {
                web_exchange_header(exchange, "Retry-After", "5");
            }
            web_exchange_problem(exchange, answers[i].status, answers[i].code, fault->text);
            return;
        }
    }
    fprintf(stderr, SD_ERR "isotherm-hub: a door's certificate: %s\n", fault->text);
    web_exchange_problem(exchange, 500, "internal", "the hub could not do it; its log says why");
}

/* The object of the body, or NULL after an answer. */
static json_t *body_of(struct web_exchange *exchange)
{
    size_t size;
    const char *text = web_exchange_bytes(exchange, &size);
    json_t *body = json_loadb(text ? text : "", size, JSON_REJECT_DUPLICATES, NULL);

    if (!json_is_object(body)) {
        json_decref(body);
        web_exchange_problem(exchange, 400, "invalid-json", "the body is no JSON object");
        return NULL;
    }
    return body;
}

static const char *text_of(const json_t *body, const char *name)
{
    const char *text = json_string_value(json_object_get(body, name));

    return text ? text : "";
}

static bool may_try(struct web_exchange *exchange, struct hub_bucket *bucket)
{
    if (hub_bucket_take(bucket, hub__clock_s())) {
        return true;
    }
    web_exchange_header(exchange, "Retry-After", "2");
    web_exchange_problem(exchange, 429, "too-many", "there are too many attempts at this time");
    return false;
}

/* A certificate for the key of a request, which the hub remembers before it hands it out. */
static int certify(struct hub_service *service, const char *csr, const struct iso_fleet_id *door,
                   struct hub_door_certificate *out, struct iso_fault *fault)
{
    int r = hub_ca_sign_door(service->ca, csr, strlen(csr), door, service->store.now_s(), out,
                             fault);

    if (r == 0) {
        r = hub_certificate_add(&service->store, door, out, fault);
        if (r < 0) {
            free(out->pem);
            out->pem = NULL;
        }
    }
    return r;
}

/* ---- join ---- */

static char *base64_of(const struct iso_fleet_bytes *bytes)
{
    const size_t size = sodium_base64_encoded_len(bytes->size, sodium_base64_VARIANT_ORIGINAL);
    char *text = malloc(size);

    if (text) {
        (void)sodium_bin2base64(text, size, bytes->bytes, bytes->size,
                                sodium_base64_VARIANT_ORIGINAL);
    }
    return text;
}

static json_t *reply_of(const struct hub_service *service, const struct iso_fleet_id *door,
                        const struct iso_fleet_bytes *membership, const char *certificate)
{
    char id[ISO_FLEET_ID_TEXT_SIZE];
    char *base64 = base64_of(membership);
    json_t *reply = base64 ? json_pack("{s:s, s:s, s:s, s:s, s:{s:s, s:i}}", "door",
                                       iso_fleet_id_text(door, id), "membership", base64,
                                       "certificate", certificate, "ca", hub_ca_pem(service->ca),
                                       "broker", "host", service->options->door_broker_host, "port",
                                       (int)service->options->door_broker_port)
                           : NULL;

    free(base64);
    return reply;
}

/* The request is checked first, because the code can be used once. */
static int join(struct hub_service *service, const json_t *body, json_t **reply,
                struct iso_fault *fault)
{
    const char *csr = text_of(body, "csr");
    const struct hub_join wanted = {.code = text_of(body, "code"),
                                    .address = text_of(body, "address"),
                                    .name = text_of(body, "name")};
    struct hub_door_certificate certificate = {.pem = NULL};
    struct iso_fleet_bytes membership = {.size = 0};
    uint8_t key[HUB_CA_DIGEST_BYTES];
    char id[ISO_FLEET_ID_TEXT_SIZE];
    struct iso_fleet_id door;
    int r = hub_ca_check_request(csr, strlen(csr), key, fault);

    r = r < 0 ? r : hub_door_join(&service->store, &wanted, &door, &membership, fault);
    if (r == 0) {
        r = certify(service, csr, &door, &certificate, fault);
        if (r == 0) {
            *reply = reply_of(service, &door, &membership, certificate.pem);
            fprintf(stderr, SD_NOTICE "isotherm-hub: door %s has joined\n",
                    iso_fleet_id_text(&door, id));
        }
    }
    free(certificate.pem);
    iso_fleet_bytes_free(&membership);
    return r;
}

void hub__post_join(void *context, struct web_exchange *exchange)
{
    struct hub_service *service = context;
    const double begun_s = hub__clock_s();
    struct iso_fault fault = {.text = ""};
    json_t *reply = NULL;
    json_t *body = may_try(exchange, &service->joins) ? body_of(exchange) : NULL;

    if (!body) {
        service->totals.joins_refused++;
        return;
    }
    const int r = join(service, body, &reply, &fault);
    hub__measured(service, "the joining of a door", begun_s);
    json_decref(body);
    if (r < 0) {
        service->totals.joins_refused++;
        refuse(exchange, r, &fault);
        return;
    }
    service->totals.joins++;
    web_exchange_json(exchange, 200, reply);
}

/* ---- renew ---- */

static int renew(struct hub_service *service, const char *csr, json_t **reply,
                 struct iso_fault *fault)
{
    struct hub_door_certificate certificate = {.pem = NULL};
    uint8_t key[HUB_CA_DIGEST_BYTES];
    struct iso_fleet_id door;
    int r = hub_ca_check_request(csr, strlen(csr), key, fault);

    r = r < 0 ? r : hub_certificate_owner(&service->store, key, &door, fault);
    r = r < 0 ? r : certify(service, csr, &door, &certificate, fault);
    if (r == 0) {
        *reply = json_pack("{s:s, s:s}", "certificate", certificate.pem, "ca",
                           hub_ca_pem(service->ca));
    }
    free(certificate.pem);
    return r;
}

void hub__post_renew(void *context, struct web_exchange *exchange)
{
    struct hub_service *service = context;
    struct iso_fault fault = {.text = ""};
    json_t *reply = NULL;
    json_t *body = may_try(exchange, &service->renewals) ? body_of(exchange) : NULL;

    if (!body) {
        return;
    }
    const int r = renew(service, text_of(body, "csr"), &reply, &fault);
    json_decref(body);
    if (r < 0) {
        refuse(exchange, r, &fault);
        return;
    }
    service->totals.renewals++;
    web_exchange_json(exchange, 200, reply);
}
