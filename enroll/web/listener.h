/* The socket on which the web server listens. */
#ifndef ENROLL_WEB_LISTENER_H
#define ENROLL_WEB_LISTENER_H

#include "core/base/fault.h"

/* Takes the socket that the service manager has passed, or opens one on "ADDRESS:PORT" if it has
 * passed none. An IPv6 address is in brackets: "[::1]:8443". The caller closes *fd. -EINVAL: the
 * text is no address and port, or what was passed is not one listening stream socket; or the errno
 * of bind() and others. With a fault. */
int web_listener_open(const char *address, int *fd, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
