/* The address with which an appliance joins, as text and as a picture.
 *
 *   isotherm://HOST:PORT/?ca=<SHA-256 of the authority's certificate>&code=<the one-time code> */
#ifndef HUB_API_HUB_JOIN_ADDRESS_H
#define HUB_API_HUB_JOIN_ADDRESS_H

#include <stdint.h>

enum { HUB_JOIN_ADDRESS_SIZE = 512 };

/* `host` is a name, an IPv4 address, or an IPv6 address without brackets. -ENAMETOOLONG. */
int hub_join_address(const char *host, uint16_t port, const uint8_t ca_digest[32], const char *code,
                     char out[HUB_JOIN_ADDRESS_SIZE]) __attribute__((warn_unused_result));

/* A QR code of a text as an SVG picture with black modules on white, four modules of border around.
 * The caller frees it with free(). NULL: the text is too long, or there is no memory. */
char *hub_qr_svg(const char *text);

#endif
