/* isotherm-sim train: makes the data files that ship with the product. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/base/shipped.h"
#include "drivers/file/text.h"
#include "drivers/model/model_file.h"
#include "sim/base/make_directory.h"
#include "sim/base/options.h"
#include "sim/commands/command.h"
#include "sim/commands/commands.h"
#include "sim/lab/match/extract_options.h"
#include "sim/train/head/head_picture.h"
#include "sim/train/head/train_head.h"
#include "sim/train/metric/train_cohort.h"
#include "sim/train/metric/train_metric.h"

struct arguments {
    const char *ict, *out, *pictures, *model, *sensors, *corpora;
    int threads;
    size_t seed, n_people, n_vertices, n_identity, n_expression;
};

#define FIELD(name) offsetof(struct arguments, name)

static const struct sim_option head_options[] = {
    {"ict", "DIR", "the statistical head model to learn from", sim_option_text, FIELD(ict)},
    {"out", "FILE", "the model to write", sim_option_text, FIELD(out)},
    {"seed", "S", "seed of the expressions to learn from (1)", sim_option_count, FIELD(seed)},
    {"vertices", "N", "vertices to keep (1180)", sim_option_count, FIELD(n_vertices)},
    {"identity", "N", "modes of identity to keep (60)", sim_option_count, FIELD(n_identity)},
    {"expression", "N", "modes of expression to keep (12)", sim_option_count, FIELD(n_expression)},
    {"pictures", "DIR", "also draw the model, its mesh and its modes", sim_option_text,
     FIELD(pictures)},
};

static const struct sim_option cohort_options[] = {
    {"ict", "DIR", "the statistical head model to render", sim_option_text, FIELD(ict)},
    {"out", "FILE", "the templates to write", sim_option_text, FIELD(out)},
    {"model", "FILE", "the trained head model that the extractor uses", sim_option_text,
     FIELD(model)},
    {"sensor", "NAME,NAME,...", "sensor models, used in turn (astra)", sim_option_text,
     FIELD(sensors)},
    {"people", "N", "number of people (64)", sim_option_count, FIELD(n_people)},
    {"seed", "S", "seed of all random numbers (1)", sim_option_count, FIELD(seed)},
};

static const struct sim_option metric_options[] = {
    {"corpora", "DIR,DIR,...", "corpora of preset training to learn from; no person in two of them",
     sim_option_text, FIELD(corpora)},
    {"out", "FILE", "the metric to write", sim_option_text, FIELD(out)},
    {"model", "FILE", "the trained head model that the extractor uses", sim_option_text,
     FIELD(model)},
    {"threads", "N", "1..64 (a thread for each processor)", sim_option_threads, FIELD(threads)},
};

static int write_file(const char *path, const void *bytes, size_t size, struct iso_fault *fault)
{
    FILE *file = fopen(path, "wbe");
    if (!file) {
        return iso_fault_set(fault, -errno, "%s: %s", path, strerror(errno));
    }
    bool written = fwrite(bytes, 1, size, file) == size;
    written = fclose(file) == 0 && written;
    if (!written) {
        (void)remove(path);
        return iso_fault_set(fault, -EIO, "%s: cannot be written", path);
    }
    return 0;
}

static void print_head_report(const struct iso_head_model *model, size_t size,
                              const struct sim_train_head_report *r)
{
    printf("vertices            %u of %u; face %u, rigid %u\n", model->n_vertices,
           r->n_fine_vertices, r->n_face, r->n_rigid);
    printf("triangles           %u\n", model->n_triangles);
    printf("decimation error    %.2f mm mean, %.2f mm at 95%%, %.2f mm at most (face)\n",
           r->decimation_mean_mm, r->decimation_p95_mm, r->decimation_max_mm);
    printf("identity modes      %u, %.1f%% of variance\n", model->n_identity,
           100.0 * r->identity_explained);
    printf("unseen people       %.2f mm rms from the mean, %.2f mm from the modes\n",
           r->identity_rms_mm, r->unseen_rms_mm);
    printf("expression modes    %u, %.1f%% of variance\n", model->n_expression,
           100.0 * r->expression_explained);
    printf("expressions         %.2f mm rms from rest, %.2f mm from the modes\n",
           r->expression_rms_mm, r->expression_left_rms_mm);
    printf("file                %zu bytes\n", size);
}

static int save_head(const struct iso_head_model *model, const struct arguments *arguments,
                     const struct sim_train_head_report *report, struct iso_fault *fault)
{
    void *bytes = NULL;
    size_t size = 0;
    int error = iso_head_model_serialise(model, &bytes, &size);
    if (error) {
        return iso_fault_set(fault, error, "%s: %s", arguments->out,
                             error == -EFBIG ? "would be larger than a model may be"
                                             : strerror(-error));
    }
    error = write_file(arguments->out, bytes, size, fault);
    if (!error) {
        print_head_report(model, size, report);
    }
    free(bytes);
    return error;
}

static int draw_head(const struct iso_head_model *model, const char *directory,
                     struct iso_fault *fault)
{
    const int error = sim_make_directory(directory, fault);
    if (error) {
        return error;
    }
    return sim_head_pictures(model, directory, fault);
}

static int train_head(void *target, struct iso_fault *fault)
{
    const struct arguments *arguments = target;
    if (!arguments->ict || !arguments->out) {
        return iso_fault_set(fault, -EINVAL, "--ict and --out are needed");
    }
    if (arguments->n_vertices > ISO_HEAD_VERTICES_MAX ||
        arguments->n_identity > ISO_HEAD_IDENTITY_MAX ||
        arguments->n_expression > ISO_HEAD_EXPRESSION_MAX) {
        return iso_fault_set(fault, -EINVAL,
                             "at most %d vertices, %d identity modes and %d "
                             "expression modes",
                             ISO_HEAD_VERTICES_MAX, ISO_HEAD_IDENTITY_MAX, ISO_HEAD_EXPRESSION_MAX);
    }
    struct sim_train_head_options options = {
        .seed = arguments->seed,
        .n_vertices = (uint32_t)arguments->n_vertices,
        .n_identity = (uint32_t)arguments->n_identity,
        .n_expression = (uint32_t)arguments->n_expression,
    };
    struct sim_ict *ict = NULL;
    struct iso_head_model *model = NULL;
    struct sim_train_head_report report;
    int error = sim_ict_load(arguments->ict, &ict, fault);
    if (!error) {
        error = sim_train_head(ict, &options, &model, &report, fault);
    }
    if (!error) {
        error = save_head(model, arguments, &report, fault);
    }
    if (!error && arguments->pictures) {
        error = draw_head(model, arguments->pictures, fault);
    }
    iso_head_model_free(model);
    sim_ict_free(ict);
    return error;
}

/* Looks up comma-separated names of sensors and loads the modules that they need. */
static int find_sensors(const char *names, struct sim_train_cohort_options *options,
                        struct iso_fault *fault)
{
    options->n_sensors = 0;
    for (const char *at = names;; at++) {
        char name[ISO_TEMPLATE_SENSOR_MAX];
        const size_t length = strcspn(at, ",");
        (void)snprintf(name, sizeof name, "%.*s", (int)length, at);
        const struct sim_sensor *sensor = length < sizeof name ? sim_sensor_find(name) : NULL;
        if (!sensor) {
            return iso_fault_set(fault, -EINVAL, "--sensor: no sensor '%s'", name);
        }
        if (options->n_sensors == SIM_COHORT_SENSORS_MAX) {
            return iso_fault_set(fault, -EINVAL, "--sensor: more than %d", SIM_COHORT_SENSORS_MAX);
        }
        const int error = sim_sensor_load(sensor, fault);
        if (error) {
            return error;
        }
        options->sensors[options->n_sensors++] = sensor;
        at += length;
        if (*at == '\0') {
            return 0;
        }
    }
}

