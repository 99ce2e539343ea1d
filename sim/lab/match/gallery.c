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

int sim_gallery_new(const struct sim_corpus *corpus, const struct sim_acquisition *acquisition,
                    size_t limit, struct sim_gallery **out)
{
    const size_t n = acquisition->n_samples;
    struct sim_gallery *g = calloc(1, sizeof *g);
    if (!g) {
        return -ENOMEM;
    }
    g->names = calloc(n, sizeof *g->names);
    g->n_templates_of = calloc(n, sizeof *g->n_templates_of);
    g->templates = calloc(n, sizeof *g->templates);
    g->person = calloc(n, sizeof *g->person);
    g->sample = calloc(n, sizeof *g->sample);
    if (!g->names || !g->n_templates_of || !g->templates || !g->person || !g->sample) {
        sim_gallery_free(g);
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
            g->templates[g->n_templates] = &sample->tmpl;
            g->sample[g->n_templates] = i;
            g->person[g->n_templates++] = person;
            g->n_templates_of[person]++;
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
