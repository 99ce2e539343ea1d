#include "enroll/hub/broker/hub_pair.h"

#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <time.h>
#include <unistd.h>

#include "core/base/bytes.h"
#include "drivers/file/file.h"
#include "enroll/hub/broker/ca_inner.h"

static const struct {
    const char *key, *chain;
} names[] = {
    [HUB_PAIR_HTTPS] = {"https-key.pem", "https.pem"},
    [HUB_PAIR_BROKER] = {"broker-key.pem", "broker.pem"},
    [HUB_PAIR_CLIENT] = {"hub-client-key.pem", "hub-client.pem"},
    [HUB_PAIR_HOME] = {"home-assistant-key.pem", "home-assistant.pem"},
};

struct wanted {
    enum hub_pair_use use;
    const char *const *hosts;
    size_t n;
    int64_t now_s;
};

const char *hub_pair_key_name(enum hub_pair_use use)
{
    return names[use].key;
}

const char *hub_pair_chain_name(enum hub_pair_use use)
{
    return names[use].chain;
}

static bool is_client_use(enum hub_pair_use use)
{
    return use == HUB_PAIR_CLIENT || use == HUB_PAIR_HOME;
}

/* ---- making ---- */

static int add_host(gnutls_x509_crt_t certificate, const char *host)
{
    struct in6_addr v6;
    struct in_addr v4;

    if (inet_pton(AF_INET, host, &v4) == 1) {
        return gnutls_x509_crt_set_subject_alt_name(certificate, GNUTLS_SAN_IPADDRESS, &v4,
                                                    sizeof v4, GNUTLS_FSAN_APPEND);
    }
    if (inet_pton(AF_INET6, host, &v6) == 1) {
        return gnutls_x509_crt_set_subject_alt_name(certificate, GNUTLS_SAN_IPADDRESS, &v6,
                                                    sizeof v6, GNUTLS_FSAN_APPEND);
    }
    return gnutls_x509_crt_set_subject_alt_name(certificate, GNUTLS_SAN_DNSNAME, host,
                                                (unsigned)strlen(host), GNUTLS_FSAN_APPEND);
}

static int sign(const struct hub_ca *ca, const struct wanted *wanted, gnutls_x509_privkey_t key,
                gnutls_x509_crt_t certificate)
{
    const bool is_client = is_client_use(wanted->use);
    const int64_t ends_s = wanted->now_s + HUB_PAIR_DAYS * INT64_C(86400);
    const char *name = wanted->use == HUB_PAIR_CLIENT ? HUB_PAIR_CLIENT_NAME
                       : wanted->use == HUB_PAIR_HOME ? HUB_PAIR_HOME_NAME
                       : wanted->n > 0                ? wanted->hosts[0]
                                                      : "isotherm-hub";
    uint8_t serial[HUB_CA_SERIAL_BYTES];
    char cut[64]; /* the longest common name; the whole name is an alternative name */
    (void)snprintf(cut, sizeof cut, "%s", name);
    int r = hub__describe(certificate, cut, ends_s < ca->ends_s ? ends_s : ca->ends_s, serial);

    for (size_t i = 0; r >= 0 && !is_client && i < wanted->n; i++) {
        r = add_host(certificate, wanted->hosts[i]);
    }
    r = r < 0 ? r : gnutls_x509_crt_set_key(certificate, key);
    r = r < 0
            ? r
            : gnutls_x509_crt_set_key_purpose_oid(
                  certificate, is_client ? GNUTLS_KP_TLS_WWW_CLIENT : GNUTLS_KP_TLS_WWW_SERVER, 0);
    return r < 0 ? r : hub__sign(ca, certificate);
}

/* The certificate and that of the authority: a door knows only the digest of the latter. */
static int store_chain(const struct hub_ca *ca, gnutls_x509_crt_t certificate, const char *path,
                       struct iso_fault *fault)
{
    char *pem = NULL;
    int r = hub__pem_of(certificate, &pem);

    if (r < 0) {
        return hub__tls_fault(path, r, fault);
    }
    const size_t n = strlen(pem), m = strlen(ca->pem);
    char *chain = malloc(n + m);
    if (!chain) {
        free(pem);
        return iso_fault_set(fault, -ENOMEM, "out of memory for %s", path);
    }
    (void)iso_put_bytes(iso_put_bytes((uint8_t *)chain, pem, n), ca->pem, m); /* without a NUL */
    r = hub__text_store(path, chain, n + m, fault);
    free(chain);
    free(pem);
    return r;
}

static int make(const struct hub_ca *ca, const struct wanted *wanted, const char *key_path,
                const char *path, struct iso_fault *fault)
{
    gnutls_x509_privkey_t key = NULL;
    gnutls_x509_crt_t certificate = NULL;
    int r = hub__key_make(&key);

    r = r < 0 ? r : gnutls_x509_crt_init(&certificate);
    r = r < 0 ? r : sign(ca, wanted, key, certificate);
    r = r < 0 ? hub__tls_fault(path, r, fault) : hub__key_store(key_path, key, fault);
    r = r < 0 ? r : store_chain(ca, certificate, path, fault);
    gnutls_x509_crt_deinit(certificate);
    gnutls_x509_privkey_deinit(key);
    return r;
}

/* ---- judging ---- */

