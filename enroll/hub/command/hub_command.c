#include "enroll/hub/command/hub_command.h"

#include <errno.h>
#include <pwd.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "enroll/hub/store/hub_zone.h"

enum { CONFIRM_S = 5, POLL_MS = 200 };

static const struct hub_command *const tables[] = {
    hub_setup_commands,     hub_serve_commands,   hub_zone_commands,    hub_door_commands,
    hub_person_commands,    hub_request_commands, hub_event_commands,   hub_outlet_commands,
    hub_directory_commands, hub_scim_commands,    hub_metrics_commands, hub_update_commands,
};

/* How many words of argv the command's own words are, or 0. */
static int match(const struct hub_command *command, int argc, char **argv)
{
    char both[64];
    if (argc > 1 && strcmp(command->words, argv[1]) == 0) {
        return 1;
    }
    if (argc > 2) {
        (void)snprintf(both, sizeof both, "%s %s", argv[1], argv[2]);
        return strcmp(command->words, both) == 0 ? 2 : 0;
    }
    return 0;
}

static const struct hub_command *find(int argc, char **argv, int *own)
{
    for (size_t t = 0; t < sizeof tables / sizeof *tables; t++) {
        for (const struct hub_command *c = tables[t]; c->words; c++) {
            *own = match(c, argc, argv);
            if (*own) {
                return c;
            }
        }
    }
    return NULL;
}

static void print_help(void)
{
    puts("Usage: isotherm-hub COMMAND [--config FILE] ...\n");
    for (size_t t = 0; t < sizeof tables / sizeof *tables; t++) {
        for (const struct hub_command *c = tables[t]; c->words; c++) {
            printf("  %s%s%s\n        %s\n", c->words, *c->synopsis ? " " : "", c->synopsis,
                   c->help);
        }
    }
    puts("\n  --help     print this and end\n  --version  print the version and end");
}

static int exit_of(int error)
{
    switch (error) {
    case 0:
        return HUB_EXIT_OK;
    case -EINVAL:
        return HUB_EXIT_USAGE;
    case -ENOENT:
        return HUB_EXIT_NOT_FOUND;
    case -EEXIST:
    case -EALREADY:
    case -ESTALE:
    case -EPERM:
    case -EACCES:
        return HUB_EXIT_NO;
    default:
        return HUB_EXIT_FAULT;
    }
}

/* Who acts: the person who has called sudo, else the user. */
static const char *actor(void)
{
    const char *sudo = geteuid() == 0 ? getenv("SUDO_USER") : NULL;
    const struct passwd *user = sudo && *sudo ? NULL : getpwuid(getuid());
    return sudo && *sudo ? sudo : user ? user->pw_name : "unknown";
}

static int open_and_run(const struct hub_command *command, struct hub_run *run)
{
    const struct hub_store_options options = {.conninfo = run->config.conninfo,
                                              .key_file = run->config.key_file,
                                              .hub_name = run->config.name,
                                              .actor = run->actor};
    const int error = command->without_store ? 0
                                             : hub_store_open(&options, &run->store, &run->fault);
    return error ? error : command->run(run);
}

static int read_config(struct hub_run *run, const char *path)
{
    return hub_config_read(path ? path : HUB_CONFIG_PATH, !path, &run->config, &run->fault);
}

static int end(const struct hub_run *run, int error, int status)
{
    if (error) {
        fprintf(stderr, "isotherm-hub: %s\n", run->fault.text);
        return exit_of(error);
    }
    if (fflush(stdout)) {
        fprintf(stderr, "isotherm-hub: standard output: %s\n", strerror(errno));
        return HUB_EXIT_FAULT;
    }
    return status;
}

static int run_command(const struct hub_command *command, struct hub_run *run, int argc,
                       char **argv)
{
    int error = hub_arguments_read(command, argc, argv, &run->arguments, &run->fault);
    error = error ? error : read_config(run, run->arguments.config);
    error = error ? error : open_and_run(command, run);
    hub_store_close(&run->store);
    return end(run, error, run->unconfirmed ? HUB_EXIT_NO : HUB_EXIT_OK);
}

