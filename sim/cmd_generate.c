/* isotherm-sim generate: renders a corpus. */
#include <errno.h>
#include <getopt.h>
#include <limits.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

#include "sim/commands.h"
#include "sim/generate/generate.h"
#include "sim/options.h"

enum option_id {
    OPTION_ICT = 1,
    OPTION_PRESET,
    OPTION_SENSOR,
    OPTION_PEOPLE,
    OPTION_STRANGERS,
    OPTION_PROBES,
    OPTION_SESSIONS,
    OPTION_PER_KIND,
    OPTION_POSE_LIMIT,
    OPTION_NEAR,
    OPTION_FAR,
    OPTION_POPULATION,
    OPTION_SEED,
    OPTION_FRAMES,
    OPTION_NOISE,
    OPTION_VARIANCE,
    OPTION_IR,
    OPTION_MARKS,
    OPTION_OUT,
    OPTION_HELP,
};

static const struct option options[] = {
    {"ict", required_argument, NULL, OPTION_ICT},
    {"preset", required_argument, NULL, OPTION_PRESET},
    {"sensor", required_argument, NULL, OPTION_SENSOR},
    {"people", required_argument, NULL, OPTION_PEOPLE},
    {"strangers", required_argument, NULL, OPTION_STRANGERS},
    {"probes", required_argument, NULL, OPTION_PROBES},
    {"sessions", required_argument, NULL, OPTION_SESSIONS},
    {"per-kind", required_argument, NULL, OPTION_PER_KIND},
    {"pose-limit", required_argument, NULL, OPTION_POSE_LIMIT},
    {"near", required_argument, NULL, OPTION_NEAR},
    {"far", required_argument, NULL, OPTION_FAR},
    {"population", required_argument, NULL, OPTION_POPULATION},
    {"seed", required_argument, NULL, OPTION_SEED},
    {"frames-per-visit", required_argument, NULL, OPTION_FRAMES},
    {"noise-scale", required_argument, NULL, OPTION_NOISE},
    {"identity-variance", required_argument, NULL, OPTION_VARIANCE},
    {"ir", no_argument, NULL, OPTION_IR},
    {"marks", no_argument, NULL, OPTION_MARKS},
    {"out", required_argument, NULL, OPTION_OUT},
    {"help", no_argument, NULL, OPTION_HELP},
    {NULL, 0, NULL, 0},
};

static void print_help(void)
{
    puts("Usage: isotherm-sim generate --ict DIR --out DIR [OPTION...]\n"
         "\n"
         "Renders a corpus of synthetic people. The same options make the same bytes.\n"
         "\n"
         "  --ict DIR                the ICT-FaceKit head model (mean.npy and so on)\n"
         "  --out DIR                the corpus to write; recordings in it must not exist yet\n"
         "  --preset NAME            mild (default), strong, crowd (mild, with somebody\n"
         "                           behind), pairs (two at the door), texas, hard (mild,\n"
         "                           people who look alike),\n"
         "                           pose (mild, turned to 35 degrees), far (mild, 0.9 to\n"
         "                           1.2 m), landmarks (strong, noisy, turned, every\n"
         "                           person several times), training (at rest, mild, strong,\n"
         "                           for the metric), attacks (photographs, screens,\n"
         "                           masks, and people to compare), not-faces (backs of\n"
         "                           heads, hands, walls, chairs, ...), or stored: the\n"
         "                           project's own corpus, which takes only --sensor and\n"
         "                           --seed\n"
         "  --sensor NAME            default: the preset's\n"
         "  --people N               enrolled people, each with one neutral session;\n"
         "                           landmarks, training: people\n"
         "  --probes K               later sessions of enrolled people, in all\n"
         "  --strangers M            people who are not enrolled, with one session each\n"
         "  --sessions N             landmarks, training: sessions of every person (24, 5)\n"
         "  --pose-limit DEGREES     landmarks, training: yaw and pitch cover a disc of this "
         "radius,\n"
         "                           flattened to 0.7 in pitch (35)\n"
         "  --near MM, --far MM      between which all but the gallery stand, nose tip; default:\n"
         "                           the preset's, which mostly is the sensor's\n"
         "  --per-kind N             attacks, not-faces: rows of every kind (300, 200)\n"
         "  --frames-per-visit F     frames of every session (1); attacks: of what is\n"
         "                           shown for a while (15)\n"
         "  --population NAME        people of different populations are different (test)\n"
         "  --seed S                 (1)\n"
         "  --noise-scale X          factor on the sensor's random errors (1; landmarks 2.5)\n"
         "  --identity-variance X    spread of the people; 0.36: they look alike (1; hard 0.36)\n"
         "  --marks                  25 points in landmarks.csv, for anthroface-25, not\n"
         "                           only the twelve\n"
         "  --ir                     an infrared image beside every depth frame (ir/)\n"
         "\n"
         "Sensors:");
    for (int i = 0; sim_sensors[i]; i++) {
        printf("  %-10s %s\n", sim_sensors[i]->name, sim_sensors[i]->summary);
    }
}

