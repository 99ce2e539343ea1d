/* libcurl with an end: a transfer that is given up when a descriptor becomes readable. Internal to
 * the outlets. */
#ifndef ISO_ENROLL_HUB_OUTLET_CARRY_TRANSFER_H
#define ISO_ENROLL_HUB_OUTLET_CARRY_TRANSFER_H

#include <curl/curl.h>

#include "enroll/hub/outlet/carry/carrier.h"

struct hub__transfer {
    CURLM *multi;
    CURL *easy;
    int stop_fd, ca_fd; /* -1: none */
    char ca_path[32];   /* "": the certificates of the system */
    char error[CURL_ERROR_SIZE];
};

/* The caller ends it. -ENOMEM. `ca`: PEM, or NULL. */
int hub__transfer_begin(struct hub__transfer *transfer, const char *ca, int stop_fd,
                        struct iso_fault *fault) __attribute__((warn_unused_result));
/* A transfer of zeros, with -1 for the descriptors, is accepted. */
void hub__transfer_end(struct hub__transfer *transfer);

/* Sets what every transfer of an outlet has: no redirections, at least TLS 1.2, the receiver's name
 * and certificate are checked, HUB__CONNECT_MS for the connection, no signals. */
void hub__transfer_prepare(struct hub__transfer *transfer, const char *url);

/* Runs the transfer to its end. HUB__TAKEN: libcurl has no error. */
struct hub__delivery hub__transfer_run(struct hub__transfer *transfer);

#endif
