/* The daemon: options, and exit codes. */
#include <errno.h>
#include <getopt.h>
#include <malloc.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <syslog.h>

#include "drivers/process/limits.h"
#include "drivers/terminal/output.h"
#include "drivers/vision/face_detector.h"
#include "firmware/bus/device_list.h"
#include "firmware/config/config.h"
#include "firmware/contract/fault_tag.h"
#include "firmware/daemon/components.h"
#include "firmware/daemon/daemon.h"
#include "firmware/daemon/judge_stored.h"

/* The same codes as those of every program of the project; see isothermd(8). */
enum { EXIT_OK = 0, EXIT_USAGE = 2, EXIT_NOT_FOUND = 3, EXIT_FAULT = 4 };

enum option_id {
    OPTION_CONFIG = 256,
    OPTION_BUS,
    OPTION_CHECK_CONFIG,
    OPTION_REST_DOOR,
    OPTION_PRINT_LOG,
    OPTION_ACCEPT_STATE,
    OPTION_JUDGE,
    OPTION_FACTORY_RESET,
    OPTION_FINISH_RESET,
    OPTION_LIST_DEVICES,
    OPTION_HELP_CONFIG,
    OPTION_HELP,
    OPTION_VERSION,
};

/* Every option: its name, its argument (NULL: none), and its help. */
static const struct choice {
    const char *name, *argument;
    enum option_id id;
    const char *help;
} choices[] = {
    {"config", "FILE", OPTION_CONFIG, "read this configuration (default: " ISOTHERM_CONFIG ")"},
    {"bus", "ADDRESS", OPTION_BUS, "serve on this bus: system, session or a D-Bus address"},
    {"check-config", NULL, OPTION_CHECK_CONFIG, "check the configuration and exit"},
    {"rest-door", NULL, OPTION_REST_DOOR,
     "switch all lines of the door off and exit (after a crash)"},
    {"print-log", NULL, OPTION_PRINT_LOG,
     "check and print the audit log and exit (while no daemon runs)"},
    {"accept-state", NULL, OPTION_ACCEPT_STATE,
     "accept files of different times, put that on record, and exit"},
    {"judge", "DIR", OPTION_JUDGE,
     "judge the stored frames of DIR as those of the camera, and exit"},
    {"factory-reset", NULL, OPTION_FACTORY_RESET,
     "delete keys, people, log, settings, accounts, fleet, and exit"},
    {"finish-reset", NULL, OPTION_FINISH_RESET,
     "finish such a reset, or do it if its button is held, and exit"},
    {"list-devices", NULL, OPTION_LIST_DEVICES,
     "print the sensors that the drivers find, one JSON object a line"},
    {"help-config", NULL, OPTION_HELP_CONFIG,
     "print a configuration that names and explains every key"},
    {"help", NULL, OPTION_HELP, "show this help"},
    {"version", NULL, OPTION_VERSION, "show the version"},
};

enum { CHOICES = sizeof choices / sizeof *choices };

static void print_help(void)
{
    fputs("Usage: isothermd [OPTION...]\n"
          "The face recognition appliance: watches the door, and serves isotherm(1).\n\n",
          stdout);
    for (size_t i = 0; i < CHOICES; i++) {
        char left[32];
        (void)snprintf(left, sizeof left, "--%s %s", choices[i].name,
                       choices[i].argument ? choices[i].argument : "");
        printf("  %-16s %s\n", left, choices[i].help);
    }
    fputs("\nExit status: 0 ended by SIGTERM or SIGINT, 2 usage or configuration, 3 a file or\n"
          "driver that is named does not exist, 4 device, data or bus fault.\n",
          stdout);
}

static void make_getopt_table(struct option table[CHOICES + 1])
{
    for (size_t i = 0; i < CHOICES; i++) {
        table[i] = (struct option){choices[i].name, choices[i].argument != NULL, NULL,
                                   (int)choices[i].id};
    }
    table[CHOICES] = (struct option){0};
}

struct arguments {
    const char *config;
    const char *bus;       /* NULL: the bus that the file names */
    enum option_id action; /* 0: run the daemon */
    const char *judge;     /* the directory of stored frames, for OPTION_JUDGE */
};

static int exit_code(int error)
{
    switch (error) {
    case 0:
        return EXIT_OK;
    case -EINVAL:
        return EXIT_USAGE;
    case -ENOENT:
        return EXIT_NOT_FOUND;
    default:
        return EXIT_FAULT;
    }
}

static int say_fault(int error, const struct iso_fault *fault)
{
    if (error) {
        char line[sizeof fault->text + ISO_FAULT_TAG_SIZE], tag[ISO_FAULT_TAG_SIZE];
        (void)snprintf(line, sizeof line, "%s%s", fault->text[0] ? fault->text : strerror(-error),
                       iso_fault_tag(fault->code, tag));
        iso_daemon_say(LOG_ERR, line);
    }
    return exit_code(error);
}

/* The bus on the command line replaces the one in the file. */
static int take_bus(const char *address, struct iso_config *config, struct iso_fault *fault)
{
    if (!address) {
        return 0;
    }
    if (!*address || strlen(address) >= sizeof config->bus.address) {
        return iso_fault_set_code(fault, ISO_FAULT_CONFIG_WRONG, -EINVAL,
                                  "--bus: an address has 1 to %zu bytes",
                                  sizeof config->bus.address - 1);
    }
    (void)snprintf(config->bus.address, sizeof config->bus.address, "%s", address);
    return 0;
}

/* Reads what the service manager provides: a directory with the key, and whether its journal
 * receives messages. */
static void take_surroundings(struct iso_config *config)
{
    const char *credentials = getenv("CREDENTIALS_DIRECTORY");
    (void)snprintf(config->seal.credentials, sizeof config->seal.credentials, "%s",
                   credentials ? credentials : "");
    config->log.journal = config->log.journal && getenv("JOURNAL_STREAM");
}

