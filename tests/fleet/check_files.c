#include "tests/fleet/check_files.h"

#include <stdio.h>

bool check_files_read(const char *folder, struct check_files *out)
{
    char path[PATH_MAX];
    (void)snprintf(path, sizeof path, "%s/link.txt", folder);
    FILE *in = fopen(path, "re");
    if (!in) {
        return false;
    }
    const int n = fscanf(in, "%63s %hu %127s", out->broker_host, &out->broker_port, out->hub_url);
    (void)fclose(in);
    (void)snprintf(out->ca, sizeof out->ca, "%s/ca.pem", folder);
    (void)snprintf(out->certificate, sizeof out->certificate, "%s/door.pem", folder);
    (void)snprintf(out->key, sizeof out->key, "%s/door-key.pem", folder);
    return n == 3;
}
