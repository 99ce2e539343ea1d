#include "sim/lab/match/gallery.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

size_t sim_gallery_find(const struct sim_gallery *gallery, const char *name)
{
    for (size_t i = 0; i < gallery->n_people; i++) {
        if (strcmp(gallery->names[i], name) == 0) {
            return i;
        }
    }
    return SIM_NOBODY;
}

/* The person's number. A new person is added up to the limit; SIM_NOBODY beyond it. */
static size_t add_person(struct sim_gallery *gallery, const char *name, size_t limit)
{
    size_t person = sim_gallery_find(gallery, name);
    if (person == SIM_NOBODY && gallery->n_people < limit) {
        person = gallery->n_people++;
        gallery->names[person] = name;
    }
    return person;
}

/* A gallery with room for n people and n templates, or NULL. */
static struct sim_gallery *allocate(size_t n)
{
    struct sim_gallery *g = calloc(1, sizeof *g);
    if (!g) {
        return NULL;
    }
    g->names = calloc(n + 1, sizeof *g->names);
    g->n_templates_of = calloc(n + 1, sizeof *g->n_templates_of);
    g->templates = calloc(n + 1, sizeof *g->templates);
    g->person = calloc(n + 1, sizeof *g->person);
    g->sample = calloc(n + 1, sizeof *g->sample);
    if (!g->names || !g->n_templates_of || !g->templates || !g->person || !g->sample) {
        sim_gallery_free(g);
        return NULL;
    }
    return g;
}

static void add_template(struct sim_gallery *g, size_t person, const struct iso_template *tmpl,
                         size_t sample)
{
    g->templates[g->n_templates] = tmpl;
    g->sample[g->n_templates] = sample;
    g->person[g->n_templates++] = person;
    g->n_templates_of[person]++;
}

int sim_gallery_new(const struct sim_corpus *corpus, const struct sim_acquisition *acquisition,
                    size_t limit, struct sim_gallery **out)
{
    const size_t n = acquisition->n_samples;
    struct sim_gallery *g = allocate(n);
    if (!g) {
        return -ENOMEM;
    }
    for (size_t i = 0; i < n; i++) {
        const struct sim_sample *sample = &acquisition->samples[i];
        const struct sim_corpus_row *row = &corpus->rows[sample->row];
        if (row->role != SIM_ROLE_GALLERY) {
            continue;
        }
        const size_t person = add_person(g, row->subject, limit > 0 ? limit : n);
        if (person != SIM_NOBODY && sample->acquired) {
            add_template(g, person, &sample->tmpl, i);
        }
    }
    *out = g;
    return 0;
}

int sim_gallery_part(const struct sim_gallery *gallery, const bool *keep, struct sim_gallery **out)
{
    const size_t most = gallery->n_templates > gallery->n_people ? gallery->n_templates
                                                                 : gallery->n_people;
    struct sim_gallery *g = allocate(most);
    if (!g) {
        return -ENOMEM;
    }
    g->teaching = gallery->teaching;
    for (size_t p = 0; p < gallery->n_people; p++) {
        if (keep[p]) {
            g->names[g->n_people++] = gallery->names[p];
        }
    }
    for (size_t i = 0; i < gallery->n_templates; i++) {
        const size_t person = gallery->person[i];
        if (keep[person]) {
            add_template(g, sim_gallery_find(g, gallery->names[person]), gallery->templates[i],
                         gallery->sample[i]);
        }
    }
    *out = g;
    return 0;
}

void sim_gallery_free(struct sim_gallery *gallery)
{
    if (gallery) {
        free(gallery->names);
        free(gallery->n_templates_of);
        free(gallery->templates);
        free(gallery->person);
        free(gallery->sample);
        free(gallery);
    }
}
