/* The folder in which the link keeps what it got when the door joined:
 *
 *   link.json   {"door": UUID, "hub": "https://HOST:PORT", "broker": {"host", "port"}}; it is
 *               written last, so that the other files are there when it is
 *   door.key, door.crt   the key and the certificate of the door for the broker
 *   ca.crt               the authority of hub and broker
 *
 * The files belong to the owner of the folder, who runs the service; an administrator writes them.
 */
#ifndef ISO_FIRMWARE_FLEET_PROGRAM_HOME_H
#define ISO_FIRMWARE_FLEET_PROGRAM_HOME_H

#include <limits.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/base/fault.h"
#include "firmware/fleet/message/fleet_id.h"
#include "firmware/fleet/program/join_address.h"

#define LINK_HOME_CONF        "link.json"
#define LINK_HOME_KEY         "door.key"
#define LINK_HOME_CERTIFICATE "door.crt"
#define LINK_HOME_CA          "ca.crt"

struct link_home {
    struct iso_fleet_id door;
    char hub_url[LINK_URL_SIZE];
    char broker_host[LINK_HOST_SIZE];
    uint16_t broker_port;
};

/* FOLDER/NAME; -ENAMETOOLONG. */
int link_home_path(char path[PATH_MAX], const char *folder, const char *name,
                   struct iso_fault *fault) __attribute__((warn_unused_result));

/* Reads link.json. -ENOENT the door has not joined, -EBADMSG the file is damaged; errors of the
 * disk. */
int link_home_read(const char *folder, struct link_home *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));
int link_home_write(const char *folder, const struct link_home *home, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Reads a text of at most 64 KiB, which the caller frees; and replaces one. Errors of the disk. */
int link_home_read_text(const char *folder, const char *name, char **text, struct iso_fault *fault)
    __attribute__((warn_unused_result));
int link_home_write_text(const char *folder, const char *name, const char *text,
                         struct iso_fault *fault) __attribute__((warn_unused_result));

/* Removes link.json, and then the other files. */
void link_home_remove(const char *folder);

#endif
