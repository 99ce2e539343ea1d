#include "sim/lab/eval/method_options.h"

#include <errno.h>
#include <string.h>

#include "drivers/file/text.h"
#include "drivers/model/model_file.h"
#include "sim/lab/match/extract_options.h"

static bool contains(const struct sim_method_choice *choice, const struct sim_method *method)
{
    for (size_t i = 0; i < choice->n; i++) {
        if (choice->methods[i] == method) {
            return true;
        }
    }
    return false;
}

int sim_option_methods(const char *text, void *field)
{
    char copy[256], *words[SIM_METHODS + 1];
    struct sim_method_choice choice = {0};
    if (strcmp(text, "all") == 0) {
        choice.all = true;
        choice.n = SIM_METHODS;
        memcpy(choice.methods, sim_methods, sizeof choice.methods);
        *(struct sim_method_choice *)field = choice;
        return 0;
    }
    if ((size_t)snprintf(copy, sizeof copy, "%s", text) >= sizeof copy) {
        return -EINVAL;
    }
    const size_t n = iso_text_split(copy, ',', words, SIM_METHODS);
    for (size_t i = 0; i < n && n <= SIM_METHODS; i++) {
        const struct sim_method *method = sim_method_find(words[i]);
        if (!method || contains(&choice, method)) {
            return -EINVAL;
        }
        choice.methods[choice.n++] = method;
    }
    if (choice.n == 0 || choice.n != n) {
        return -EINVAL;
    }
    *(struct sim_method_choice *)field = choice;
    return 0;
}

void sim_method_choice_help(FILE *out)
{
    fputs("\nMethods:\n", out);
    for (size_t i = 0; sim_methods[i]; i++) {
        fprintf(out, "  %-16s%s%s\n", sim_methods[i]->name, sim_methods[i]->source,
                sim_methods[i]->train ? " (learns: --train)" : "");
    }
}

static bool learns(const struct sim_method_choice *choice)
{
    for (size_t i = 0; i < choice->n; i++) {
        if (choice->methods[i]->train) {
            return true;
        }
    }
    return false;
}

int sim_method_choice_apply(const struct sim_method_choice *choice, const char *directory,
                            struct sim_eval_options *options, struct sim_training_set **training,
                            struct iso_fault *fault)
{
    options->n_methods = choice->n;
    options->lenient = choice->all;
    memcpy(options->methods, choice->methods, sizeof options->methods);
    if (!directory || !learns(choice)) {
        return 0;
    }
    struct sim_capture_options capture = {.extract = options->extract, .threads = options->threads};
    struct iso_head_model *model = NULL;
    int error = sim_threads_check(options->threads, options->extract.heat, fault);
    if (!error) {
        error = iso_head_model_load(options->model, &model, fault);
    }
    if (!error) {
        capture.model = model;
        error = sim_training_set_new(directory, &capture, training, fault);
    }
    iso_head_model_free(model);
    if (!error) {
        options->training = *training;
    }
    return error;
}
