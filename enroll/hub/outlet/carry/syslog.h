/* The carriers of syslog. Internal to the outlets.
 *
 * TLS (RFC 5425) and TCP (RFC 6587) count the bytes of each message. Neither protocol has an
 * answer: a batch counts as taken when the receiver's system has acknowledged all its bytes and the
 * connection is still there. What the receiver loses after that is lost. UDP (RFC 5426) and the
 * local socket have not even this: what was sent counts as taken. */
#ifndef ISO_ENROLL_HUB_OUTLET_CARRY_SYSLOG_H
#define ISO_ENROLL_HUB_OUTLET_CARRY_SYSLOG_H

#include "enroll/hub/outlet/address.h"
#include "enroll/hub/outlet/carry/transfer.h"

struct hub__syslog {
    struct hub__address address;
    bool connected; /* TLS, TCP */
    int fd;         /* UDP, local; -1: not open */
};

/* TLS and TCP: connects if it has to, sends, and waits for the acknowledgement. */
struct hub__delivery hub__syslog_stream(struct hub__syslog *syslog, struct hub__transfer *transfer,
                                        int64_t now_s, const struct hub__batch *batch);

/* UDP and local. The name of the host is looked up anew after each failure, which may take as long
 * as the system's resolver takes. */
struct hub__delivery hub__syslog_datagrams(struct hub__syslog *syslog, int64_t now_s,
                                           const struct hub__batch *batch);

#endif
