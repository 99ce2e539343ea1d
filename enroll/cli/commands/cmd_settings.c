/* settings: show the configuration that is in force, and change it while the daemon runs. */
#include "enroll/cli/commands/commands.h"

#include <errno.h>
#include <string.h>

#include "enroll/cli/text/report.h"
#include "firmware/contract/contract.h"

enum { SECTION_SIZE = 64 };

/* A setting as GetSettings reports it. */
struct setting {
    const char *section, *key, *value, *standard, *range, *help, *configured;
    int changeable;
};

/* What the command asks for: "section.key", in two parts. */
struct wanted {
    char section[SECTION_SIZE];
    const char *key;
};

static enum cli_exit read_wanted(const char *word, struct wanted *out, struct cli_fault *fault)
{
    const char *dot = strchr(word, '.');
    const size_t n = dot ? (size_t)(dot - word) : 0;

    if (n == 0 || n >= sizeof out->section || !dot[1]) {
        return cli_fault_set(fault, CLI_EXIT_USAGE, "usage",
                             "a setting looks like decision.level, not '%s'", word);
    }
    memcpy(out->section, word, n);
    out->section[n] = '\0';
    out->key = dot + 1;
    return CLI_EXIT_OK;
}

/* Reads the next setting of a reply. Returns a positive number, 0 at the end, or a negative errno
 * of sd-bus. */
static int read_setting(sd_bus_message *reply, struct setting *out)
{
    return sd_bus_message_read(reply, "(ssssssbs)", &out->section, &out->key, &out->value,
                               &out->standard, &out->range, &out->help, &out->changeable,
                               &out->configured);
}

static json_t *json_of(const struct setting *setting)
{
    return json_pack("{s:s, s:s, s:s, s:s, s:s, s:s, s:s, s:b}", "section", setting->section, "key",
                     setting->key, "value", setting->value, "default", setting->standard,
                     "configured", setting->configured, "range", setting->range, "help",
                     setting->help, "changeable", setting->changeable);
}

static bool is_changed(const struct setting *setting)
{
    return strcmp(setting->value, setting->configured) != 0;
}

/* ---- show ---- */

static enum cli_exit show_all(sd_bus_message *reply, bool json, struct cli_fault *fault)
{
    json_t *list = json ? json_array() : NULL;
    char section[SECTION_SIZE] = "";
    struct setting setting;
    int r;

    while ((r = read_setting(reply, &setting)) > 0) {
        if (json) {
            (void)json_array_append_new(list, json_of(&setting));
            continue;
        }
        if (strcmp(section, setting.section) != 0) {
            printf("%s[%s]\n", *section ? "\n" : "", setting.section);
            (void)snprintf(section, sizeof section, "%s", setting.section);
        }
        printf("%c %-22s %s", setting.changeable ? ' ' : '-', setting.key, setting.value);
        if (is_changed(&setting)) {
            printf(" (the configuration file has %s)", setting.configured);
        }
        putchar('\n');
    }
    if (r < 0) {
        json_decref(list);
        return cli_daemon_bad_reply(r, ISO_CONTRACT_GET_SETTINGS, fault);
    }
    if (json) {
        return cli_report_json(json_pack("{s:o}", "settings", list));
    }
    puts("\n- takes effect at a restart only");
    return CLI_EXIT_OK;
}

static void print_one(const struct setting *setting)
{
    printf("%s.%s = %s\n  %s\n", setting->section, setting->key, setting->value, setting->help);
    printf("  allowed             %s\n", *setting->range ? setting->range : "a text");
    printf("  default             %s\n", setting->standard);
    printf("  configuration file  %s\n", setting->configured);
    printf("  %s\n", !setting->changeable  ? "It is changed in the configuration file, with a "
                                             "restart of the daemon."
                     : is_changed(setting) ? "It was changed while the daemon ran."
                                           : "It can be changed while the daemon runs.");
}

static enum cli_exit show_one(sd_bus_message *reply, const struct wanted *wanted, bool json,
                              struct cli_fault *fault)
{
    struct setting setting;
    int r;

