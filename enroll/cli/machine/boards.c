#include "enroll/cli/machine/boards.h"

#include <dirent.h>
#include <jansson.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "enroll/cli/machine/text_file.h"

static bool begins_with_one_of(const char *text, const json_t *beginnings)
{
    for (size_t i = 0; i < json_array_size(beginnings); i++) {
        const char *beginning = json_string_value(json_array_get(beginnings, i));
        if (beginning && *beginning && strncmp(text, beginning, strlen(beginning)) == 0) {
            return true;
        }
    }
    return false;
}

/* Whether the first line of one of these files in /sys begins with one of the texts. */
static bool is_in_file(const struct cli_setup_places *places, const char *const *files, size_t n,
                       const json_t *beginnings)
{
    char path[PATH_MAX], line[128];

    for (size_t i = 0; i < n; i++) {
        (void)snprintf(path, sizeof path, "%s/%s", places->sys, files[i]);
        cli_text_file_line(path, line, sizeof line);
        if (begins_with_one_of(line, beginnings)) {
            return true;
        }
    }
    return false;
}

static bool is_plugged_in(const struct cli_setup_places *places, const json_t *ids)
{
    static const char devices_folder[] = "bus/usb/devices";
    char path[PATH_MAX + 300], vendor[8], product[8], id[16];
    const struct dirent *entry;
    bool found = false;

    (void)snprintf(path, sizeof path, "%s/%s", places->sys, devices_folder);
    DIR *devices = opendir(path);
    while (devices && !found && (entry = readdir(devices))) {
        (void)snprintf(path, sizeof path, "%s/%s/%s/idVendor", places->sys, devices_folder,
                       entry->d_name);
        cli_text_file_line(path, vendor, sizeof vendor);
        (void)snprintf(path, sizeof path, "%s/%s/%s/idProduct", places->sys, devices_folder,
                       entry->d_name);
        cli_text_file_line(path, product, sizeof product);
        (void)snprintf(id, sizeof id, "%s:%s", vendor, product);
        found = begins_with_one_of(id, ids);
    }
    if (devices) {
        closedir(devices);
    }
    return found;
}

static bool is_here(const struct cli_setup_places *places, const json_t *recognise)
{
    static const char *const tree[] = {"firmware/devicetree/base/model"};
    static const char *const dmi[] = {"class/dmi/id/sys_vendor", "class/dmi/id/product_name"};

    return is_in_file(places, tree, 1, json_object_get(recognise, "device-tree")) ||
           is_in_file(places, dmi, 2, json_object_get(recognise, "dmi")) ||
           is_plugged_in(places, json_object_get(recognise, "usb"));
}

static void describe(const struct cli_setup_places *places, struct cli_board *board)
{
    char path[PATH_MAX];

    (void)snprintf(path, sizeof path, "%s/%s/board.json", places->boards, board->name);
    char *text = cli_text_file_read(path, NULL);
    json_t *description = text ? json_loads(text, 0, NULL) : NULL;
    free(text);
    const char *title = json_string_value(json_object_get(description, "title"));
    (void)snprintf(board->title, sizeof board->title, "%s", title ? title : "");
    board->here = is_here(places, json_object_get(description, "recognise"));
    json_decref(description);
}

static void take(const struct cli_setup_places *places, const char *name, struct cli_boards *out)
{
    char path[PATH_MAX];
    const int length = snprintf(path, sizeof path, "%s/%s/isotherm.conf", places->boards, name);
    const bool fits = length > 0 && (size_t)length < sizeof path &&
                      strlen(name) < sizeof out->items[0].name && out->n < CLI_BOARDS_MAX;

    if (fits && name[0] != '.' && access(path, R_OK) == 0) {
        struct cli_board *board = &out->items[out->n++];
        (void)snprintf(board->name, sizeof board->name, "%s", name);
        describe(places, board);
    }
}

enum cli_exit cli_boards_find(const struct cli_setup_places *places, struct cli_boards *out,
                              struct cli_fault *fault)
{
    struct dirent **entries = NULL;
    const int n = scandir(places->boards, &entries, NULL, alphasort);

    *out = (struct cli_boards){0};
    for (int i = 0; i < n; i++) {
        take(places, entries[i]->d_name, out);
        free(entries[i]);
    }
    free(entries);
    return out->n > 0 ? CLI_EXIT_OK
                      : cli_fault_set(fault, CLI_EXIT_NOT_FOUND, "no-board",
                                      "%s: there is no board in this folder; install a package "
                                      "isotherm-board-NAME",
                                      places->boards);
}

const struct cli_board *cli_boards_get(const struct cli_boards *boards, const char *name)
{
    for (size_t i = 0; i < boards->n; i++) {
        if (strcmp(boards->items[i].name, name) == 0) {
            return &boards->items[i];
        }
    }
    return NULL;
}
