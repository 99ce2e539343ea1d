/* The certificates of doors, and the list of those that are not accepted any more. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "enroll/hub/broker/ca_inner.h"

/* Takes the key of a request that was signed by the same key. Nothing else of it is used. The
 * caller frees *out. */
static int read_key(const char *csr, size_t size, gnutls_pubkey_t *out,
                    uint8_t digest[HUB_CA_DIGEST_BYTES], struct iso_fault *fault)
{
    size_t digest_size = HUB_CA_DIGEST_BYTES;
    const gnutls_datum_t pem = {(unsigned char *)(uintptr_t)csr, (unsigned)size};
    gnutls_ecc_curve_t curve = GNUTLS_ECC_CURVE_INVALID;
    gnutls_x509_crq_t request = NULL;
    gnutls_pubkey_t key = NULL;

    if (size == 0 || size > HUB_CSR_MOST) {
        return iso_fault_set(fault, -EBADMSG, "the certificate request is empty or too long");
    }
    int r = gnutls_x509_crq_init(&request);
    r = r < 0 ? r : gnutls_x509_crq_import(request, &pem, GNUTLS_X509_FMT_PEM);
    r = r < 0 ? r : gnutls_x509_crq_verify(request, 0);
    r = r < 0 ? r : gnutls_pubkey_init(&key);
    r = r < 0 ? r : gnutls_pubkey_import_x509_crq(key, request, 0);
    r = r < 0 ? r : gnutls_pubkey_get_key_id(key, GNUTLS_KEYID_USE_SHA256, digest, &digest_size);
    gnutls_x509_crq_deinit(request);
    if (r < 0) {
        gnutls_pubkey_deinit(key);
        return hub__tls_fault("the certificate request", r, fault);
    }
    if (gnutls_pubkey_get_pk_algorithm(key, NULL) != GNUTLS_PK_ECDSA ||
        gnutls_pubkey_export_ecc_raw2(key, &curve, NULL, NULL, 0) < 0 ||
        curve != GNUTLS_ECC_CURVE_SECP256R1) {
        gnutls_pubkey_deinit(key);
        return iso_fault_set(fault, -EKEYREJECTED,
                             "the certificate request: its key is not ECDSA on P-256");
    }
    *out = key;
    return 0;
}

static int sign(const struct hub_ca *ca, gnutls_pubkey_t key, const char *name,
                struct hub_door_certificate *made)
{
    gnutls_x509_crt_t certificate = NULL;
    int r = gnutls_x509_crt_init(&certificate);

    r = r < 0 ? r : hub__describe(certificate, name, made->ends_s, made->serial);
    r = r < 0 ? r : gnutls_x509_crt_set_pubkey(certificate, key);
    r = r < 0 ? r : gnutls_x509_crt_set_key_purpose_oid(certificate, GNUTLS_KP_TLS_WWW_CLIENT, 0);
    r = r < 0 ? r : hub__sign(ca, certificate);
    r = r < 0 ? r : hub__pem_of(certificate, &made->pem);
    gnutls_x509_crt_deinit(certificate);
    return r;
}

int hub_ca_sign_door(const struct hub_ca *ca, const char *csr, size_t size,
                     const struct iso_fleet_id *door, int64_t now_s,
                     struct hub_door_certificate *out, struct iso_fault *fault)
{
    const int64_t ends_s = now_s + HUB_DOOR_DAYS * INT64_C(86400);
    struct hub_door_certificate made = {.ends_s = ends_s < ca->ends_s ? ends_s : ca->ends_s};
    char name[ISO_FLEET_ID_TEXT_SIZE];
    gnutls_pubkey_t key = NULL;
    int r = read_key(csr, size, &key, made.key, fault);

    if (r < 0) {
        return r;
    }
    r = sign(ca, key, iso_fleet_id_text(door, name), &made);
    gnutls_pubkey_deinit(key);
    if (r < 0) {
        return hub__tls_fault("the certificate of the door", r, fault);
    }
    *out = made;
    return 0;
}

int hub_ca_check_request(const char *csr, size_t size, uint8_t key[HUB_CA_DIGEST_BYTES],
                         struct iso_fault *fault)
{
    uint8_t digest[HUB_CA_DIGEST_BYTES];
    gnutls_pubkey_t read = NULL;
    const int r = read_key(csr, size, &read, digest, fault);

    if (r == 0) {
        gnutls_pubkey_deinit(read);
        memcpy(key, digest, sizeof digest);
    }
    return r;
}

/* The number of a list rises, so that a broker takes the newer one. */
static int describe_list(const struct hub_ca *ca, gnutls_x509_crl_t list, int64_t now_s)
{
    uint8_t id[64], number[8];
    size_t size = sizeof id;
    int r = gnutls_x509_crl_set_version(list, 2);

    for (int i = 0; i < 8; i++) {
        number[i] = (uint8_t)((uint64_t)now_s >> (56 - 8 * i));
    }
    r = r < 0 ? r : gnutls_x509_crl_set_this_update(list, (time_t)now_s);
    r = r < 0 ? r : gnutls_x509_crl_set_next_update(list, (time_t)ca->ends_s);
    r = r < 0 ? r : gnutls_x509_crl_set_number(list, number, sizeof number);
    r = r < 0 ? r : gnutls_x509_crt_get_subject_key_id(ca->certificate, id, &size, NULL);
    return r < 0 ? r : gnutls_x509_crl_set_authority_key_id(list, id, size);
}

int hub_ca_revoke(const struct hub_ca *ca, const uint8_t (*serials)[HUB_CA_SERIAL_BYTES], size_t n,
                  int64_t now_s, char **pem, struct iso_fault *fault)
{
    gnutls_x509_crl_t list = NULL;
    gnutls_datum_t text = {NULL, 0};
    int r = gnutls_x509_crl_init(&list);

    r = r < 0 ? r : describe_list(ca, list, now_s);
    for (size_t i = 0; r >= 0 && i < n; i++) {
        r = gnutls_x509_crl_set_crt_serial(list, serials[i], HUB_CA_SERIAL_BYTES, (time_t)now_s);
    }
    r = r < 0 ? r : gnutls_x509_crl_sign2(list, ca->certificate, ca->key, GNUTLS_DIG_SHA256, 0);
    r = r < 0 ? r : gnutls_x509_crl_export2(list, GNUTLS_X509_FMT_PEM, &text);
    gnutls_x509_crl_deinit(list);
    char *copy = r < 0 ? NULL : strndup((const char *)text.data, text.size);
    gnutls_free(text.data);
    if (!copy) {
        return r < 0 ? hub__tls_fault("the list of revoked certificates", r, fault)
                     : iso_fault_set(fault, -ENOMEM, "out of memory");
    }
    *pem = copy;
    return 0;
}
