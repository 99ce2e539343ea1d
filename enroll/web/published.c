#include "enroll/web/published.h"

#include <errno.h>
#include <limits.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "drivers/file/data_file.h"

/* The path of a file for other programs; false: there is no folder for it. */
static bool path_of(const char *name, char path[PATH_MAX])
{
    const char *folder = getenv("RUNTIME_DIRECTORY");

    return folder && snprintf(path, PATH_MAX, "%s/%s", folder, name) < PATH_MAX;
}

/* Writes a line, and lets others read it by this mode. */
static void write_line(const char *path, const char *text, mode_t mode)
{
    struct iso_fault fault = {.text = ""};
    char line[128];
    const int n = snprintf(line, sizeof line, "%s\n", text);

    if (iso_data_file_replace(path, line, (size_t)n, &fault)) {
        fprintf(stderr, "isotherm-web: %s\n", fault.text);
    } else if (chmod(path, mode)) {
        fprintf(stderr, "isotherm-web: %s: %s\n", path, strerror(errno));
    }
}

void web_published_write(const char *fingerprint)
{
    char path[PATH_MAX];

    if (path_of("fingerprint", path)) {
        write_line(path, fingerprint, 0644);
    }
}

void web_published_write_code(const char *code)
{
    char path[PATH_MAX];

    if (path_of("setup-code", path)) {
        write_line(path, code, 0640);
    }
}

void web_published_remove_code(void)
{
    char path[PATH_MAX];

    if (path_of("setup-code", path)) {
        (void)unlink(path);
    }
}
