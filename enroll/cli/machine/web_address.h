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

/* Adds the addresses of a socket, which systemd describes by a line such as "[::]:8443 (Stream)".
 * If the socket listens on every address, these are the name of this machine and then its
 * addresses, without those of the loop-back interface. Otherwise it is the address of the socket. A
 * line of another form adds nothing. */
void cli_web_addresses_add(struct cli_web_addresses *addresses, const char *listen);

/* Finds where the web server listens. It asks systemd by the program `systemctl`. If systemd does
 * not answer or does not know the socket, the port is CLI_WEB_PORT. The result has at least one
 * address. */
void cli_web_addresses_find(const char *systemctl, struct cli_web_addresses *out);

#endif
