/* The address with which a door joins, as a text and as a QR code. */
#include <errno.h>
#include <qrencode.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "enroll/hub/api/hub_join_address.h"
#include "enroll/hub/broker/hub_ca.h"
#include "enroll/hub/command/hub_command.h"

enum { MARGIN = 2 };

static bool is_dark(const QRcode *code, int x, int y)
{
    return x >= 0 && y >= 0 && x < code->width && y < code->width &&
           code->data[y * code->width + x] & 1;
}

/* Two rows of the code are one row of the terminal. The colours are set, so that the code is dark
 * on light on every terminal. */
static void print_code(const QRcode *code)
{
    for (int y = -MARGIN; y < code->width + MARGIN; y += 2) {
        fputs("\033[30;107m", stdout);
        for (int x = -MARGIN; x < code->width + MARGIN; x++) {
            const bool above = is_dark(code, x, y), below = is_dark(code, x, y + 1);
            fputs(above && below ? "\u2588" : above ? "\u2580" : below ? "\u2584" : " ", stdout);
        }
        puts("\033[0m");
    }
}

int hub_print_address(struct hub_run *run, const char *secret)
{
    char address[HUB_JOIN_ADDRESS_SIZE];
    struct hub_ca *ca = NULL;
    int error = hub_ca_open(run->config.folder, &ca, &run->fault);
    if (error) {
        return error;
    }
    error = hub_join_address(run->config.host, (uint16_t)run->config.port, hub_ca_digest(ca),
                             secret, address);
    hub_ca_free(ca);
    if (error) {
        return iso_fault_set(&run->fault, error, "%s: [hub] host is too long",
                             run->arguments.config);
    }
    puts(address);
    QRcode *code = isatty(STDOUT_FILENO) ? QRcode_encodeString8bit(address, 0, QR_ECLEVEL_L) : NULL;
    if (code) {
        print_code(code);
        QRcode_free(code);
    }
    sodium_memzero(address, sizeof address);
    return 0;
}
