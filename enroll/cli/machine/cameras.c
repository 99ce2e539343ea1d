#include "enroll/cli/machine/cameras.h"

#include <dirent.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/cli/machine/text_file.h"

static const struct {
    const char *usb_id, *name;
} known[] = {
    {"8086:0b07", "d435"},
    {"8086:0b3a", "d435i"},
    {"8086:0b5c", "d455"},
};

static bool is_description(const char *name)
{
    const size_t length = strlen(name);

    return name[0] != '.' && length > 4 && strcmp(name + length - 4, ".ini") == 0;
}

void cli_cameras_list(const struct cli_setup_places *places, struct cli_cameras *out)
{
    struct dirent **entries = NULL;
    const int n = scandir(places->cameras, &entries, NULL, alphasort);

    *out = (struct cli_cameras){0};
    for (int i = 0; i < n; i++) {
        char path[PATH_MAX];
        const int length = snprintf(path, sizeof path, "%s/%s", places->cameras,
                                    entries[i]->d_name);
        if (is_description(entries[i]->d_name) && out->n < CLI_CAMERAS_MAX && length > 0 &&
            length < CLI_DEVICE_PATH_SIZE) {
            memcpy(out->paths[out->n++], path, (size_t)length + 1);
        }
        free(entries[i]);
    }
    free(entries);
}

static bool names_id(const char *path, const char *usb_id)
{
    char *text = cli_text_file_read(path, NULL);
    const bool found = text && strcasestr(text, usb_id);

    free(text);
    return found;
}

/* Whether the name of the file is NAME.ini, in upper or lower case. */
static bool is_called(const char *path, const char *name)
{
    const char *base = strrchr(path, '/') + 1;

    return strlen(base) == strlen(name) + 4 && strncasecmp(base, name, strlen(name)) == 0;
}

const char *cli_cameras_find(const struct cli_cameras *cameras, const char *usb_id)
{
    for (size_t i = 0; *usb_id && i < cameras->n; i++) {
        if (names_id(cameras->paths[i], usb_id)) {
            return cameras->paths[i];
        }
    }
    for (size_t k = 0; k < sizeof known / sizeof *known; k++) {
        for (size_t i = 0; i < cameras->n && strcmp(known[k].usb_id, usb_id) == 0; i++) {
            if (is_called(cameras->paths[i], known[k].name)) {
                return cameras->paths[i];
            }
        }
    }
    return NULL;
}