static int save_cohort(const struct iso_template *templates, uint32_t n, const char *path,
                       struct iso_fault *fault)
{
    const struct iso_template *list[ISO_COHORT_MAX];
    for (uint32_t i = 0; i < n; i++) {
        list[i] = &templates[i];
    }
    void *bytes = NULL;
    size_t size = 0;
    int error = iso_cohort_serialise(list, (int)n, &bytes, &size);
    if (error) {
        return iso_fault_set(fault, error, "%s: %s", path, strerror(-error));
    }
    error = write_file(path, bytes, size, fault);
    free(bytes);
    return error;
}

static int train_cohort(void *target, struct iso_fault *fault)
{
    const struct arguments *arguments = target;
    if (!arguments->ict || !arguments->out) {
        return iso_fault_set(fault, -EINVAL, "--ict and --out are needed");
    }
    struct sim_train_cohort_options options = {
        .extract = iso_extract_options_default(),
        .n_people = arguments->n_people > ISO_COHORT_MAX ? 0 : (uint32_t)arguments->n_people,
        .seed = arguments->seed,
    };
    struct sim_ict *ict = NULL;
    struct iso_head_model *model = NULL;
    struct iso_template *templates = NULL;
    struct sim_train_cohort_report report = {0, 0};
    int error = find_sensors(arguments->sensors, &options, fault);
    if (!error) {
        error = iso_head_model_load(arguments->model, &model, fault);
    }
    if (!error) {
        error = sim_ict_load(arguments->ict, &ict, fault);
    }
    if (!error) {
        options.ict = ict;
        options.model = model;
        error = sim_train_cohort(&options, &templates, &report, fault);
    }
    if (!error) {
        error = save_cohort(templates, report.n_people, arguments->out, fault);
    }
    if (!error) {
        printf("%u people, %u frames\n", report.n_people, report.n_frames);
    }
    if (templates) {
        explicit_bzero(templates, report.n_people * sizeof *templates);
    }
    free(templates);
    sim_ict_free(ict);
    iso_head_model_free(model);
    return error;
}

