#include "enroll/hub/api/hub_join_address.h"

#include <errno.h>
#include <qrencode.h>
#include <sodium.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { BORDER = 4 };

int hub_join_address(const char *host, uint16_t port, const uint8_t ca_digest[32], const char *code,
                     char out[HUB_JOIN_ADDRESS_SIZE])
{
    char digest[65];
    const bool is_v6 = strchr(host, ':') != NULL;

    (void)sodium_bin2hex(digest, sizeof digest, ca_digest, 32);
    const int n = snprintf(out, HUB_JOIN_ADDRESS_SIZE, "isotherm://%s%s%s:%u/?ca=%s&code=%s",
                           is_v6 ? "[" : "", host, is_v6 ? "]" : "", port, digest, code);
    return n < HUB_JOIN_ADDRESS_SIZE ? 0 : -ENAMETOOLONG;
}

/* One path for all modules: a row of neighbours is one rectangle. */
static void write_row(FILE *out, const unsigned char *row, int width, int y)
{
    for (int x = 0; x < width;) {
        int n = 0;
        while (x + n < width && (row[x + n] & 1)) {
            n++;
        }
        if (n > 0) {
            fprintf(out, "M%d %dh%dv1h-%dz", x + BORDER, y + BORDER, n, n);
        }
        x += n > 0 ? n : 1;
    }
}

char *hub_qr_svg(const char *text)
{
    QRcode *code = QRcode_encodeString8bit(text, 0, QR_ECLEVEL_M);
    char *svg = NULL;
    size_t size = 0;
    FILE *out = code ? open_memstream(&svg, &size) : NULL;

    if (out) {
        const int whole = code->width + 2 * BORDER;
        fprintf(out,
                "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %d\" "
                "shape-rendering=\"crispEdges\"><path fill=\"#fff\" d=\"M0 0h%dv%dh-%dz\"/>"
                "<path fill=\"#000\" d=\"",
                whole, whole, whole, whole, whole);
        for (int y = 0; y < code->width; y++) {
            write_row(out, code->data + (size_t)y * (size_t)code->width, code->width, y);
        }
        fputs("\"/></svg>", out);
        if (fclose(out)) {
            free(svg);
            svg = NULL;
        }
    }
    QRcode_free(code);
    return svg;
}
