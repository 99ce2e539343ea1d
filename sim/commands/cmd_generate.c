/* isotherm-sim generate: renders a corpus. */
#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>

#include "drivers/file/text.h"
#include "sim/commands/command.h"
#include "sim/commands/commands.h"
#include "sim/world/generate/generate.h"

#define FIELD(name) offsetof(struct sim_generate_options, name)

/* A factor or a length: not less than 0. */
static int parse_factor(const char *text, void *field)
{
    double value;
    if (iso_text_number(text, &value) || !(value >= 0.0)) {
        return -EINVAL;
    }
    *(double *)field = value;
    return 0;
}

static int parse_seed(const char *text, void *field)
{
    size_t value;
    if (iso_text_count(text, &value)) {
        return -EINVAL;
    }
    *(uint64_t *)field = value;
    return 0;
}

static int parse_sensor(const char *text, void *field)
{
    const struct sim_sensor *sensor = sim_sensor_find(text);
    if (!sensor) {
        return -EINVAL;
    }
    *(const struct sim_sensor **)field = sensor;
    return 0;
}

static const struct sim_option options[] = {
    {"ict", "DIR", "the ICT-FaceKit head model (mean.npy and so on)", sim_option_text,
     FIELD(ict_directory)},
    {"out", "DIR", "the corpus to write; recordings in it must not exist yet", sim_option_text,
     FIELD(directory)},
    {"preset", "NAME", "what kind of corpus (mild); see below", sim_option_text, FIELD(preset)},
    {"sensor", "SENSOR", "sensor model (the preset's own); see below", parse_sensor, FIELD(sensor)},
    {"people", "N", "number of enrolled people; landmarks, training: of all people", sim_option_int,
     FIELD(n_people)},
    {"probes", "K", "total number of later sessions of the enrolled people", sim_option_int,
     FIELD(n_probes)},
    {"strangers", "M", "people who are not enrolled, with one session each", sim_option_int,
     FIELD(n_strangers)},
    {"sessions", "N", "landmarks, training: sessions of every person (24, 5)", sim_option_int,
     FIELD(n_sessions)},
    {"pose-limit", "DEGREES", "landmarks, training: greatest yaw; pitch has 0.7 of it (35)",
     sim_option_degrees, FIELD(pose_limit_rad)},
    {"pitch-limit", "DEGREES", "landmarks, training: greatest pitch (0.7 of the yaw)",
     sim_option_degrees, FIELD(pitch_limit_rad)},
    {"keep-hair", NULL, "hair stays between a person's sessions; more fringes, more long hair",
     sim_option_flag, FIELD(keeps_hair)},
    {"near", "MM", "nearest nose tip, except for enrolment (the preset's)", parse_factor,
     FIELD(near_mm)},
    {"far", "MM", "farthest nose tip, except for enrolment (the preset's)", parse_factor,
     FIELD(far_mm)},
    {"per-kind", "N", "attacks, not-faces: rows of every kind (300, 200)", sim_option_int,
     FIELD(n_per_kind)},
    {"frames-per-visit", "F", "frames of every session (1; attacks: 15)", sim_option_int,
     FIELD(frames_per_visit)},
    {"population", "NAME", "different populations have different people (test)", sim_option_text,
     FIELD(population)},
    {"seed", "S", "seed of all random numbers (1)", parse_seed, FIELD(seed)},
    {"noise-scale", "X", "factor on the sensor's random errors (1; landmarks 2.5)", parse_factor,
     FIELD(noise_scale)},
    {"identity-variance", "X", "spread of the people; 0.36: they look alike (1; hard 0.36)",
     parse_factor, FIELD(identity_variance)},
    {"marks", NULL, "write 25 points instead of twelve to landmarks.csv, for anthroface-25",
     sim_option_flag, FIELD(marks)},
    {"ir", NULL, "also write an infrared image for every depth frame (ir/)", sim_option_flag,
     FIELD(infrared)},
};

static void print_notes(FILE *out)
{
    fputs("\nPresets:\n"
          "  mild        people as they come to a door\n"
          "  strong      the same with strong expressions\n"
          "  crowd       mild, with another person behind\n"
          "  pairs       mild, two people at the door\n"
          "  texas       recorded like the Texas 3DFRD\n"
          "  hard        mild, people who look alike\n"
          "  pose        mild, turned by up to 35 degrees\n"
          "  poses       pose, and enrolled in five poses\n"
          "  bowed       mild, heads bent down or up by up to 35 degrees\n"
          "  far         mild, 0.9 to 1.2 m away\n"
          "  landmarks   strong, noisy, turned, every person several times\n"
          "  training    every person at rest, mild and strong, to train the metric\n"
          "  attacks     photographs, screens, masks, and living people for comparison\n"
          "  attacks-turned  the same, instruments turned by 25 to 40 degrees\n"
          "  not-faces   backs of heads, hands, walls, chairs, ...\n"
          "  stored      the project's own corpus; takes only --sensor and --seed\n"
          "\nSensors:\n",
          out);
    for (int i = 0; sim_sensors[i]; i++) {
        fprintf(out, "  %-14s  %s\n", sim_sensors[i]->name, sim_sensors[i]->summary);
    }
}

static int run(void *target, struct iso_fault *fault)
{
    const struct sim_generate_options *arguments = target;
    if (!arguments->ict_directory || !arguments->directory) {
        return iso_fault_set(fault, -EINVAL, "--ict and --out are needed");
    }
    return sim_generate(arguments, fault);
}

int sim_cmd_generate(int argc, char **argv)
{
    struct sim_generate_options arguments = sim_generate_options_default();
    const struct sim_option_set set = {options, sizeof options / sizeof *options, &arguments};
    const struct sim_command command = {
        .name = "generate",
        .needs = "--ict DIR --out DIR",
        .summary = "Renders a corpus of synthetic people. The same options make the same bytes.",
        .run = run,
        .notes = print_notes,
    };
    return sim_command_run(&command, &set, 1, argc, argv);
}
