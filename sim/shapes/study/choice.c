#include "sim/shapes/study/choice.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/file/text.h"
#include "sim/shapes/learn/learn.h"

enum { NAMES_MAX = 32 };

static const struct iso_classifier_ops *const *const tables[] = {iso_classifiers,
                                                                 iso_learn_classifiers};
enum { TABLES = sizeof tables / sizeof *tables };

static void append(char *text, size_t size, const char *name)
{
    const size_t used = strlen(text);
    (void)snprintf(text + used, size - used, "%s%s", used ? ", " : "", name);
}

int sim_choice_method(const char *name, const struct iso_shape_method **out,
                      struct iso_fault *fault)
{
    char known[200] = "";
    const struct iso_shape_method *method = iso_shape_method_find(name);
    for (int m = 0; !method && iso_shape_methods[m]; m++) {
        append(known, sizeof known, iso_shape_methods[m]->name);
    }
    if (!method) {
        return iso_fault_set(fault, -EINVAL, "--method: '%.20s' is unknown; known: %s", name,
                             known);
    }
    *out = method;
    return 0;
}

static int add_method(const char *name, struct sim_choice *choice, struct iso_fault *fault)
{
    const struct iso_shape_method *method = NULL;
    const int error = sim_choice_method(name, &method, fault);
    for (int m = 0; m < choice->n_methods && !error; m++) {
        if (choice->method[m] == method) {
            return 0;
        }
    }
    if (!error && choice->n_methods < SIM_CHOICE_METHODS_MAX) {
        choice->method[choice->n_methods++] = method;
    }
    return error;
}

static int add_all_methods(struct sim_choice *choice, struct iso_fault *fault)
{
    int error = 0;
    choice->all_methods = true;
    for (int m = 0; iso_shape_methods[m] && !error; m++) {
        error = add_method(iso_shape_methods[m]->name, choice, fault);
    }
    return error;
}

/* A classifier whose module is not installed is left out of all, but not if it was named. */
static int add_classifier(const struct iso_classifier_ops *classifier, bool named,
                          struct sim_choice *choice, struct iso_fault *fault)
{
    struct iso_fault why = {.text = ""};
    for (int c = 0; c < choice->n_classifiers; c++) {
        if (choice->classifier[c] == classifier) {
            return 0;
        }
    }
    const int error = iso_learn_load(classifier, &why);
    if (error == -ENOENT && !named) {
        fprintf(stderr, "isotherm-sim: %s left out: %s\n", classifier->name, why.text);
        return 0;
    }
    if (!error && choice->n_classifiers < SIM_CHOICE_CLASSIFIERS_MAX) {
        choice->classifier[choice->n_classifiers++] = classifier;
    }
    return error ? iso_fault_set(fault, error, "%s", why.text) : 0;
}

static int add_classifiers(const char *name, struct sim_choice *choice, struct iso_fault *fault)
{
    const bool all = strcmp(name, "all") == 0;
    char known[200] = "";
    int error = 0, found = 0;
    for (int t = 0; t < TABLES; t++) {
        for (int c = 0; tables[t][c] && !error; c++) {
            append(known, sizeof known, tables[t][c]->name);
            if (all || strcmp(tables[t][c]->name, name) == 0) {
                error = add_classifier(tables[t][c], !all, choice, fault);
                found++;
            }
        }
    }
    if (!error && found == 0) {
        error = iso_fault_set(fault, -EINVAL, "--classifier: '%.20s' is unknown; known: %s", name,
                              known);
    }
    return error;
}

/* Calls `add` for each name of a text with commas. */
static int each_name(const char *text, struct sim_choice *choice,
                     int (*add)(const char *name, struct sim_choice *choice,
                                struct iso_fault *fault),
                     struct iso_fault *fault)
{
    char *copy = strdup(text), *name[NAMES_MAX];
    if (!copy) {
        return iso_fault_set(fault, -ENOMEM, "out of memory");
    }
    const size_t n = iso_text_split(copy, ',', name, NAMES_MAX);
    int error = n <= NAMES_MAX ? 0 : iso_fault_set(fault, -EINVAL, "'%.60s': too many names", text);
    for (size_t i = 0; i < n && !error; i++) {
        error = add(name[i], choice, fault);
    }
    free(copy);
    return error;
}

bool sim_choice_fits(const struct iso_shape_method *method,
                     const struct iso_classifier_ops *classifier)
{
    return method->norm != ISO_NORM_PARTIAL || strcmp(classifier->name, "nn") == 0;
}

/* Methods of "all" that no classifier fits are left out when they are measured. */
static int check_fit(const struct sim_choice *choice, struct iso_fault *fault)
{
    for (int m = 0; m < choice->n_methods && !choice->all_methods; m++) {
        bool fits = choice->n_classifiers == 0;
        for (int c = 0; c < choice->n_classifiers; c++) {
            fits = fits || sim_choice_fits(choice->method[m], choice->classifier[c]);
        }
        if (!fits) {
            return iso_fault_set(fault, -EINVAL,
                                 "--classifier: the features of %s are no vectors, so that only nn "
                                 "can compare them",
                                 choice->method[m]->name);
        }
    }
    return 0;
}

int sim_choice_read(const struct sim_option_texts *methods,
                    const struct sim_option_texts *classifiers, struct sim_choice *out,
                    struct iso_fault *fault)
{
    struct sim_choice choice = {.n_methods = 0};
    int error = 0;
    for (size_t i = 0; i < methods->n && !error; i++) {
        error = strcmp(methods->text[i], "all") == 0
                    ? add_all_methods(&choice, fault)
                    : each_name(methods->text[i], &choice, add_method, fault);
    }
    if (!error && methods->n == 0) {
        error = add_all_methods(&choice, fault);
    }
    for (size_t i = 0; i < classifiers->n && !error; i++) {
        error = each_name(classifiers->text[i], &choice, add_classifiers, fault);
    }
    if (!error) {
        error = check_fit(&choice, fault);
    }
    if (!error) {
        *out = choice;
    }
    return error;
}

void sim_choice_without_colours(struct sim_choice *choice)
{
    int n = 0;
    for (int m = 0; choice->all_methods && m < choice->n_methods; m++) {
        if (!choice->method[m]->colour) {
            choice->method[n++] = choice->method[m];
        }
    }
    choice->n_methods = choice->all_methods ? n : choice->n_methods;
}

void sim_choice_names(FILE *out)
{
    fputs("\nMethods, each with its own classifier:\n", out);
    for (int m = 0; iso_shape_methods[m]; m++) {
        const struct iso_shape_method *method = iso_shape_methods[m];
        fprintf(out, "  %-13s %-13s %s%s\n", method->name, method->classifier, method->source,
                method->colour ? "; needs colours" : "");
    }
    fputs("\nClassifiers:\n", out);
    for (int t = 0; t < TABLES; t++) {
        for (int c = 0; tables[t][c]; c++) {
            fprintf(out, "  %-13s %s\n", tables[t][c]->name, tables[t][c]->title);
        }
    }
}