static int check_config(const char *path, const struct iso_config *config, struct iso_fault *fault)
{
    const int error = iso_daemon_check(config, fault);
    if (!error) {
        printf("%s: sound\n", path);
    }
    return error;
}

/* A button that cannot be read must not keep the door from its service. After a reset the start
 * must not go on: the service manager may have given it a key that is deleted now. */
static int finish_reset(const struct iso_config *config, const struct iso_times *times,
                        struct iso_fault *fault)
{
    struct iso_fault remark = {.text = ""};
    const int r = iso_components_finish_reset(config, times, stdout, &remark, fault);
    if (remark.text[0]) {
        iso_daemon_say(LOG_WARNING, remark.text);
    }
    return r > 0 ? iso_fault_set(fault, -EAGAIN, "reset: start again, without the deleted key") : r;
}

static void warn_of_obsolete(const char *path, const struct iso_config *config)
{
    if (config->obsolete) {
        char line[512];
        (void)snprintf(line, sizeof line, "%s: %s is obsolete and has no effect; remove it", path,
                       config->obsolete);
        iso_daemon_say(LOG_WARNING, line);
    }
}

/* Does what the options ask for. */
static int act(const struct arguments *arguments, const struct iso_config *config,
               struct iso_fault *fault)
{
    const struct iso_times times = iso_times_system();
    switch (arguments->action) {
    case OPTION_CHECK_CONFIG:
        return check_config(arguments->config, config, fault);
    case OPTION_REST_DOOR:
        return iso_components_rest_door(config, &times, fault);
    case OPTION_PRINT_LOG:
        return iso_components_print_log(config, &times, stdout, fault);
    case OPTION_ACCEPT_STATE:
        return iso_components_accept(config, &times, stdout, fault);
    case OPTION_JUDGE:
        return iso_judge_stored(config, &times, arguments->judge, stdout, fault);
    case OPTION_FACTORY_RESET:
        return iso_components_reset(config, stdout, fault);
    case OPTION_FINISH_RESET:
        return finish_reset(config, &times, fault);
    default:
        return iso_daemon_run(config, fault);
    }
}

static int run(const struct arguments *arguments)
{
    struct iso_config config;
    struct iso_fault fault = {.text = ""};
    int error = iso_config_load(arguments->config, &config, &fault);
    if (error && arguments->action == OPTION_FINISH_RESET) {
        return EXIT_OK; /* the daemon, which is started next, reports it */
    }
    if (!error) {
        error = take_bus(arguments->bus, &config, &fault);
    }
    if (!error) {
        take_surroundings(&config);
        warn_of_obsolete(arguments->config, &config);
    }
    if (!error) {
        error = act(arguments, &config, &fault);
    }
    return say_fault(error, &fault);
}

static int list_devices(void)
{
    struct iso_fault fault = {.text = ""};
    return say_fault(iso_device_list_print(stdout, &fault), &fault);
}

static void say_version(void)
{
    const char *engine = iso_face_detector_engine();
    printf("isothermd " ISOTHERM_VERSION "\nimage check: %s\n", *engine ? engine : "not installed");
}

/* Runs the program as the options say. */
static int obey_options(int argc, char **argv)
{
    struct arguments arguments = {.config = ISOTHERM_CONFIG};
    struct option table[CHOICES + 1];
    int id;
    make_getopt_table(table);
    while ((id = getopt_long(argc, argv, "", table, NULL)) != -1) {
        switch (id) {
        case OPTION_CONFIG:
            arguments.config = optarg;
            break;
        case OPTION_BUS:
            arguments.bus = optarg;
            break;
        case OPTION_CHECK_CONFIG:
        case OPTION_REST_DOOR:
        case OPTION_PRINT_LOG:
        case OPTION_ACCEPT_STATE:
        case OPTION_JUDGE:
        case OPTION_FACTORY_RESET:
        case OPTION_FINISH_RESET:
            if (arguments.action && arguments.action != (enum option_id)id) {
                fputs("isothermd: do one thing at a time. Try isothermd --help.\n", stderr);
                return EXIT_USAGE;
            }
            arguments.action = (enum option_id)id;
            arguments.judge = optarg;
            break;
        case OPTION_LIST_DEVICES:
            return list_devices();
        case OPTION_HELP_CONFIG:
            iso_config_print_sample(stdout);
            return EXIT_OK;
        case OPTION_HELP:
            print_help();
            return EXIT_OK;
        case OPTION_VERSION:
            say_version();
            return EXIT_OK;
        default:
            fputs("Try isothermd --help.\n", stderr);
            return EXIT_USAGE;
        }
    }
    if (optind < argc) {
        fprintf(stderr, "isothermd: superfluous word '%s'\n", argv[optind]);
        return EXIT_USAGE;
    }
    return run(&arguments);
}

/* A freed block of at least this size goes back to the kernel at once. By default the C library
 * raises the size up to 32 MiB, and then keeps the memory in which large galleries and statistics
 * were computed: 7 MiB with 10,000 people. */
static void return_large_blocks(void)
{
    enum { LARGE_BYTES = 128 << 10 };
    (void)mallopt(M_MMAP_THRESHOLD, LARGE_BYTES);
}

/* New files belong to their owner alone, whatever umask was inherited. A umask that removes the
 * owner's own rights would leave files that the next start cannot open. */
int main(int argc, char **argv)
{
    (void)umask(S_IRWXG | S_IRWXO);
    return_large_blocks();
    const int code = iso_limits_check("isothermd") ? EXIT_FAULT : obey_options(argc, argv);
    return iso_output_end("isothermd") && code == EXIT_OK ? EXIT_FAULT : code;
}
