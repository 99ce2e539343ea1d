/* Certificates for tests: an authority, a server of 127.0.0.1 and clients, as the hub makes them.
 */
#ifndef TESTS_FLEET_LINK_CERTIFICATES_H
#define TESTS_FLEET_LINK_CERTIFICATES_H

#include <gnutls/x509.h>

struct authority {
    gnutls_x509_privkey_t key;
    gnutls_x509_crt_t certificate;
    char pem[4096];
    unsigned char digest[32]; /* SHA-256 of the certificate */
};

void authority_make(struct authority *authority);
void authority_free(struct authority *authority);

/* A key and a certificate for the server, whose chain ends with the authority; or for a client of
 * this name. */
void authority_server(const struct authority *authority, char key[4096], char chain[8192]);
void authority_client(const struct authority *authority, const char *name, char key[4096],
                      char certificate[4096]);

/* Signs a request for a client of this name. */
void authority_sign(const struct authority *authority, const char *csr, const char *name,
                    char certificate[4096]);

#endif