static bool has_key(gnutls_x509_crt_t certificate, const char *pem)
{
    const gnutls_datum_t text = {(unsigned char *)(uintptr_t)pem, (unsigned)strlen(pem)};
    uint8_t a[32], b[32];
    size_t n = sizeof a, m = sizeof b;
    gnutls_x509_privkey_t key = NULL;
    int r = gnutls_x509_privkey_init(&key);

    r = r < 0 ? r : gnutls_x509_privkey_import(key, &text, GNUTLS_X509_FMT_PEM);
    r = r < 0 ? r : gnutls_x509_privkey_get_key_id(key, GNUTLS_KEYID_USE_SHA256, a, &n);
    r = r < 0 ? r : gnutls_x509_crt_get_key_id(certificate, GNUTLS_KEYID_USE_SHA256, b, &m);
    gnutls_x509_privkey_deinit(key);
    return r >= 0 && n == m && memcmp(a, b, n) == 0;
}

static bool is_good(const struct hub_ca *ca, const struct wanted *wanted, struct hub_pair *pair)
{
    const gnutls_datum_t pem = {(unsigned char *)pair->chain, (unsigned)strlen(pair->chain)};
    gnutls_x509_crt_t certificate = NULL;
    unsigned status = ~0U;
    int r = gnutls_x509_crt_init(&certificate);

    r = r < 0 ? r : gnutls_x509_crt_import(certificate, &pem, GNUTLS_X509_FMT_PEM);
    r = r < 0 ? r
              : gnutls_x509_crt_verify(certificate, &ca->certificate, 1,
                                       GNUTLS_VERIFY_DISABLE_TIME_CHECKS, &status);
    bool good = r >= 0 && status == 0 && has_key(certificate, pair->key);
    if (good) {
        pair->ends_s = gnutls_x509_crt_get_expiration_time(certificate);
        good = pair->ends_s - wanted->now_s > HUB_PAIR_RENEW_DAYS * INT64_C(86400);
    }
    for (size_t i = 0; good && !is_client_use(wanted->use) && i < wanted->n; i++) {
        good = gnutls_x509_crt_check_hostname(certificate, wanted->hosts[i]) != 0;
    }
    gnutls_x509_crt_deinit(certificate);
    return good;
}

static int read_pair(const char *key_path, const char *path, struct hub_pair *pair,
                     struct iso_fault *fault)
{
    size_t size = 0;
    const int r = iso_file_read(path, HUB_PEM_MOST, &pair->chain, &size, fault);

    return r < 0 ? r : iso_file_read(key_path, HUB_PEM_MOST, &pair->key, &size, fault);
}

/* Reads the pair, and makes a new one if it is missing or no longer good. */
static int read_or_make(const struct hub_ca *ca, const struct wanted *wanted, const char *key_path,
                        const char *path, struct hub_pair *pair, struct iso_fault *fault)
{
    int r = read_pair(key_path, path, pair, fault);
    if (r != -ENOENT && (r < 0 || is_good(ca, wanted, pair))) {
        return r;
    }
    hub_pair_free(pair);
    pair->is_new = true;
    r = make(ca, wanted, key_path, path, fault);
    r = r < 0 ? r : read_pair(key_path, path, pair, fault);
    pair->ends_s = 0;
    return r == 0 && !is_good(ca, wanted, pair) && pair->ends_s == 0
               ? iso_fault_set(fault, -EBADMSG, "%s: cannot be read back", path)
               : r;
}

/* Locks the folder against other hubs that use it, until the descriptor is closed. */
static int lock_folder(const char *folder, int *fd, struct iso_fault *fault)
{
    *fd = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (*fd < 0 || flock(*fd, LOCK_EX)) {
        return iso_file_fault(folder, -errno, fault);
    }
    return 0;
}

int hub_pair_open(const struct hub_ca *ca, const char *folder, enum hub_pair_use use,
                  const char *const *hosts, size_t n, int64_t now_s, struct hub_pair *out,
                  struct iso_fault *fault)
{
    const struct wanted wanted = {.use = use, .hosts = hosts, .n = n, .now_s = now_s};
    struct hub_pair pair = {.key = NULL};
    char key_path[PATH_MAX], path[PATH_MAX];
    int lock = -1;
    if (n > HUB_PAIR_HOSTS_MOST) {
        return iso_fault_set(fault, -EINVAL, "%s: more than %d names", names[use].chain,
                             HUB_PAIR_HOSTS_MOST);
    }
    int r = hub__path(key_path, sizeof key_path, folder, names[use].key, fault);
    r = r < 0 ? r : hub__path(path, sizeof path, folder, names[use].chain, fault);
    r = r < 0 ? r : lock_folder(folder, &lock, fault);
    r = r < 0 ? r : read_or_make(ca, &wanted, key_path, path, &pair, fault);
    if (lock >= 0) {
        (void)close(lock);
    }
    if (r < 0) {
        hub_pair_free(&pair);
        return r;
    }
    *out = pair;
    return 0;
}

void hub_pair_free(struct hub_pair *pair)
{
    if (pair->key) {
        sodium_memzero(pair->key, strlen(pair->key));
    }
    free(pair->key);
    free(pair->chain);
    *pair = (struct hub_pair){.key = NULL};
}
