/* isotherm-sim import: converts a public database of 3D faces to a corpus, or ICT-FaceKit to a head
 * model. */
#include <errno.h>
#include <stddef.h>
#include <stdio.h>

#include "sim/base/options.h"
#include "sim/commands/command.h"
#include "sim/commands/commands.h"
#include "sim/corpus/import.h"
#include "sim/world/face/ict_kit.h"

struct arguments {
    const char *database, *ict;
    struct sim_import_options import;
};

#define FIELD(name) offsetof(struct arguments, name)

static const struct sim_option options[] = {
    {"ict", "DIR", "a clone of ICT-FaceKit, to make the head model for `generate --ict`",
     sim_option_text, FIELD(ict)},
    {"database", "NAME", "the database that the files are from", sim_option_text, FIELD(database)},
    {"from", "DIR", "folder of the files, which may be in subfolders", sim_option_text,
     FIELD(import.from)},
    {"out", "DIR", "the corpus, or the head model (made if it is missing)", sim_option_text,
     FIELD(import.to)},
    {"strangers", "N", "do not enrol the last N people by name (0)", sim_option_count,
     FIELD(import.n_strangers)},
    {"level", "MM", "depth of one grey level of a range image (texas: 0.32)", sim_option_number,
     FIELD(import.database_options.level_mm)},
};

static void list_databases(FILE *out)
{
    fputs("\nDatabases:\n", out);
    for (size_t i = 0; sim_databases[i]; i++) {
        fprintf(out, "  %-12s%s\n", sim_databases[i]->name, sim_databases[i]->source);
    }
}

static int import_ict(const struct arguments *arguments, struct iso_fault *fault)
{
    struct sim_ict_kit_report report;
    if (arguments->database || arguments->import.from || !arguments->import.to) {
        return iso_fault_set(fault, -EINVAL,
                             "--ict needs --out, and neither --database nor --from");
    }
    const int error = sim_ict_import(arguments->ict, &sim_ict_kit_layout, arguments->import.to,
                                     &report, fault);
    if (!error) {
        printf("%s: %u vertices, %u triangles, %u identities, %u expressions\n",
               arguments->import.to, report.n_vertices, report.n_triangles, report.n_identity,
               report.n_expression);
    }
    return error;
}

static int run(void *target, struct iso_fault *fault)
{
    struct arguments *arguments = target;
    if (arguments->ict) {
        return import_ict(arguments, fault);
    }
    struct sim_import_options *import = &arguments->import;
    struct sim_import_report report;
    if (!arguments->database || !import->from || !import->to) {
        return iso_fault_set(fault, -EINVAL,
                             "--database, --from and --out are needed, or --ict and --out");
    }
    import->database = sim_database_find(arguments->database);
    if (!import->database) {
        return iso_fault_set(fault, -EINVAL, "--database: '%s' is unknown", arguments->database);
    }
    if (!(import->database_options.level_mm > 0.0)) {
        return iso_fault_set(fault, -EINVAL, "--level: must be above 0");
    }
    const int error = sim_import(import, &report, fault);
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
        .needs = "--database NAME --from DIR --out DIR | --ict DIR --out DIR",
        .summary =
            "Converts a public database of 3D faces, for which you have a licence, to a corpus. "
            "A virtual\n"
            "depth camera renders each scan; the first neutral scan of a person is enrolled.\n"
            "With --ict it reads the OBJ files of the public repository ICT-FaceKit instead, and "
            "writes\nthe head model that generate, train and sensor read. It uses no network.",
        .run = run,
        .notes = list_databases,
    };
    return sim_command_run(&command, &set, 1, argc, argv);
}
