/* isotherm-sim: the simulator's programs under one name. */
#include <stdio.h>
#include <string.h>

#include "drivers/process/limits.h"
#include "drivers/terminal/output.h"
#include "drivers/terminal/words.h"
#include "sim/base/progress.h"
#include "sim/commands/commands.h"

static const struct command {
    const char *name, *summary;
    int (*run)(int argc, char **argv);
} commands[] = {
    {"generate", "render a corpus of synthetic faces through a sensor model", sim_cmd_generate},
    {"import", "make a corpus of a public database of 3D faces", sim_cmd_import},
    {"train", "make the head model, metric and cohort that ship with the product", sim_cmd_train},
    {"eval", "measure recognition on a corpus", sim_cmd_eval},
    {"landmarks", "measure landmarks, gates and presentation attacks on a corpus",
     sim_cmd_landmarks},
    {"outlines", "measure whether the outline stream tells people apart", sim_cmd_outlines},
    {"sensor", "measure the depth errors of a sensor model, by distance", sim_cmd_sensor},
#ifdef ISOTHERM_STEREO
    {"calibrate", "calibrate cameras on pictures of a checkerboard", sim_cmd_calibrate},
#endif
    {"show", "draw a frame, its fit, mesh, heat or isotherms", sim_cmd_show},
    {"shapes", "make and retrieve non-rigid shapes", sim_cmd_shapes},
    {"replay", "play a corpus to the appliance itself, on a virtual clock", sim_cmd_replay},
    {"levels", "count who is refused and who is let in at each security level", sim_cmd_levels},
    {"record", "record what a sensor sees", sim_cmd_record},
    {"visit", "play the people of a corpus at the door of a running daemon", sim_cmd_visit},
};

static void print_help(FILE *out)
{
    fputs("Usage: isotherm-sim COMMAND [OPTION...]\n\nCommands:\n", out);
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++) {
        fprintf(out, "  %-10s %s\n", commands[i].name, commands[i].summary);
    }
    fputs("\n`isotherm-sim COMMAND --help` lists a command's options.\n", out);
}

static const char *next_command(size_t index, const void *context)
{
    (void)context;
    return index < sizeof commands / sizeof *commands ? commands[index].name : NULL;
}

static int run(int argc, char **argv)
{
    if (argc < 2) {
        print_help(stderr);
        return SIM_EXIT_USAGE;
    }
    if (strcmp(argv[1], "--help") == 0) {
        print_help(stdout);
        return SIM_EXIT_OK;
    }
    if (strcmp(argv[1], "--version") == 0) {
        puts("isotherm-sim " ISOTHERM_VERSION);
        return SIM_EXIT_OK;
    }
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++) {
        if (strcmp(argv[1], commands[i].name) == 0) {
            return commands[i].run(argc - 1, argv + 1);
        }
    }
    const char *meant = iso_words_nearest(argv[1], next_command, NULL);
    if (meant) {
        fprintf(stderr, "isotherm-sim: unknown command '%s': did you mean '%s'?\n", argv[1], meant);
    } else {
        fprintf(stderr, "isotherm-sim: unknown command '%s' (see isotherm-sim --help)\n", argv[1]);
    }
    return SIM_EXIT_USAGE;
}

int main(int argc, char **argv)
{
    sim_progress_to(stderr);
    const int exit_code = iso_limits_check("isotherm-sim") ? SIM_EXIT_FAULT : run(argc, argv);
    return iso_output_end("isotherm-sim") && exit_code == SIM_EXIT_OK ? SIM_EXIT_FAULT : exit_code;
}
