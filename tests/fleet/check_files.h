/* What a door of the check keeps for its link: the files of the certificate, and where broker and
 * hub are. `isotherm-link join` writes the same for a real door. */
#ifndef TESTS_FLEET_CHECK_FILES_H
#define TESTS_FLEET_CHECK_FILES_H

#include <limits.h>
#include <stdbool.h>
#include <stdint.h>

struct check_files {
    char broker_host[256], hub_url[300];
    uint16_t broker_port;
    char ca[PATH_MAX], certificate[PATH_MAX], key[PATH_MAX]; /* paths of PEM files */
};

/* Reads them from a folder. false: the door has not joined. */
bool check_files_read(const char *folder, struct check_files *out);

#endif
