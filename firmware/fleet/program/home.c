#include "firmware/fleet/program/home.h"

#include <errno.h>
#include <jansson.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "drivers/file/data_file.h"
#include "drivers/file/file.h"

enum { TEXT_MOST_BYTES = 64 << 10 };

int link_home_path(char path[PATH_MAX], const char *folder, const char *name,
                   struct iso_fault *fault)
{
    if (snprintf(path, PATH_MAX, "%s/%s", folder, name) >= PATH_MAX) {
        return iso_fault_set(fault, -ENAMETOOLONG, "%.64s...: is too long", folder);
    }
    return 0;
}

int link_home_read_text(const char *folder, const char *name, char **text, struct iso_fault *fault)
{
    char path[PATH_MAX], *read = NULL;
    size_t size = 0;
    int r = link_home_path(path, folder, name, fault);

    r = r < 0 ? r : iso_file_read(path, TEXT_MOST_BYTES, &read, &size, fault);
    if (r < 0) {
        return r;
    }
    if (strlen(read) != size) {
        free(read);
        return iso_fault_set(fault, -EBADMSG, "%s: is no text", path);
    }
    *text = read;
    return 0;
}

/* An administrator writes the files as root; the service runs as the owner of the folder. */
static int give(const char *folder, const char *path, struct iso_fault *fault)
{
    struct stat owner;

    if (stat(folder, &owner)) {
        return iso_file_fault(folder, -errno, fault);
    }
    if (geteuid() == 0 && lchown(path, owner.st_uid, owner.st_gid)) {
        return iso_file_fault(path, -errno, fault);
    }
    return 0;
}

int link_home_write_text(const char *folder, const char *name, const char *text,
                         struct iso_fault *fault)
{
    char path[PATH_MAX];
    int r = link_home_path(path, folder, name, fault);

    r = r < 0 ? r : iso_data_file_replace(path, text, strlen(text), fault);
    return r < 0 ? r : give(folder, path, fault);
}

static bool copy_text(char *out, size_t size, const json_t *text)
{
    const char *value = json_string_value(text);

    if (!value || !value[0] || strlen(value) >= size) {
        return false;
    }
    memcpy(out, value, strlen(value) + 1);
    return true;
}

static bool read_object(const json_t *object, struct link_home *out)
{
    const json_t *broker = json_object_get(object, "broker");
    const char *door = json_string_value(json_object_get(object, "door"));
    const json_int_t port = json_integer_value(json_object_get(broker, "port"));

    out->broker_port = (uint16_t)port;
    return door && iso_fleet_id_read(door, &out->door) == 0 && port >= 1 && port <= 65535 &&
           copy_text(out->hub_url, sizeof out->hub_url, json_object_get(object, "hub")) &&
           copy_text(out->broker_host, sizeof out->broker_host, json_object_get(broker, "host"));
}

int link_home_read(const char *folder, struct link_home *out, struct iso_fault *fault)
{
    struct link_home read = {.hub_url = ""};
    char *text = NULL;
    const int r = link_home_read_text(folder, LINK_HOME_CONF, &text, fault);

    if (r < 0) {
        return r;
    }
    json_t *object = json_loads(text, JSON_REJECT_DUPLICATES, NULL);
    const bool is_good = json_is_object(object) && read_object(object, &read);
    json_decref(object);
    free(text);
    if (!is_good) {
        return iso_fault_set(fault, -EBADMSG, "%s/" LINK_HOME_CONF ": is damaged", folder);
    }
    *out = read;
    return 0;
}

int link_home_write(const char *folder, const struct link_home *home, struct iso_fault *fault)
{
    char door[ISO_FLEET_ID_TEXT_SIZE];
    json_t *object = json_pack("{s:s, s:s, s:{s:s, s:i}}", "door",
                               iso_fleet_id_text(&home->door, door), "hub", home->hub_url, "broker",
                               "host", home->broker_host, "port", (int)home->broker_port);
    char *text = object ? json_dumps(object, JSON_INDENT(2)) : NULL;
    const int r = text ? link_home_write_text(folder, LINK_HOME_CONF, text, fault)
                       : iso_fault_set(fault, -ENOMEM, "out of memory for " LINK_HOME_CONF);

    free(text);
    json_decref(object);
    return r;
}

void link_home_remove(const char *folder)
{
    static const char *const names[] = {LINK_HOME_CONF, LINK_HOME_KEY, LINK_HOME_CERTIFICATE,
                                        LINK_HOME_CA};
    char path[PATH_MAX];

    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        if (link_home_path(path, folder, names[i], NULL) == 0) {
            (void)unlink(path);
        }
    }
}
