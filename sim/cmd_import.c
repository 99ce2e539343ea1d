/* isotherm-sim import: a public database of 3D faces becomes a corpus. */
#include <errno.h>
#include <stddef.h>
#include <stdio.h>

#include "sim/command.h"
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

static void list_databases(FILE *out)
{
    fputs("\nDatabases:\n", out);
    for (size_t i = 0; sim_databases[i]; i++) {
        fprintf(out, "  %-12s%s\n", sim_databases[i]->name, sim_databases[i]->source);
    }
}

static int run(void *target, struct iso_fault *fault)
{
    struct arguments *arguments = target;
    struct sim_import_options *import = &arguments->import;
    struct sim_import_report report;
    if (!arguments->database || !import->from || !import->to) {
        return iso_fault_set(fault, -EINVAL, "--database, --from and --out are needed");
    }
    import->database = sim_database_find(arguments->database);
    if (!import->database) {
        return iso_fault_set(fault, -EINVAL, "--database: '%s' is unknown", arguments->database);
    }
    if (!(import->database_options.level_mm > 0.0)) {
        return iso_fault_set(fault, -EINVAL, "--level: must be above 0");
    }
    int error = sim_import(import, &report, fault);
    if (!error) {
        printf("%zu scans of %zu people, %zu refused\n", report.scans, report.people,
               report.refused);
    }
    return error;
}

int sim_cmd_import(int argc, char **argv)
{
    struct arguments arguments = {.import.database_options.level_mm = 0.32};
    const struct sim_option_set set = {options, sizeof options / sizeof *options, &arguments};
    const struct sim_command command = {
        .name = "import",
        .needs = "--database NAME --from DIR --out DIR",
        .summary = "Makes a corpus of a public database of 3D faces that you have a licence for. "
                   "Each scan is\n"
                   "seen by a virtual depth camera; the first neutral one of a person is enrolled.",
        .run = run,
        .notes = list_databases,
    };
    return sim_command_run(&command, &set, 1, argc, argv);
}
