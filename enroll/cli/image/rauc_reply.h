/* What RAUC answers on the bus: its state and its slots. The package rauc-service describes the
 * interface in /usr/share/dbus-1/interfaces/de.pengutronix.rauc.Installer.xml. The command line
 * tool and the web server read the answers by these functions. */
#ifndef CLI_IMAGE_RAUC_REPLY_H
#define CLI_IMAGE_RAUC_REPLY_H

#include <stdbool.h>
#include <stddef.h>
#include <systemd/sd-bus.h>

#define CLI_RAUC           "de.pengutronix.rauc"
#define CLI_RAUC_PATH      "/"
#define CLI_RAUC_INTERFACE "de.pengutronix.rauc.Installer"

enum { CLI_SLOTS_MAX = 4 };

/* A place on the disk for one version of the image. */
struct cli_slot {
    char rauc_name[32]; /* as RAUC calls it, such as "root.0" */
    char name[16];      /* as the boot loader calls it, such as "a" */
    char version[64];   /* of the update that was installed into it last; "": there was none */
    bool running;       /* the machine runs from it */
    bool good;          /* the boot loader may start it */
    bool next;          /* the boot loader starts it next */
};

struct cli_slots {
    size_t n;
    struct cli_slot slots[CLI_SLOTS_MAX];
};

/* What RAUC says about itself. */
struct cli_installer_state {
    char operation[32]; /* "idle", "installing" */
    char board[64];     /* for which board updates have to be, such as "isotherm-pc-usb-amd64" */
    char error[192];    /* why the last update was not installed; "": it was, or there was none */
    int percent;        /* of the present operation, or of the last one */
};

/* Whether RAUC is at work. It then answers no question but that for its state. */
bool cli_rauc_is_busy(const struct cli_installer_state *state);

/* Takes over the properties of a message, a{sv}; the others stay. 0 or a negative errno. */
int cli_rauc_read_state(sd_bus_message *message, struct cli_installer_state *state)
    __attribute__((warn_unused_result));

/* Reads the answer of GetSlotStatus: the slots that the boot loader can start. No slot is `next`.
 * 0 or a negative errno. */
int cli_rauc_read_slots(sd_bus_message *reply, struct cli_slots *out)
    __attribute__((warn_unused_result));

/* Reads the answer of GetPrimary, and marks the slot that starts next; none if it cannot be read.
 */
void cli_rauc_read_primary(sd_bus_message *reply, struct cli_slots *slots);

#endif
