#include "enroll/web/published.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "drivers/file/data_file.h"

void web_published_write(const char *fingerprint)
{
    const char *folder = getenv("RUNTIME_DIRECTORY");
    struct iso_fault fault = {.text = ""};
    char path[PATH_MAX], line[128];

    if (!folder) {
        return;
    }
    (void)snprintf(path, sizeof path, "%s/fingerprint", folder);
    const int n = snprintf(line, sizeof line, "%s\n", fingerprint);
    if (iso_data_file_replace(path, line, (size_t)n, &fault)) {
        fprintf(stderr, "isotherm-web: %s\n", fault.text);
    } else if (chmod(path, 0644)) {
        fprintf(stderr, "isotherm-web: %s: %s\n", path, strerror(errno));
    }
}
