#include "tests/enroll/hub/outlet/receiver.h"

#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>

#include <gnutls/crypto.h>
#include <gnutls/gnutls.h>
#include <gnutls/x509.h>
#include <inttypes.h>
#include <microhttpd.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static void pause_ms(int ms)
{
    const struct timespec time = {.tv_sec = ms / 1000, .tv_nsec = (long)(ms % 1000) * 1000000};
    (void)nanosleep(&time, NULL);
}

static int64_t clock_ms(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000 + now.tv_nsec / 1000000;
}

/* ---- the certificate ---- */

void receiver_pair_make(struct receiver_pair *pair)
{
    static const uint8_t serial[] = {7};
    static const uint8_t loopback[] = {127, 0, 0, 1};
    gnutls_x509_privkey_t key;
    gnutls_x509_crt_t crt;
    size_t key_size = sizeof pair->key - 1, crt_size = sizeof pair->certificate - 1;
    const time_t now = time(NULL);
    memset(pair, 0, sizeof *pair);
    assert_int_equal(gnutls_x509_privkey_init(&key), 0);
    assert_int_equal(gnutls_x509_privkey_generate(
                         key, GNUTLS_PK_ECDSA, GNUTLS_CURVE_TO_BITS(GNUTLS_ECC_CURVE_SECP256R1), 0),
                     0);
    assert_int_equal(gnutls_x509_crt_init(&crt), 0);
    assert_int_equal(gnutls_x509_crt_set_version(crt, 3), 0);
    assert_int_equal(gnutls_x509_crt_set_key(crt, key), 0);
    assert_int_equal(gnutls_x509_crt_set_serial(crt, serial, sizeof serial), 0);
    assert_int_equal(gnutls_x509_crt_set_activation_time(crt, now - 60), 0);
    assert_int_equal(gnutls_x509_crt_set_expiration_time(crt, now + 3600), 0);
    assert_int_equal(gnutls_x509_crt_set_dn(crt, "CN=receiver", NULL), 0);
    assert_int_equal(gnutls_x509_crt_set_subject_alt_name(crt, GNUTLS_SAN_DNSNAME, "localhost", 9,
                                                          GNUTLS_FSAN_SET),
                     0);
    assert_int_equal(gnutls_x509_crt_set_subject_alt_name(crt, GNUTLS_SAN_IPADDRESS, loopback,
                                                          sizeof loopback, GNUTLS_FSAN_APPEND),
                     0);
    assert_int_equal(gnutls_x509_crt_set_basic_constraints(crt, 1, -1), 0);
    assert_int_equal(gnutls_x509_crt_sign2(crt, crt, key, GNUTLS_DIG_SHA256, 0), 0);
    assert_int_equal(gnutls_x509_privkey_export(key, GNUTLS_X509_FMT_PEM, pair->key, &key_size), 0);
    assert_int_equal(gnutls_x509_crt_export(crt, GNUTLS_X509_FMT_PEM, pair->certificate, &crt_size),
                     0);
    gnutls_x509_crt_deinit(crt);
    gnutls_x509_privkey_deinit(key);
}

/* ---- requests ---- */

struct body {
    char *bytes;
    size_t size;
};

static const char *header(struct MHD_Connection *connection, const char *name)
{
    const char *value = MHD_lookup_connection_value(connection, MHD_HEADER_KIND, name);
    return value ? value : "";
}

/* Checks the signature as the documents describe it, by another library than the hub uses. */
static bool is_signed(const struct receiver *receiver, const char *signature, const char *body)
{
    char text[sizeof receiver->secret + 64], digits[65] = "";
    uint8_t mac[32];
    int64_t time_s = 0;
    if (sscanf(signature, "t=%" SCNd64 ",v1=%64s", &time_s, digits) != 2 ||
        time_s < time(NULL) - 10 || time_s > time(NULL) + 10) {
        return false;
    }
    const int prefix = snprintf(text, sizeof text, "%" PRId64 ".", time_s);
    gnutls_hmac_hd_t hmac;
    if (gnutls_hmac_init(&hmac, GNUTLS_MAC_SHA256, receiver->secret, strlen(receiver->secret))) {
        return false;
    }
    (void)gnutls_hmac(hmac, text, (size_t)prefix);
    (void)gnutls_hmac(hmac, body, strlen(body));
    gnutls_hmac_deinit(hmac, mac);
    for (size_t i = 0; i < sizeof mac; i++) {
        (void)snprintf(text + 2 * i, 3, "%02x", mac[i]);
    }
    return strlen(digits) == 64 && strcmp(digits, text) == 0;
}