static int save_metric(const struct iso_metric *metric, const char *path, struct iso_fault *fault)
{
    void *bytes = NULL;
    size_t size = 0;
    int error = iso_metric_serialise(metric, &bytes, &size);
    if (error) {
        return iso_fault_set(fault, error, "%s: %s", path, strerror(-error));
    }
    error = write_file(path, bytes, size, fault);
    free(bytes);
    return error;
}

static void print_scores(const char *title, const struct sim_train_scores *s)
{
    printf("%-20s%zu mated comparisons, %zu others\n", title, s->n_mated, s->n_others);
    for (int i = 0; i < 3; i++) {
        printf("  at score %d        FMR %.2e, FNMR %.2f%%\n", 2 + i, s->fmr_at[i],
               100.0 * s->false_non_match_at[i]);
    }
}

static void print_metric_report(const struct sim_train_metric_report *r)
{
    printf("learned from        %zu people, %zu of %zu frames\n", r->n_people, r->n_templates,
           r->n_frames);
    printf("variance explained  %.1f%%\n", 100.0 * r->explained);
    print_scores("people held out", &r->metric);
    print_scores("fused with surfaces", &r->fused);
}

static int train_metric(void *target, struct iso_fault *fault)
{
    const struct arguments *arguments = target;
    if (!arguments->corpora || !arguments->out) {
        return iso_fault_set(fault, -EINVAL, "--corpora and --out are needed");
    }
    struct sim_train_metric_options options = sim_train_metric_options_default();
    char names[4096];
    char *words[SIM_METRIC_CORPORA_MAX];
    if ((size_t)snprintf(names, sizeof names, "%s", arguments->corpora) >= sizeof names) {
        return iso_fault_set(fault, -EINVAL, "--corpora: too long");
    }
    const size_t n = iso_text_split(names, ',', words, SIM_METRIC_CORPORA_MAX);
    if (n > SIM_METRIC_CORPORA_MAX) {
        return iso_fault_set(fault, -EINVAL, "--corpora: more than %d", SIM_METRIC_CORPORA_MAX);
    }
    for (size_t i = 0; i < n; i++) {
        options.corpora[options.n_corpora++] = words[i];
    }
    options.threads = arguments->threads > 0 ? arguments->threads
                                             : sim_threads_default(options.extract.heat);
    struct iso_head_model *model = NULL;
    struct iso_metric *metric = NULL;
    struct sim_train_metric_report report;
    int error = iso_head_model_load(arguments->model, &model, fault);
    if (!error) {
        options.model = model;
        error = sim_train_metric(&options, &metric, &report, fault);
    }
    if (!error) {
        error = save_metric(metric, arguments->out, fault);
    }
    if (!error) {
        print_metric_report(&report);
    }
    iso_metric_free(metric);
    iso_head_model_free(model);
    return error;
}

static const struct sim_subcommand targets[] = {
    {{"train head", "--ict DIR --out FILE",
      "Trains the compact head model with which faces are found and registered. The same\n"
      "options make the same bytes.",
      train_head, NULL},
     head_options,
     sizeof head_options / sizeof *head_options},
    {{"train cohort", "--ict DIR --out FILE",
      "Renders people who are in no gallery and writes their templates, which normalise\n"
      "scores. The same options make the same bytes.",
      train_cohort, NULL},
     cohort_options,
     sizeof cohort_options / sizeof *cohort_options},
    {{"train metric", "--corpora DIR,... --out FILE",
      "Learns from corpora of rendered people how likely it is that two templates are of one\n"
      "person. The same options make the same bytes.",
      train_metric, NULL},
     metric_options,
     sizeof metric_options / sizeof *metric_options},
};

int sim_cmd_train(int argc, char **argv)
{
    struct arguments arguments = {
        .model = iso_shipped_model(),
        .sensors = "astra",
        .seed = 1,
        .n_people = 64,
        .n_vertices = sim_train_head_options_default().n_vertices,
        .n_identity = sim_train_head_options_default().n_identity,
        .n_expression = sim_train_head_options_default().n_expression,
    };
    return sim_subcommand_run("train", targets, sizeof targets / sizeof *targets, &arguments, argc,
                              argv);
}
