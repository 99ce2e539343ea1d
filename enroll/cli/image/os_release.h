/* Which image of the appliance runs: the file os-release(5). */
#ifndef CLI_IMAGE_OS_RELEASE_H
#define CLI_IMAGE_OS_RELEASE_H

#include <stddef.h>

struct cli_os_release {
    char name[96];    /* PRETTY_NAME, such as "Debian GNU/Linux 12 (bookworm)" */
    char image[64];   /* IMAGE_ID, such as "isotherm-pc-usb"; "": this is no image */
    char version[64]; /* IMAGE_VERSION; "": this is no image */
};

/* Reads the file. A member is "" if the file does not have it or cannot be read. */
void cli_os_release_read(const char *path, struct cli_os_release *out);

/* The value of one key of such a file, KEY=VALUE or KEY="VALUE", cut to fit; "" likewise. */
void cli_os_release_value(const char *path, const char *key, char *out, size_t size);

#endif
