#include <stdio.h>

#include "enroll/cli/arguments/arguments.h"
#include "enroll/cli/arguments/command_table.h"
#include "enroll/cli/arguments/option_table.h"
#include "enroll/cli/arguments/wrap.h"

/* The help of an option for this command. */
static const char *help_text(const struct cli_option *option, enum cli_verb verb)
{
    for (const struct cli_option_help *part = option->parts; part && part->text; part++) {
        if (part->verb == verb) {
            return part->text;
        }
    }
    return option->help ? option->help : "";
}

static void print_option(const struct cli_option *option, enum cli_verb verb, FILE *out)
{
    char left[40];

    (void)snprintf(left, sizeof left, "--%s%s%s", option->name, option->argument ? " " : "",
                   option->argument ? option->argument : "");
    const int column = fprintf(out, "  %-19s ", left);
    cli_wrap(help_text(option, verb), column, out);
}

enum { WORDS_MAX = 40, SUMMARY_COLUMN = 26 };

static void print_commands(FILE *out)
{
    for (size_t i = 0; i < CLI_VERBS; i++) {
        const struct cli_command *command = &cli_commands[i];
        int column = fprintf(out, "  %-8s %-14s ", command->name, command->words);
        if (column > WORDS_MAX) { /* the summary has a line of its own */
            column = fprintf(out, "\n%*s", SUMMARY_COLUMN, "") - 1;
        }
        cli_wrap(command->summary, column, out);
    }
}

/* Prints the options of one command and the common options. For CLI_VERBS it prints only the common
 * ones. */
static void print_options(enum cli_verb verb, FILE *out)
{
    for (size_t i = 0; i < CLI_OPTIONS; i++) {
        const unsigned verbs = cli_options[i].verbs;
        if (verbs == 0 || (verb < CLI_VERBS && (verbs & CLI_FOR(verb)))) {
            print_option(&cli_options[i], verb, out);
        }
    }
}

void cli_arguments_help(enum cli_verb verb, FILE *out)
{
    if (verb == CLI_VERBS) {
        fputs("Usage: isotherm [OPTION...] COMMAND\n"
              "A client of the face recognition appliance isothermd.\n\nCommands:\n",
              out);
        print_commands(out);
    } else {
        const struct cli_command *command = &cli_commands[verb];
        fprintf(out, "Usage: isotherm %s%s%s [OPTION...]\n%c%s.\n", command->name,
                *command->words ? " " : "", command->words, command->summary[0] - 'a' + 'A',
                command->summary + 1);
    }
    fputs("\nOptions:\n", out);
    print_options(verb, out);
    if (verb == CLI_VERBS) {
        fputs("\n`isotherm COMMAND --help` lists a command's own options.\n", out);
    }
    fputs("\nExit status: 0 yes or done, 1 no match or refused, 2 usage, 3 no such thing,\n"
          "4 device, daemon or data fault, 5 timed out, 6 more has to be shown.\n",
          out);
}
