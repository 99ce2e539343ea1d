/* The configuration file of a hub, /etc/isotherm-hub/hub.conf: isotherm-hub(8) describes it. */
#ifndef ISO_ENROLL_HUB_COMMAND_HUB_CONFIG_H
#define ISO_ENROLL_HUB_COMMAND_HUB_CONFIG_H

#include <stdbool.h>
#include <stdint.h>

#include "core/base/fault.h"

enum { HUB_CONFIG_TEXT_SIZE = 192 }; /* lines are not longer */

struct hub_config {
    /* [database] */
    char conninfo[HUB_CONFIG_TEXT_SIZE]; /* libpq's connection string */
    /* [hub] */
    char name[HUB_CONFIG_TEXT_SIZE];    /* for people */
    char folder[HUB_CONFIG_TEXT_SIZE];  /* keys, authority, certificates */
    char host[HUB_CONFIG_TEXT_SIZE];    /* where the doors reach the HTTPS server; the name of the
                                           machine */
    char listen[HUB_CONFIG_TEXT_SIZE];  /* ADDRESS:PORT */
    char hosts[HUB_CONFIG_TEXT_SIZE];   /* further names in the certificates, between blanks */
    char pages[HUB_CONFIG_TEXT_SIZE];   /* the folder of the pages; "": none */
    char metrics[HUB_CONFIG_TEXT_SIZE]; /* a file for node_exporter; "": none */
    int port;
    int keep_deltas, keep_events, keep_acts; /* days; 0: for ever */
    bool home_assistant;
    /* [broker] */
    char broker_host[HUB_CONFIG_TEXT_SIZE];        /* where the doors reach it; "": as host */
    char broker_hub_host[HUB_CONFIG_TEXT_SIZE];    /* where the hub reaches it */
    char broker_folder[HUB_CONFIG_TEXT_SIZE];      /* its configuration */
    char broker_persistence[HUB_CONFIG_TEXT_SIZE]; /* its own folder */
    int broker_port, broker_hub_port;
    /* Made of the folder. */
    char key_file[HUB_CONFIG_TEXT_SIZE + 16];
};

/* Where the file is if nobody names another one. */
#define HUB_CONFIG_PATH "/etc/isotherm-hub/hub.conf"

/* Reads the file. A file that may be missing is then as an empty one. -EBADMSG with a line for a
 * bad line, key or value; the errors of iso_file_open.
 */
int hub_config_read(const char *path, bool may_be_missing, struct hub_config *out,
                    struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