    while ((r = read_setting(reply, &setting)) > 0) {
        if (strcmp(setting.section, wanted->section) != 0 ||
            strcmp(setting.key, wanted->key) != 0) {
            continue;
        }
        if (json) {
            return cli_report_json(json_of(&setting));
        }
        print_one(&setting);
        return CLI_EXIT_OK;
    }
    if (r < 0) {
        return cli_daemon_bad_reply(r, ISO_CONTRACT_GET_SETTINGS, fault);
    }
    return cli_fault_set(fault, CLI_EXIT_NOT_FOUND, "no-such-setting",
                         "there is no setting %s.%s (see isotherm settings)", wanted->section,
                         wanted->key);
}

static enum cli_exit show(struct cli_daemon *daemon, const struct wanted *wanted, bool json,
                          struct cli_fault *fault)
{
    sd_bus_message *reply = NULL;
    enum cli_exit exit = cli_daemon_call(daemon, ISO_CONTRACT_GET_SETTINGS, &reply, fault);

    if (exit) {
        return exit;
    }
    const int r = sd_bus_message_enter_container(reply, 'a', "(ssssssbs)");
    if (r < 0) {
        exit = cli_daemon_bad_reply(r, ISO_CONTRACT_GET_SETTINGS, fault);
    } else if (wanted) {
        exit = show_one(reply, wanted, json, fault);
    } else {
        exit = show_all(reply, json, fault);
    }
    sd_bus_message_unref(reply);
    return exit;
}

/* ---- change ---- */

static enum cli_exit report_change(sd_bus_message *reply, const struct wanted *wanted,
                                   const struct cli_arguments *arguments, const char *method,
                                   struct cli_fault *fault)
{
    const char *value;
    const int r = sd_bus_message_read(reply, "s", &value);

    if (r < 0) {
        return cli_daemon_bad_reply(r, method, fault);
    }
    if (arguments->json) {
        return cli_report_json(json_pack("{s:s, s:s, s:s}", "section", wanted->section, "key",
                                         wanted->key, "value", value));
    }
    printf("%s.%s is %s from now on%s.\n", wanted->section, wanted->key, value,
           arguments->reset ? ", as in the configuration file" : "");
    return CLI_EXIT_OK;
}

static enum cli_exit change(struct cli_daemon *daemon, const struct wanted *wanted,
                            const struct cli_arguments *arguments, struct cli_fault *fault)
{
    const char *method = arguments->reset ? ISO_CONTRACT_RESET_SETTING : ISO_CONTRACT_SET_SETTING;
    sd_bus_message *call = NULL, *reply = NULL;
    enum cli_exit exit = cli_daemon_message(daemon, method, &call, fault);

    if (exit) {
        return exit;
    }
    int r = sd_bus_message_append(call, "ss", wanted->section, wanted->key);
    if (r >= 0 && !arguments->reset) {
        r = sd_bus_message_append(call, "s", arguments->name);
    }
    if (r < 0) {
        sd_bus_message_unref(call);
        return cli_fault_set(fault, CLI_EXIT_USAGE, "invalid-argument", "a word is not UTF-8");
    }
    exit = cli_daemon_send(daemon, call, &reply, fault);
    if (!exit) {
        exit = report_change(reply, wanted, arguments, method, fault);
    }
    sd_bus_message_unref(reply);
    return exit;
}

enum cli_exit cli_settings(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                           struct cli_fault *fault)
{
    struct wanted wanted;

    if (!arguments->word) {
        return arguments->reset ? cli_fault_set(fault, CLI_EXIT_USAGE, "usage",
                                                "--reset needs a setting, such as decision.level")
                                : show(daemon, NULL, arguments->json, fault);
    }
    const enum cli_exit exit = read_wanted(arguments->word, &wanted, fault);
    if (exit) {
        return exit;
    }
    if (arguments->reset && arguments->name) {
        return cli_fault_set(fault, CLI_EXIT_USAGE, "usage", "give a value or --reset, not both");
    }
    return arguments->reset || arguments->name ? change(daemon, &wanted, arguments, fault)
                                               : show(daemon, &wanted, arguments->json, fault);
}
