#include "tests/enroll/hub/update/bundle_rig.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>

#include <cmocka.h>

#include <gnutls/abstract.h>
#include <gnutls/pkcs7.h>
#include <gnutls/x509.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

/* A key, and a certificate that it has signed itself. */
static void make_signer(gnutls_x509_privkey_t *key, gnutls_privkey_t *signer,
                        gnutls_x509_crt_t *certificate)
{
    assert_int_equal(gnutls_x509_privkey_init(key), 0);
    assert_int_equal(gnutls_x509_privkey_generate(*key, GNUTLS_PK_ECDSA,
                                                  GNUTLS_CURVE_TO_BITS(GNUTLS_ECC_CURVE_SECP256R1),
                                                  0),
                     0);
    assert_int_equal(gnutls_x509_crt_init(certificate), 0);
    assert_int_equal(gnutls_x509_crt_set_version(*certificate, 3), 0);
    assert_int_equal(gnutls_x509_crt_set_serial(*certificate, "\1", 1), 0);
    assert_int_equal(gnutls_x509_crt_set_activation_time(*certificate, time(NULL) - 60), 0);
    assert_int_equal(gnutls_x509_crt_set_expiration_time(*certificate, time(NULL) + 3600), 0);
    assert_int_equal(gnutls_x509_crt_set_dn(*certificate, "CN=updates", NULL), 0);
    assert_int_equal(gnutls_x509_crt_set_key(*certificate, *key), 0);
    assert_int_equal(gnutls_x509_crt_sign2(*certificate, *certificate, *key, GNUTLS_DIG_SHA256, 0),
                     0);
    assert_int_equal(gnutls_privkey_init(signer), 0);
    assert_int_equal(gnutls_privkey_import_x509(*signer, *key, 0), 0);
}

static gnutls_datum_t make_message(const char *manifest)
{
    const gnutls_datum_t text = {.data = (unsigned char *)(uintptr_t)manifest,
                                 .size = (unsigned)strlen(manifest)};
    gnutls_x509_privkey_t key;
    gnutls_privkey_t signer;
    gnutls_x509_crt_t certificate;
    gnutls_pkcs7_t cms;
    gnutls_datum_t out;
    make_signer(&key, &signer, &certificate);
    assert_int_equal(gnutls_pkcs7_init(&cms), 0);
    assert_int_equal(gnutls_pkcs7_sign(cms, certificate, signer, &text, NULL, NULL,
                                       GNUTLS_DIG_SHA256,
                                       GNUTLS_PKCS7_EMBED_DATA | GNUTLS_PKCS7_INCLUDE_CERT),
                     0);
    assert_int_equal(gnutls_pkcs7_export2(cms, GNUTLS_X509_FMT_DER, &out), 0);
    gnutls_pkcs7_deinit(cms);
    gnutls_privkey_deinit(signer);
    gnutls_x509_crt_deinit(certificate);
    gnutls_x509_privkey_deinit(key);
    return out;
}

void bundle_rig_write(const char *path, const char *manifest, size_t size, unsigned char fill)
{
    gnutls_datum_t message = make_message(manifest);
    FILE *file = fopen(path, "wb");
    unsigned char length[8];
    assert_non_null(file);
    for (size_t i = 0; i < size; i++) {
        assert_true(fputc((int)((i * 31 + (i >> 9) + fill) & 0xff), file) != EOF);
    }
    for (int i = 0; i < 8; i++) {
        length[i] = (unsigned char)((uint64_t)message.size >> (8 * (7 - i)));
    }
    assert_int_equal(fwrite(message.data, 1, message.size, file), message.size);
    assert_int_equal(fwrite(length, 1, sizeof length, file), sizeof length);
    assert_int_equal(fclose(file), 0);
    gnutls_free(message.data);
}

const char *bundle_rig_manifest(const char *version, const char *board)
{
    static char text[300];
    (void)snprintf(text, sizeof text,
                   "[update]\ncompatible=%s\nversion=%s\n\n[bundle]\nformat=verity\n\n"
                   "[image.root]\nfilename=root.img\n",
                   board, version);
    return text;
}
