#include "enroll/cli/machine/devices.h"

#include <dirent.h>
#include <jansson.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/cli/machine/child.h"
#include "enroll/cli/machine/text_file.h"

static const char *member(const json_t *line, const char *name)
{
    const char *text = json_string_value(json_object_get(line, name));

    return text ? text : "";
}

static void take(const json_t *line, struct cli_devices *out)
{
    const char *sensor = member(line, "sensor"), *id = member(line, "id");
    const char *fault = member(line, "fault");

    if (*fault) {
        (void)snprintf(out->fault, sizeof out->fault, "%s: %s", sensor, fault);
    } else if (*sensor && *id && strlen(id) < sizeof out->items[0].id &&
               strlen(sensor) < sizeof out->items[0].sensor && out->n < CLI_DEVICES_MAX) {
        struct cli_device *device = &out->items[out->n++];
        (void)snprintf(device->sensor, sizeof device->sensor, "%s", sensor);
        (void)snprintf(device->id, sizeof device->id, "%s", id);
        (void)snprintf(device->label, sizeof device->label, "%s", member(line, "label"));
        device->depth = strcmp(member(line, "kind"), "depth") == 0;
    }
}

void cli_devices_parse(const char *lines, struct cli_devices *out)
{
    for (const char *at = lines; *at; at += strcspn(at, "\n"), at += *at == '\n') {
        json_t *line = json_loadb(at, strcspn(at, "\n"), 0, NULL);
        if (line) {
            take(line, out);
        }
        json_decref(line);
    }
}

enum cli_exit cli_devices_find(const struct cli_setup_places *places, struct cli_devices *out,
                               struct cli_fault *fault)
{
    const char *const argv[] = {places->daemon, "--list-devices", NULL};
    struct cli_child child = {0};
    enum cli_exit exit = cli_child_run(argv, &child, fault);

    *out = (struct cli_devices){0};
    if (!exit && child.exit != 0) {
        exit = cli_fault_set(fault, CLI_EXIT_FAULT, "no-program",
                             "%s --list-devices ended with status %d", places->daemon, child.exit);
    }
    if (!exit) {
        cli_devices_parse(child.out, out);
    }
    cli_child_done(&child);
    return exit;
}

/* The files idVendor and idProduct belong to the USB device, but the node belongs to one of its
 * interfaces. */
void cli_device_usb_id(const struct cli_setup_places *places, const char *node, char out[16])
{
    char resolved[PATH_MAX], path[PATH_MAX + 64], vendor[8] = "", product[8] = "";

    out[0] = '\0';
    if (!realpath(node, resolved)) {
        return;
    }
    const char *name = strrchr(resolved, '/') + 1;
    for (int i = 0; i < 2; i++) {
        (void)snprintf(path, sizeof path, "%s/class/video4linux/%.64s/device/../%s", places->sys,
                       name, i ? "idProduct" : "idVendor");
        cli_text_file_line(path, i ? product : vendor, sizeof vendor);
    }
    if (*vendor && *product) {
        (void)snprintf(out, 16, "%.4s:%.4s", vendor, product);
    }
}

/* Finds the first link in this folder, by name, that leads to `resolved`. */
static bool find_link(const struct cli_setup_places *places, const char *folder,
                      const char *resolved, char out[CLI_DEVICE_PATH_SIZE])
{
    struct dirent **entries = NULL;
    char path[PATH_MAX], target[PATH_MAX];
    (void)snprintf(path, sizeof path, "%s/%s", places->dev, folder);
    const int n = scandir(path, &entries, NULL, alphasort);
    bool found = false;

    for (int i = 0; i < n; i++) {
        const int length = snprintf(path, sizeof path, "%s/%s/%s", places->dev, folder,
                                    entries[i]->d_name);
        if (!found && length > 0 && length < CLI_DEVICE_PATH_SIZE && realpath(path, target) &&
            strcmp(target, resolved) == 0) {
            memcpy(out, path, (size_t)length + 1);
            found = true;
        }
        free(entries[i]);
    }
    free(entries);
    return found;
}

void cli_device_lasting_name(const struct cli_setup_places *places, const char *node,
                             char out[CLI_DEVICE_PATH_SIZE])
{
    static const char *const folders[] = {"v4l/by-id", "v4l/by-path"};
    char resolved[PATH_MAX];

    (void)snprintf(out, CLI_DEVICE_PATH_SIZE, "%s", node);
    for (size_t i = 0; i < 2 && realpath(node, resolved); i++) {
        if (find_link(places, folders[i], resolved, out)) {
            return;
        }
    }
}
