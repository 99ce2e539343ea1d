#include "sim/commands/command.h"

#include <errno.h>
#include <stdbool.h>
#include <string.h>

#include "drivers/terminal/words.h"
#include "sim/commands/commands.h"

static int complain(const struct sim_command *command, const struct iso_fault *fault, int exit_code)
{
    fprintf(stderr, "isotherm-sim %s: %s\n", command->name, fault->text);
    return exit_code;
}

static void print_help(const struct sim_command *command, const struct sim_option_set *sets,
                       size_t n_sets)
{
    printf("Usage: isotherm-sim %s %s [OPTION...]\n\n%s\n\n", command->name, command->needs,
           command->summary);
    sim_options_help(sets, n_sets, stdout);
    if (command->notes) {
        command->notes(stdout);
    }
}

int sim_command_exit_code(int error)
{
    switch (error) {
    case -EINVAL:
        return SIM_EXIT_USAGE;
    case -ENOENT:
        return SIM_EXIT_NOT_FOUND;
    default:
        return SIM_EXIT_FAULT;
    }
}

int sim_command_run(const struct sim_command *command, const struct sim_option_set *sets,
                    size_t n_sets, int argc, char **argv)
{
    struct iso_fault fault = {.text = ""};
    switch (sim_options_parse(argc, argv, sets, n_sets, &fault)) {
    case SIM_OPTIONS_HELP:
        print_help(command, sets, n_sets);
        return SIM_EXIT_OK;
    case SIM_OPTIONS_REFUSED:
        return complain(command, &fault, SIM_EXIT_USAGE);
    case SIM_OPTIONS_READ:
        break;
    }
    const int error = command->run(sets[0].target, &fault);
    if (!error) {
        return SIM_EXIT_OK;
    }
    return complain(command, &fault, sim_command_exit_code(error));
}

/* The last word of a command's name, without the name of its group. */
static const char *word_of(const char *group, const struct sim_subcommand *subcommand)
{
    return subcommand->command.name + strlen(group) + 1;
}

struct group {
    const char *name;
    const struct sim_subcommand *list;
    size_t n;
};

static const char *next_word(size_t index, const void *context)
{
    const struct group *group = context;
    return index < group->n ? word_of(group->name, &group->list[index]) : NULL;
}

int sim_subcommand_run(const char *group, const struct sim_subcommand *list, size_t n,
                       void *arguments, int argc, char **argv)
{
    const char *word = argc > 1 ? argv[1] : "";
    for (size_t i = 0; i < n; i++) {
        if (strcmp(word, word_of(group, &list[i])) == 0) {
            const struct sim_option_set set = {list[i].options, list[i].n_options, arguments};
            return sim_command_run(&list[i].command, &set, 1, argc - 1, argv + 1);
        }
    }
    const bool help = strcmp(word, "--help") == 0;
    FILE *out = help ? stdout : stderr;
    fprintf(out, "Usage: isotherm-sim %s ", group);
    for (size_t i = 0; i < n; i++) {
        fprintf(out, "%s%s", i ? "|" : "", word_of(group, &list[i]));
    }
    const struct group all = {group, list, n};
    const char *meant = help ? NULL : iso_words_nearest(word, next_word, &all);
    fprintf(out, " [OPTION...]%s%s%s\n", meant ? "; did you mean '" : "", meant ? meant : "",
            meant ? "'?" : "");
    return help ? SIM_EXIT_OK : SIM_EXIT_USAGE;
}
