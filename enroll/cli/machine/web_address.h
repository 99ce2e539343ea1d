/* Where a browser finds the pages of the web server: the port that systemd holds for it, on the
 * addresses of this machine. */
#ifndef CLI_MACHINE_WEB_ADDRESS_H
#define CLI_MACHINE_WEB_ADDRESS_H

#include <stddef.h>

enum {
    CLI_WEB_ADDRESSES_MOST = 8,
    CLI_WEB_ADDRESS_SIZE = 128,
    CLI_WEB_PORT = 8443, /* of isotherm-web.socket as it is delivered */
};

struct cli_web_addresses {
    size_t n;
    char urls[CLI_WEB_ADDRESSES_MOST][CLI_WEB_ADDRESS_SIZE]; /* "https://door:8443/" */
};

/* Adds the addresses for one line that systemd prints about a socket, such as "[::]:8443 (Stream)":
 * for a socket on every address those of this machine, its name first and without the loop-back
 * ones; otherwise that of the socket. A line of another form adds nothing. */
void cli_web_addresses_add(struct cli_web_addresses *addresses, const char *listen);

/* Asks systemd, by the program `systemctl`, where the web server listens. If systemd does not
 * answer or does not know the socket, the port is CLI_WEB_PORT. There is at least one address. */
void cli_web_addresses_find(const char *systemctl, struct cli_web_addresses *out);

#endif