static bool parse_long(const char *text, long min, long max, long *out)
{
    char *end;
    errno = 0;
    long value = strtol(text, &end, 10);
    bool good = errno == 0 && end != text && *end == '\0' && value >= min && value <= max;
    if (good) {
        *out = value;
    }
    return good;
}

static bool parse_count(const char *text, int *out)
{
    long value;
    bool good = parse_long(text, 0, INT_MAX, &value);
    if (good) {
        *out = (int)value;
    }
    return good;
}

static bool parse_factor(const char *text, double *out)
{
    char *end;
    double value = strtod(text, &end);
    bool good = end != text && *end == '\0' && isfinite(value) && value >= 0.0;
    if (good) {
        *out = value;
    }
    return good;
}

static bool parse_sensor(const char *text, const struct sim_sensor **out)
{
    *out = sim_sensor_find(text);
    return *out != NULL;
}

static bool take_option(enum option_id option, const char *value, struct sim_generate_options *to)
{
    long seed;
    switch (option) {
    case OPTION_ICT:
        to->ict_directory = value;
        return true;
    case OPTION_OUT:
        to->directory = value;
        return true;
    case OPTION_PRESET:
        to->preset = value;
        return true;
    case OPTION_POPULATION:
        to->population = value;
        return true;
    case OPTION_SENSOR:
        return parse_sensor(value, &to->sensor);
    case OPTION_PEOPLE:
        return parse_count(value, &to->n_people);
    case OPTION_STRANGERS:
        return parse_count(value, &to->n_strangers);
    case OPTION_PROBES:
        return parse_count(value, &to->n_probes);
    case OPTION_FRAMES:
        return parse_count(value, &to->frames_per_visit);
    case OPTION_NOISE:
        return parse_factor(value, &to->noise_scale);
    case OPTION_SESSIONS:
        return parse_count(value, &to->n_sessions);
    case OPTION_PER_KIND:
        return parse_count(value, &to->n_per_kind);
    case OPTION_POSE_LIMIT:
        return sim_option_degrees(value, &to->pose_limit_rad) == 0;
    case OPTION_NEAR:
        return parse_factor(value, &to->near_mm);
    case OPTION_FAR:
        return parse_factor(value, &to->far_mm);
    case OPTION_VARIANCE:
        return parse_factor(value, &to->identity_variance);
    case OPTION_SEED:
        if (!parse_long(value, 0, LONG_MAX, &seed)) {
            return false;
        }
        to->seed = (uint64_t)seed;
        return true;
    case OPTION_MARKS:
        to->marks = true;
        return true;
    case OPTION_IR:
        to->infrared = true;
        return true;
    case OPTION_HELP:
        break;
    }
    return false;
}

static int exit_code(int error)
{
    return error == -EINVAL   ? SIM_EXIT_USAGE
           : error == -ENOENT ? SIM_EXIT_NOT_FOUND
                              : SIM_EXIT_FAULT;
}

int sim_cmd_generate(int argc, char **argv)
{
    struct sim_generate_options to = sim_generate_options_default();
    int option, index = 0;
    while ((option = getopt_long(argc, argv, "", options, &index)) != -1) {
        if (option == OPTION_HELP) {
            print_help();
            return SIM_EXIT_OK;
        }
        if (option == '?') {
            return SIM_EXIT_USAGE;
        }
        if (!take_option((enum option_id)option, optarg, &to)) {
            fprintf(stderr, "isotherm-sim generate: --%s: bad value '%s'\n", options[index].name,
                    optarg);
            return SIM_EXIT_USAGE;
        }
    }
    if (!to.ict_directory || !to.directory || optind < argc) {
        fputs("isotherm-sim generate: --ict and --out are needed, and nothing but options\n",
              stderr);
        return SIM_EXIT_USAGE;
    }
    struct iso_fault fault = {""};
    int error = sim_generate(&to, &fault);
    if (error != 0) {
        fprintf(stderr, "isotherm-sim generate: %s\n", fault.text);
        return exit_code(error);
    }
    return SIM_EXIT_OK;
}
