/* isotherm-sim record: writes the frames of a sensor to a recording or to a file of OpenNI2. */
#include <errno.h>
#include <stddef.h>
#include <stdio.h>
#include <time.h>

#include "drivers/sensor/contract/sensor.h"
#include "drivers/terminal/words.h"
#include "sim/base/options.h"
#include "sim/commands/commands.h"
#include "sim/corpus/record.h"
#include "sim/corpus/sensor_word.h"

struct arguments {
    const char *sensor, *list, *out, *oni;
    size_t frames;
    int patience_ms;
};

#define FIELD(name) offsetof(struct arguments, name)

static const struct sim_option options[] = {
    {"sensor", "TYPE[:KEY=VALUE,...]", "back end and its options, see isotherm.conf(5)",
     sim_option_text, FIELD(sensor)},
    {"frames", "N", "number of frames", sim_option_count, FIELD(frames)},
    {"out", "DIR", "directory of the recording; created, or empty", sim_option_text, FIELD(out)},
    {"oni", "FILE", "let OpenNI2's own recorder write this file (sensor openni2 only)",
     sim_option_text, FIELD(oni)},
    {"patience-ms", "N", "longest wait for a frame (5000)", sim_option_int, FIELD(patience_ms)},
    {"list", "TYPE", "record nothing, but list the devices that this back end finds",
     sim_option_text, FIELD(list)},
};

static int64_t monotonic_ns(void *context)
{
    struct timespec now;
    (void)context;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * INT64_C(1000000000) + now.tv_nsec;
}

static int complain(const struct iso_fault *fault, int exit_code)
{
    fprintf(stderr, "isotherm-sim record: %s\n", fault->text);
    return exit_code;
}

static int exit_code(int error)
{
    switch (error) {
    case 0:
        return SIM_EXIT_OK;
    case -EINVAL:
    case -ENOSYS:
        return SIM_EXIT_USAGE;
    case -ENOENT:
    case -ENODEV:
        return SIM_EXIT_NOT_FOUND;
    case -ETIMEDOUT:
        return SIM_EXIT_TIMED_OUT;
    default:
        return SIM_EXIT_FAULT;
    }
}

/* ---- listing ---- */

static void print_device(const struct iso_sensor_device *device, void *context)
{
    size_t *n = context;
    printf("%s\t%s\n", device->id, device->label);
    (*n)++;
}

static int list(const char *type)
{
    struct iso_fault fault = {.text = ""};
    size_t n = 0;
    const int error = iso_sensor_probe(type, print_device, &n, &fault);
    if (error) {
        return complain(&fault, exit_code(error));
    }
    printf("%zu device%s\n", n, n == 1 ? "" : "s");
    return n > 0 ? SIM_EXIT_OK : SIM_EXIT_NOT_FOUND;
}

/* ---- recording ---- */

static void print_result(const struct sim_record_result *result)
{
    const struct iso_sensor_health *health = &result->health;
    printf("%zu %s in %.3f s; %llu lost, %llu of them dropped here, %zu damaged\n", result->frames,
           iso_plural(result->frames, "frame", "frames"), (double)result->span_ns * 1e-9,
           (unsigned long long)health->lost, (unsigned long long)health->device.dropped,
           result->damaged);
}

static int record(const struct arguments *arguments, struct sim_sensor_word *word,
                  struct iso_fault *fault)
{
    const struct sim_record_options wish = {
        .directory = arguments->out,
        .frames = arguments->frames,
        .patience_ns = arguments->patience_ms * INT64_C(1000000),
    };
    const struct iso_clock clock = {monotonic_ns, NULL};
    struct sim_record_result result = {0};
    struct iso_sensor *sensor = NULL;
    int error = arguments->oni ? sim_sensor_word_add(word, "record", arguments->oni, fault) : 0;
    if (!error) {
        error = iso_sensor_open(word->type, word->options, word->n_options, &clock, &sensor, fault);
    }
    if (!error) {
        error = iso_sensor_start(sensor, fault);
    }
    if (!error) {
        error = sim_record(sensor, &clock, &wish, &result, fault);
        print_result(&result);
    }
    iso_sensor_close(sensor);
    return error;
}

int sim_cmd_record(int argc, char **argv)
{
    struct arguments arguments = {.patience_ms = 5000};
    const struct sim_option_set set = {options, sizeof options / sizeof *options, &arguments};
    struct sim_sensor_word word = {0};
    struct iso_fault fault = {.text = ""};

    switch (sim_options_parse(argc, argv, &set, 1, &fault)) {
    case SIM_OPTIONS_HELP:
        puts("Usage: isotherm-sim record --sensor TYPE[:KEY=VALUE,...] --frames N --out DIR "
             "[OPTION...]\n"
             "       isotherm-sim record --list TYPE\n\n"
             "Records the frames of a sensor. Faces are biometric data: record only people who "
             "have\nagreed, and keep the files where nobody else can read them.\n");
        sim_options_help(&set, 1, stdout);
        return SIM_EXIT_OK;
    case SIM_OPTIONS_REFUSED:
        return complain(&fault, SIM_EXIT_USAGE);
    case SIM_OPTIONS_READ:
        break;
    }
    if (arguments.list) {
        return list(arguments.list);
    }
    if (!arguments.sensor || arguments.frames == 0 || (!arguments.out && !arguments.oni)) {
        (void)iso_fault_set(&fault, 0, "--sensor, --frames and --out or --oni are needed");
        return complain(&fault, SIM_EXIT_USAGE);
    }
    int error = sim_sensor_word_parse(arguments.sensor, &word, &fault);
    if (!error) {
        error = record(&arguments, &word, &fault);
    }
    sim_sensor_word_done(&word);
    return error ? complain(&fault, exit_code(error)) : SIM_EXIT_OK;
}
