#include "enroll/web/listener.h"

#include <arpa/inet.h>
#include <errno.h>
#include <netinet/in.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <systemd/sd-daemon.h>
#include <unistd.h>

enum { WAITING_MOST = 64 };

/* The port of a text; 0: it is none. */
static uint16_t port_of(const char *text)
{
    char *end = NULL;

    if (strspn(text, "0123456789") != strlen(text)) {
        return 0;
    }
    const unsigned long port = strtoul(text, &end, 10);
    return port <= UINT16_MAX ? (uint16_t)port : 0;
}

/* Returns the size of the address; 0: the text is none. */
static socklen_t read_address(const char *text, struct sockaddr_storage *out)
{
    struct sockaddr_in *v4 = (struct sockaddr_in *)out;
    struct sockaddr_in6 *v6 = (struct sockaddr_in6 *)out;
    const char *colon = strrchr(text, ':');
    char host[INET6_ADDRSTRLEN + 2];

    *out = (struct sockaddr_storage){0};
    if (!colon || (size_t)(colon - text) >= sizeof host || port_of(colon + 1) == 0) {
        return 0;
    }
    const size_t n = (size_t)(colon - text);
    memcpy(host, text, n);
    host[n] = '\0';
    if (n > 2 && host[0] == '[' && host[n - 1] == ']') {
        host[n - 1] = '\0';
        v6->sin6_family = AF_INET6;
        v6->sin6_port = htons(port_of(colon + 1));
        return inet_pton(AF_INET6, host + 1, &v6->sin6_addr) == 1 ? sizeof *v6 : 0;
    }
    v4->sin_family = AF_INET;
    v4->sin_port = htons(port_of(colon + 1));
    return inet_pton(AF_INET, host, &v4->sin_addr) == 1 ? sizeof *v4 : 0;
}

static int open_listener(const char *text, int *out, struct iso_fault *fault)
{
    struct sockaddr_storage address;
    const socklen_t size = read_address(text, &address);
    const int yes = 1;

    if (size == 0) {
        return iso_fault_set(fault, -EINVAL,
                             "--listen %s: must be an address and a port, such as 127.0.0.1:8443 "
                             "or [::]:8443",
                             text);
    }
    const int fd = socket(address.ss_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (fd < 0 || setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes) ||
        bind(fd, (const struct sockaddr *)&address, size) || listen(fd, WAITING_MOST)) {
        const int error = -errno;
        if (fd >= 0) {
            (void)close(fd);
        }
        return iso_fault_set(fault, error, "--listen %s: %s", text, strerror(-error));
    }
    *out = fd;
    return 0;
}

int web_listener_open(const char *address, int *fd, struct iso_fault *fault)
{
    const int n = sd_listen_fds(1);

    if (n < 0) {
        return iso_fault_set(fault, n, "the sockets of the service manager: %s", strerror(-n));
    }
    if (n == 0) {
        return open_listener(address, fd, fault);
    }
    if (n > 1 || sd_is_socket(SD_LISTEN_FDS_START, AF_UNSPEC, SOCK_STREAM, 1) <= 0) {
        return iso_fault_set(fault, -EINVAL,
                             "the service manager has to pass one listening stream socket");
    }
    *fd = SD_LISTEN_FDS_START;
    return 0;
}