/* A command with options of its own: only --config is taken out of them. */
static int run_whole(const struct hub_command *command, struct hub_run *run, int argc, char **argv)
{
    const char *path = NULL;
    int status = HUB_EXIT_OK;
    for (int i = 1; i + 1 < argc; i++) {
        if (strcmp(argv[i], "--config") == 0) {
            path = argv[i + 1];
            memmove(&argv[i], &argv[i + 2], (size_t)(argc - i - 1) * sizeof *argv);
            argc -= 2;
            break;
        }
    }
    int error = read_config(run, path);
    error = error ? error : command->run_whole(run, argc, argv, &status);
    return end(run, error, status);
}

int hub_command_main(int argc, char **argv)
{
    int own = 0;
    if (argc > 1 && strcmp(argv[1], "--help") == 0) {
        print_help();
        return HUB_EXIT_OK;
    }
    if (argc > 1 && strcmp(argv[1], "--version") == 0) {
        puts("isotherm-hub " ISOTHERM_VERSION);
        return HUB_EXIT_OK;
    }
    const struct hub_command *command = find(argc, argv, &own);
    if (!command) {
        fprintf(stderr, "isotherm-hub: %s: there is no such command; see isotherm-hub --help\n",
                argc > 1 ? argv[1] : "a command is missing");
        return HUB_EXIT_USAGE;
    }
    static struct hub_run run;
    run.actor = actor();
    return command->run_whole ? run_whole(command, &run, argc - own, argv + own)
                              : run_command(command, &run, argc - own, argv + own);
}

/* ---- for several commands ---- */

const char *hub_time_text(int64_t time_s, char text[HUB_TIME_TEXT_SIZE])
{
    const time_t time = time_s;
    struct tm local;
    if (time_s == 0 || !localtime_r(&time, &local) ||
        strftime(text, HUB_TIME_TEXT_SIZE, "%Y-%m-%d %H:%M:%S", &local) == 0) {
        (void)snprintf(text, HUB_TIME_TEXT_SIZE, "-");
    }
    return text;
}

int hub_run_zones(struct hub_run *run, struct iso_fleet_id ids[HUB_PERSON_ZONES_MAX])
{
    int error = 0;
    for (size_t i = 0; !error && i < run->arguments.n_zones; i++) {
        struct hub_zone zone;
        error = hub_zone_find(&run->store, run->arguments.zones[i], &zone, &run->fault);
        if (!error) {
            ids[i] = zone.place.zone;
        }
    }
    return error;
}

struct unconfirmed {
    size_t n;
    bool print;
};

static int take_behind(void *context, const struct hub_behind *door)
{
    struct unconfirmed *u = context;
    char text[HUB_TIME_TEXT_SIZE];
    u->n++;
    if (u->print) {
        printf("not confirmed: %s, %s, last report %s\n", door->name,
               door->online ? "online" : "offline", hub_time_text(door->reported_s, text));
    }
    return 0;
}

/* How many doors have not confirmed; prints them if asked to. */
static int count(struct hub_run *run, const struct iso_fleet_id *zones, size_t n,
                 struct unconfirmed *u)
{
    int error = 0;
    u->n = 0;
    for (size_t i = 0; !error && i < n; i++) {
        error = hub_doors_behind(&run->store, &zones[i], take_behind, u, &run->fault);
    }
    return error;
}

int hub_run_confirm(struct hub_run *run, const struct iso_fleet_id *zones, size_t n)
{
    const uint32_t wait_s = run->arguments.given & HUB_OPTION_WAIT ? run->arguments.wait_s
                                                                   : CONFIRM_S;
    const struct timespec pause = {.tv_nsec = POLL_MS * 1000000};
    struct unconfirmed u = {.print = false};
    int error = count(run, zones, n, &u);
    for (uint32_t i = 0; !error && u.n > 0 && i < wait_s * (1000 / POLL_MS); i++) {
        (void)nanosleep(&pause, NULL);
        error = count(run, zones, n, &u);
    }
    if (!error && u.n > 0) {
        u.print = true;
        error = count(run, zones, n, &u);
        run->unconfirmed = u.n > 0;
    }
    return error;
}