static unsigned keep(struct receiver *receiver, struct MHD_Connection *connection, const char *url,
                     const char *method, char *body)
{
    (void)pthread_mutex_lock(&receiver->lock);
    const unsigned status = receiver->next_status < receiver->n_statuses
                                ? receiver->statuses[receiver->next_status++]
                                : 200;
    if (receiver->n < RECEIVER_REQUESTS) {
        struct receiver_request *request = &receiver->requests[receiver->n++];
        (void)snprintf(request->key, sizeof request->key, "%s",
                       header(connection, "Idempotency-Key"));
        request->body = body;
        request->is_genuine = strcmp(method, "POST") == 0 && strcmp(url, "/events") == 0 &&
                              strcmp(header(connection, "Content-Type"), "application/json") == 0 &&
                              is_signed(receiver, header(connection, "Isotherm-Signature"), body);
        request->status = status;
        request->at_ms = clock_ms();
    }
    (void)pthread_mutex_unlock(&receiver->lock);
    return status;
}

static enum MHD_Result answer(struct receiver *receiver, struct MHD_Connection *connection,
                              unsigned status)
{
    struct MHD_Response *response = MHD_create_response_from_buffer(2, (void *)(uintptr_t) "{}",
                                                                    MHD_RESPMEM_PERSISTENT);
    if (status != 200 && receiver->retry_after) {
        (void)MHD_add_response_header(response, "Retry-After", receiver->retry_after);
    }
    if (status != 200 && receiver->location) {
        (void)MHD_add_response_header(response, "Location", receiver->location);
    }
    (void)pthread_mutex_lock(&receiver->lock);
    const int delay_ms = receiver->delay_ms;
    (void)pthread_mutex_unlock(&receiver->lock);
    pause_ms(delay_ms);
    const enum MHD_Result result = MHD_queue_response(connection, status, response);
    MHD_destroy_response(response);
    return result;
}

static enum MHD_Result handle(void *context, struct MHD_Connection *connection, const char *url,
                              const char *method, const char *version, const char *bytes,
                              size_t *size, void **state)
{
    struct body *body = *state;
    (void)version;
    if (!body) {
        *state = calloc(1, sizeof *body);
        return *state ? MHD_YES : MHD_NO;
    }
    if (*size > 0) {
        char *longer = realloc(body->bytes, body->size + *size + 1);
        if (!longer) {
            return MHD_NO;
        }
        memcpy(longer + body->size, bytes, *size);
        body->bytes = longer;
        body->size += *size;
        longer[body->size] = '\0';
        *size = 0;
        return MHD_YES;
    }
    char *whole = body->bytes ? body->bytes : strdup("");
    body->bytes = NULL;
    return answer(context, connection, keep(context, connection, url, method, whole));
}

static void completed(void *context, struct MHD_Connection *connection, void **state,
                      enum MHD_RequestTerminationCode code)
{
    struct body *body = *state;
    (void)context;
    (void)connection;
    (void)code;
    if (body) {
        free(body->bytes);
        free(body);
    }
}

void receiver_start(struct receiver *receiver, const char *secret)
{
    memset(receiver, 0, sizeof *receiver);
    (void)pthread_mutex_init(&receiver->lock, NULL);
    (void)snprintf(receiver->secret, sizeof receiver->secret, "%s", secret);
    receiver_pair_make(&receiver->pair);
    receiver->daemon = MHD_start_daemon(
        MHD_USE_INTERNAL_POLLING_THREAD | MHD_USE_TLS | MHD_USE_THREAD_PER_CONNECTION, 0, NULL,
        NULL, handle, receiver, MHD_OPTION_HTTPS_MEM_KEY, receiver->pair.key,
        MHD_OPTION_HTTPS_MEM_CERT, receiver->pair.certificate, MHD_OPTION_NOTIFY_COMPLETED,
        completed, NULL, MHD_OPTION_END);
    assert_non_null(receiver->daemon);
    receiver->port = MHD_get_daemon_info(receiver->daemon, MHD_DAEMON_INFO_BIND_PORT)->port;
}

void receiver_stop(struct receiver *receiver)
{
    MHD_stop_daemon(receiver->daemon);
    for (size_t i = 0; i < receiver->n; i++) {
        free(receiver->requests[i].body);
    }
    (void)pthread_mutex_destroy(&receiver->lock);
}

void receiver_answer(struct receiver *receiver, size_t n, const unsigned *statuses)
{
    (void)pthread_mutex_lock(&receiver->lock);
    memcpy(receiver->statuses, statuses, n * sizeof *statuses);
    receiver->n_statuses = n;
    receiver->next_status = 0;
    (void)pthread_mutex_unlock(&receiver->lock);
}

void receiver_delay(struct receiver *receiver, int ms)
{
    (void)pthread_mutex_lock(&receiver->lock);
    receiver->delay_ms = ms;
    (void)pthread_mutex_unlock(&receiver->lock);
}

void receiver_wait(struct receiver *receiver, size_t n, double seconds)
{
    const int64_t until_ms = clock_ms() + (int64_t)(1000 * seconds);
    size_t now = 0;
    do {
        pause_ms(5);
        (void)pthread_mutex_lock(&receiver->lock);
        now = receiver->n;
        (void)pthread_mutex_unlock(&receiver->lock);
    } while (now < n && clock_ms() < until_ms);
    if (now < n) {
        fail_msg("%zu requests came, not %zu", now, n);
    }
}
