#include "enroll/hub/command/hub_config.h"

#include <errno.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "drivers/file/ini_table.h"
#include "drivers/file/text.h"

enum { FILE_BYTES_MAX = 1 << 16 };

static int parse_text(const char *value, void *field)
{
    char *text = field;
    return snprintf(text, HUB_CONFIG_TEXT_SIZE, "%s", value) < HUB_CONFIG_TEXT_SIZE ? 0 : -EINVAL;
}

static int parse_port(const char *value, void *field)
{
    int *port = field, read = 0;
    const int error = iso_ini_parse_int(value, &read);
    if (error || read < 1 || read > 65535) {
        return -EINVAL;
    }
    *port = read;
    return 0;
}

static int parse_days(const char *value, void *field)
{
    int *days = field, read = 0;
    const int error = iso_ini_parse_int(value, &read);
    if (error || read < 0 || read > 36500) {
        return -EINVAL;
    }
    *days = read;
    return 0;
}

static int parse_switch(const char *value, void *field)
{
    bool *on = field;
    if (strcmp(value, "yes") != 0 && strcmp(value, "no") != 0) {
        return -EINVAL;
    }
    *on = value[0] == 'y';
    return 0;
}

#define KEY(SECTION, NAME, PARSE, FIELD)                        \
    {                                                           \
        .section = (SECTION), .name = (NAME), .parse = (PARSE), \
        .offset = offsetof(struct hub_config, FIELD)            \
    }

static const struct iso_ini_key keys[] = {
    KEY("database", "conninfo", parse_text, conninfo),
    KEY("hub", "name", parse_text, name),
    KEY("hub", "folder", parse_text, folder),
    KEY("hub", "host", parse_text, host),
    KEY("hub", "port", parse_port, port),
    KEY("hub", "listen", parse_text, listen),
    KEY("hub", "hosts", parse_text, hosts),
    KEY("hub", "pages", parse_text, pages),
    KEY("hub", "metrics", parse_text, metrics),
    KEY("hub", "home_assistant", parse_switch, home_assistant),
    KEY("hub", "keep_deltas", parse_days, keep_deltas),
    KEY("hub", "keep_events", parse_days, keep_events),
    KEY("hub", "keep_acts", parse_days, keep_acts),
    KEY("broker", "host", parse_text, broker_host),
    KEY("broker", "port", parse_port, broker_port),
    KEY("broker", "hub_host", parse_text, broker_hub_host),
    KEY("broker", "hub_port", parse_port, broker_hub_port),
    KEY("broker", "folder", parse_text, broker_folder),
    KEY("broker", "persistence", parse_text, broker_persistence),
};

static int read_file(const char *path, struct hub_config *config, struct iso_fault *fault)
{
    uint64_t seen = 0;
    char *text = NULL;
    int error = iso_text_read(path, FILE_BYTES_MAX, &text, fault);
    error = error
                ? error
                : iso_ini_read(path, text, keys, sizeof keys / sizeof *keys, config, &seen, fault);
    free(text);
    return error;
}

int hub_config_read(const char *path, bool may_be_missing, struct hub_config *out,
                    struct iso_fault *fault)
{
    struct hub_config config = {.conninfo = "dbname=isotherm-hub",
                                .name = "isotherm-hub",
                                .folder = "/var/lib/isotherm-hub",
                                .pages = ISOTHERM_HUB_PAGES,
                                .listen = "[::]:8443",
                                .port = 8443,
                                .keep_deltas = 30,
                                .keep_events = 365,
                                .keep_acts = 730,
                                .broker_hub_host = "localhost",
                                .broker_folder = "/var/lib/isotherm-broker",
                                .broker_persistence = "/var/lib/mosquitto",
                                .broker_port = 8883,
                                .broker_hub_port = 8884};
    int error = read_file(path, &config, fault);
    if (error == -ENOENT && may_be_missing) {
        error = 0;
    }
    if (error) {
        return error;
    }
    if (!*config.host) {
        (void)gethostname(config.host, sizeof config.host - 1);
    }
    if (!*config.broker_host) {
        memcpy(config.broker_host, config.host, sizeof config.broker_host);
    }
    (void)snprintf(config.key_file, sizeof config.key_file, "%s/hub.keys", config.folder);
    *out = config;
    return 0;
}
