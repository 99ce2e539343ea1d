#include "sim/lab/match/training_set.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

struct lesson {
    void *knowledge; /* NULL: not learned yet */
    bool marks[SIM_MARKS];
};

struct sim_training_set {
    char *directory;
    struct sim_corpus *corpus;
    struct sim_acquisition *acquisition;
    struct sim_scans *faces;
    size_t n;
    const struct sim_scan **face; /* [n] */
    uint32_t *person;             /* [n] */
    uint32_t n_people;
    struct lesson lessons[SIM_METHODS];
};

void sim_training_set_free(struct sim_training_set *set)
{
    if (!set) {
        return;
    }
    for (size_t i = 0; i < SIM_METHODS; i++) {
        if (sim_methods[i]->forget) {
            sim_methods[i]->forget(set->lessons[i].knowledge);
        }
    }
    sim_scans_free(set->faces);
    sim_acquisition_free(set->acquisition);
    sim_corpus_free(set->corpus);
    free(set->directory);
    free(set->face);
    free(set->person);
    free(set);
}

static bool is_somebody(const struct sim_corpus_row *row)
{
    return strcmp(row->subject, "none") != 0;
}

/* Numbers people in the order of their first row. */
static int label(struct sim_training_set *set)
{
    const struct sim_acquisition *a = set->acquisition;
    const char **names = calloc(a->n_samples, sizeof *names);
    set->face = calloc(a->n_samples, sizeof *set->face);
    set->person = calloc(a->n_samples, sizeof *set->person);
    if (!names || !set->face || !set->person) {
        free(names);
        return -ENOMEM;
    }
    for (size_t i = 0; i < a->n_samples; i++) {
        const struct sim_corpus_row *row = &set->corpus->rows[a->samples[i].row];
        if (!a->samples[i].acquired || !is_somebody(row)) {
            continue;
        }
        uint32_t p = 0;
        while (p < set->n_people && strcmp(names[p], row->subject) != 0) {
            p++;
        }
        names[p] = row->subject;
        set->n_people += p == set->n_people;
        set->face[set->n] = set->faces->of_sample[i];
        set->person[set->n++] = p;
    }
    free(names);
    return 0;
}

static int say_memory(int error, const char *directory, struct iso_fault *fault)
{
    return error ? iso_fault_set(fault, error, "%s: out of memory", directory) : 0;
}

int sim_training_set_new(const char *directory, const struct sim_capture_options *options,
                         struct sim_training_set **out, struct iso_fault *fault)
{
    struct sim_training_set *set = calloc(1, sizeof *set);
    struct sim_capture_options watched = *options;
    if (!set) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", directory);
    }
    set->directory = strdup(directory);
    int error = set->directory ? sim_corpus_read(directory, &set->corpus, fault)
                               : iso_fault_set(fault, -ENOMEM, "%s: out of memory", directory);
    if (!error) {
        error = say_memory(sim_scans_new(set->corpus, &set->faces), directory, fault);
    }
    watched.inspect = sim_scans_inspect;
    watched.inspect_context = set->faces;
    if (!error) {
        error = sim_acquire(directory, set->corpus, &watched, 1, &set->acquisition, fault);
    }
    if (!error) {
        error = sim_scans_fuse(directory, set->corpus, set->acquisition, set->faces, fault);
    }
    if (!error) {
        error = say_memory(label(set), directory, fault);
    }
    if (error) {
        sim_training_set_free(set);
        return error;
    }
    *out = set;
    return 0;
}

size_t sim_training_set_faces(const struct sim_training_set *set)
{
    return set->n;
}

uint32_t sim_training_set_people(const struct sim_training_set *set)
{
    return set->n_people;
}

static bool says_who(const struct sim_corpus *corpus)
{
    for (size_t i = 0; i < corpus->n_rows; i++) {
        if (is_somebody(&corpus->rows[i]) && corpus->rows[i].note[0] == '\0') {
            return false;
        }
    }
    return true;
}

int sim_training_set_check(const struct sim_training_set *set, const char *directory,
                           const struct sim_corpus *corpus, bool *known, struct iso_fault *fault)
{
    if (strcmp(set->directory, directory) == 0) {
        return iso_fault_set(fault, -EINVAL, "%s: is both the training and the test corpus",
                             directory);
    }
    for (size_t i = 0; i < corpus->n_rows; i++) {
        const struct sim_corpus_row *row = &corpus->rows[i];
        for (size_t k = 0; is_somebody(row) && k < set->corpus->n_rows; k++) {
            const struct sim_corpus_row *learned = &set->corpus->rows[k];
            if (is_somebody(learned) && sim_corpus_row_is_of(row, learned->note)) {
                return iso_fault_set(fault, -EINVAL, "%s: the people of %s (%s) are tested in %s",
                                     set->directory, learned->recording, learned->note, directory);
            }
        }
    }
    *known = says_who(set->corpus) && says_who(corpus);
    return 0;
}

int sim_training_set_teach(struct sim_training_set *set, const struct sim_method *method,
                           const bool marks[SIM_MARKS], const void **knowledge,
                           struct iso_fault *fault)
{
    size_t i = 0;
    while (sim_methods[i] && sim_methods[i] != method) {
        i++;
    }
    struct lesson *lesson = &set->lessons[i];
    bool known[SIM_MARKS]; /* known in every face of the training set as well */
    for (int m = 0; m < SIM_MARKS; m++) {
        known[m] = method->marked && marks[m];
        for (size_t f = 0; f < set->n && known[m]; f++) {
            known[m] = set->face[f]->mark_known[m];
        }
    }
    if (method->train && lesson->knowledge && memcmp(known, lesson->marks, sizeof known) != 0) {
        method->forget(lesson->knowledge);
        lesson->knowledge = NULL;
    }
    if (method->train && !lesson->knowledge) {
        const struct sim_training training = {set->n, set->face, set->person, set->n_people, known};
        const int error = method->train(&training, &lesson->knowledge, fault);
        if (error) {
            return error;
        }
        memcpy(lesson->marks, known, sizeof known);
    }
    *knowledge = lesson->knowledge;
    return 0;
}
