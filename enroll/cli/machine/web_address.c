#include "enroll/cli/machine/web_address.h"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <limits.h>
#include <net/if.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "enroll/cli/machine/child.h"

static void add(struct cli_web_addresses *addresses, const char *host, long port)
{
    if (addresses->n < CLI_WEB_ADDRESSES_MOST) {
        (void)snprintf(addresses->urls[addresses->n++], CLI_WEB_ADDRESS_SIZE, "https://%.100s:%ld/",
                       host, port);
    }
}

/* Writes an address that other machines can use as the host of a URL. Returns false for others. */
static bool host_of(const struct sockaddr *address, char *host, size_t size)
{
    char text[INET6_ADDRSTRLEN];

    if (address->sa_family == AF_INET) {
        const struct sockaddr_in *v4 = (const struct sockaddr_in *)(const void *)address;
        return inet_ntop(AF_INET, &v4->sin_addr, host, (socklen_t)size) != NULL;
    }
    if (address->sa_family != AF_INET6) {
        return false;
    }
    const struct sockaddr_in6 *v6 = (const struct sockaddr_in6 *)(const void *)address;
    if (IN6_IS_ADDR_LINKLOCAL(&v6->sin6_addr) ||
        !inet_ntop(AF_INET6, &v6->sin6_addr, text, sizeof text)) {
        return false;
    }
    (void)snprintf(host, size, "[%s]", text);
    return true;
}

/* The name of this machine and its addresses. */
static void add_machine(struct cli_web_addresses *addresses, long port)
{
    char name[HOST_NAME_MAX + 1] = "localhost", host[INET6_ADDRSTRLEN + 2];
    struct ifaddrs *interfaces = NULL;

    (void)gethostname(name, sizeof name - 1);
    add(addresses, name, port);
    if (getifaddrs(&interfaces)) {
        return;
    }
    for (const struct ifaddrs *i = interfaces; i; i = i->ifa_next) {
        if (i->ifa_addr && (i->ifa_flags & IFF_UP) && !(i->ifa_flags & IFF_LOOPBACK) &&
            host_of(i->ifa_addr, host, sizeof host)) {
            add(addresses, host, port);
        }
    }
    freeifaddrs(interfaces);
}

void cli_web_addresses_add(struct cli_web_addresses *addresses, const char *listen)
{
    char host[CLI_WEB_ADDRESS_SIZE], *end = NULL;
    const size_t length = strcspn(listen, " \n");

    (void)snprintf(host, sizeof host, "%.*s", (int)length, listen);
    char *colon = strrchr(host, ':');
    if (!colon || colon == host || length >= sizeof host) {
        return;
    }
    *colon = '\0';
    const long port = strtol(colon + 1, &end, 10);
    if (end == colon + 1 || *end || port < 1 || port > 65535) {
        return;
    }
    if (strcmp(host, "[::]") == 0 || strcmp(host, "0.0.0.0") == 0) {
        add_machine(addresses, port);
    } else {
        add(addresses, host, port);
    }
}

void cli_web_addresses_find(const char *systemctl, struct cli_web_addresses *out)
{
    const char *const argv[] = {
        systemctl, "show", "--property", "Listen", "--value", "isotherm-web.socket", NULL};
    struct cli_child child = {0};
    struct cli_fault fault = {0};

    *out = (struct cli_web_addresses){.n = 0};
    if (!cli_child_run(argv, &child, &fault) && child.exit == 0) {
        for (const char *line = child.out; line && *line; line = strchr(line, '\n')) {
            line += *line == '\n';
            cli_web_addresses_add(out, line);
        }
    }
    cli_child_done(&child);
    if (out->n == 0) {
        add_machine(out, CLI_WEB_PORT);
    }
}
