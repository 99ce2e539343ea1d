/* The address of an outlet, in its parts. Internal to the outlets. */
#ifndef ISO_ENROLL_HUB_OUTLET_ADDRESS_H
#define ISO_ENROLL_HUB_OUTLET_ADDRESS_H

#include <stdint.h>

#include "enroll/hub/outlet/hub_outlet.h"

enum hub__scheme {
    HUB__HTTPS,
    HUB__HTTP, /* of localhost alone */
    HUB__TLS,
    HUB__TCP,
    HUB__UDP,
    HUB__LOCAL,
};

struct hub__address {
    enum hub__scheme scheme;
    char host[256];   /* an IPv6 address without its brackets; "" with HUB__LOCAL */
    uint16_t port;    /* without one in the text: 6514 of TLS, 601 of TCP, 514 of UDP */
    const char *path; /* HUB__LOCAL: of the socket, in the text that was read */
};

/* Reads an address. -EINVAL it is none of this kind, contains a password, or would send events in
 * plain text to another machine by HTTP. */
int hub__address_read(enum hub_outlet_kind kind, const char *text, struct hub__address *out,
                      struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
