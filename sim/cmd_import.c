/* isotherm-sim import: a public database of 3D faces becomes a corpus. */
#include <errno.h>
#include <stddef.h>
#include <stdio.h>

#include "sim/commands.h"
#include "sim/loaders/import.h"
#include "sim/options.h"

struct arguments {
    const char *database;
    struct sim_import_options import;
};

#define FIELD(name) offsetof(struct arguments, name)

static const struct sim_option options[] = {
    {"database", "NAME", "whose files they are", sim_option_text, FIELD(database)},
    {"from", "DIR", "where the files are, at any depth", sim_option_text, FIELD(import.from)},
    {"out", "DIR", "the corpus (made if it is missing)", sim_option_text, FIELD(import.to)},
    {"strangers", "N", "people, the last by name, who enrol nothing (0)", sim_option_count,
     FIELD(import.n_strangers)},
    {"level", "MM", "of a grey level of a range image (texas: 0.32)", sim_option_number,
     FIELD(import.database_options.level_mm)},
};

static int complain(const struct iso_fault *fault, int exit_code)
{
    fprintf(stderr, "isotherm-sim import: %s\n", fault->text);
    return exit_code;
}

static void print_help(const struct sim_option_set *set)
{
    puts("Usage: isotherm-sim import --database NAME --from DIR --out DIR [OPTION...]\n\n"
         "Makes a corpus of a public database of 3D faces that you have a licence for. Each scan "
         "is\n"
         "seen by a virtual depth camera; the first neutral one of a person is enrolled.\n");
    sim_options_help(set, 1, stdout);
    puts("\nDatabases:");
    for (size_t i = 0; sim_databases[i]; i++) {
        printf("  %-12s%s\n", sim_databases[i]->name, sim_databases[i]->source);
    }
}

int sim_cmd_import(int argc, char **argv)
{
    struct arguments arguments = {.import.database_options.level_mm = 0.32};
    const struct sim_option_set set = {options, sizeof options / sizeof *options, &arguments};
    struct iso_fault fault = {""};
    enum sim_options_outcome outcome = sim_options_parse(argc, argv, &set, 1, &fault);
    if (outcome == SIM_OPTIONS_HELP) {
        print_help(&set);
        return SIM_EXIT_OK;
    }
    if (outcome == SIM_OPTIONS_REFUSED) {
        return complain(&fault, SIM_EXIT_USAGE);
    }
    struct sim_import_options *import = &arguments.import;
    if (!arguments.database || !import->from || !import->to) {
        (void)iso_fault_set(&fault, 0, "--database, --from and --out are needed");
        return complain(&fault, SIM_EXIT_USAGE);
    }
    import->database = sim_database_find(arguments.database);
    if (!import->database || !(import->database_options.level_mm > 0.0)) {
        (void)iso_fault_set(&fault, 0,
                            import->database ? "--level: must be above 0"
                                             : "--database: '%s' is unknown",
                            arguments.database);
        return complain(&fault, SIM_EXIT_USAGE);
    }
    struct sim_import_report report;
    int error = sim_import(import, &report, &fault);
    if (error) {
        return complain(&fault, error == -EINVAL   ? SIM_EXIT_USAGE
                                : error == -ENOENT ? SIM_EXIT_NOT_FOUND
                                                   : SIM_EXIT_FAULT);
    }
    printf("%zu scans of %zu people, %zu refused\n", report.scans, report.people, report.refused);
    return SIM_EXIT_OK;
}
