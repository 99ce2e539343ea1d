/* What a door of the check keeps for its link in its folder: ca.pem, door.pem, door-key.pem, and in
 * link.txt one line: host and port of the broker, and the address of the hub. fleet_check.sh writes
 * them when the door joins. */
#ifndef TESTS_FLEET_CHECK_FILES_H
#define TESTS_FLEET_CHECK_FILES_H

#include <limits.h>
#include <stdbool.h>
#include <stdint.h>

struct check_files {
    char broker_host[64], hub_url[128];
    uint16_t broker_port;
    char ca[PATH_MAX], certificate[PATH_MAX], key[PATH_MAX]; /* paths of PEM files */
};

/* Reads them from a folder. false: the door has not joined. */
bool check_files_read(const char *folder, struct check_files *out);

#endif
