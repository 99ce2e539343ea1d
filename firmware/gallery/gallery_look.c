/* Finds people in the gallery, and the candidates that a probe is compared with. */
#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>

#include "firmware/gallery/gallery_seal.h"
#include "firmware/gallery/gallery_state.h"

const struct iso_person *iso_gallery_people(const struct iso_gallery *gallery, size_t *n)
{
    *n = iso__gallery_is_lost(gallery) ? 0 : gallery->memory.n_people;
    return gallery->memory.people;
}

const struct iso_person *iso_gallery_find(const struct iso_gallery *gallery, const char *name)
{
    const struct iso_gallery_memory *memory = &gallery->memory;
    const struct iso_person *same = NULL;
    struct iso_person_name_key key;
    const bool has_key = iso_person_name_key(name, &key) == 0;
    for (size_t i = 0; i < memory->n_people && !iso__gallery_is_lost(gallery); i++) {
        const struct iso_person *person = &memory->people[i];
        if (strcmp(person->name, name) == 0) {
            return person;
        }
        if (has_key && !same && iso_person_name_key_is_same(&person->key, &key)) {
            same = person;
        }
    }
    return same;
}

size_t iso_gallery_same_names(const struct iso_gallery *gallery)
{
    return gallery->memory.same_names;
}

const struct iso_person *iso_gallery_find_id(const struct iso_gallery *gallery, int64_t id)
{
    return iso__gallery_is_lost(gallery) ? NULL : iso_gallery_memory_find(&gallery->memory, id);
}

static int open_templates(void *owner, int64_t person, struct iso_template *out, int capacity,
                          int *n, struct iso_fault *fault)
{
    return iso_gallery_templates(owner, person, out, capacity, n, fault);
}

struct iso_candidate_list iso_gallery_everybody(struct iso_gallery *gallery)
{
    if (iso__gallery_is_lost(gallery)) {
        return (struct iso_candidate_list){0};
    }
    const struct iso_site_index *site = gallery->memory.site;
    const struct iso_index *index = site ? iso_site_index_current(site) : NULL;
    return (struct iso_candidate_list){
        .entries = gallery->memory.entries,
        .n_entries = (int)gallery->memory.n_entries,
        .index = index,
        .site = site,
        .templates = open_templates,
        .owner = gallery,
        .version = iso_gallery_version(gallery).changes,
    };
}

struct iso_candidate_list iso_gallery_only(struct iso_gallery *gallery, int64_t person)
{
    const struct iso_gallery_memory *memory = &gallery->memory;
    struct iso_metric_vector vector;
    if (iso__gallery_is_lost(gallery)) {
        return (struct iso_candidate_list){0};
    }
    if (memory->site) {
        struct iso_candidate_list own = iso_gallery_everybody(gallery);
        const int error = iso_index_find(own.index, person, &vector);
        sodium_memzero(&vector, sizeof vector);
        own.person = person;
        return error ? (struct iso_candidate_list){0} : own;
    }
    size_t first = 0, end;
    while (first < memory->n_entries && memory->entries[first].person != person) {
        first++;
    }
    end = first;
    while (end < memory->n_entries && memory->entries[end].person == person) {
        end++;
    }
    return first == end ? (struct iso_candidate_list){0}
                        : (struct iso_candidate_list){.entries = memory->entries + first,
                                                      .n_entries = (int)(end - first)};
}

struct fetching {
    const struct iso_gallery *gallery;
    struct iso_template *out;
    int n, capacity;
    uint32_t seen;
};

static int fetch_template(void *context, const struct iso_gallery_place *place, const void *bytes,
                          size_t size, struct iso_fault *fault)
{
    struct fetching *fetching = context;
    fetching->seen++;
    if (place->algorithm != fetching->gallery->memory.algorithm ||
        fetching->n == fetching->capacity) {
        return 0;
    }
    const int error = iso_template_parse(bytes, size, &fetching->out[fetching->n]);
    fetching->n += !error;
    return error && error != -EPROTONOSUPPORT
               ? iso_gallery_db_damaged(fetching->gallery->db, "a template cannot be read", fault)
               : 0;
}

int iso_gallery_templates(struct iso_gallery *gallery, int64_t person, struct iso_template *out,
                          int capacity, int *n, struct iso_fault *fault)
{
    const struct iso_person *own = iso_gallery_find_id(gallery, person);
    struct fetching fetching = {gallery, out, 0, capacity, 0};
    const struct iso_gallery_visitor visitor = {.template = fetch_template, .context = &fetching};
    if (!own) {
        return iso_fault_set(fault, -ENOENT, "nobody has the number %lld", (long long)person);
    }
    int error = iso_gallery_db_templates(gallery->db, person, &visitor, fault);
    if (!error && fetching.seen != own->templates) {
        error = iso_gallery_db_damaged(gallery->db, "records are missing", fault);
    }
    if (error) {
        sodium_memzero(out, (size_t)fetching.n * sizeof *out);
        return error;
    }
    *n = fetching.n;
    return 0;
}

void iso_gallery_memory_set_sensor(struct iso_gallery_memory *memory, const char *sensor)
{
    (void)snprintf(memory->sensor, sizeof memory->sensor, "%s", sensor);
    if (memory->site) {
        iso_site_index_set_sensor(memory->site, memory->sensor);
    }
}

void iso_gallery_set_sensor(struct iso_gallery *gallery, const char *model)
{
    iso_gallery_memory_set_sensor(&gallery->memory, model);
}

bool iso_gallery_is_other(const struct iso_gallery *gallery, int64_t person)
{
    return gallery->memory.site && !iso__gallery_is_lost(gallery) &&
           iso_site_index_is_other(gallery->memory.site, person);
}

size_t iso_gallery_site_other(const struct iso_gallery *gallery)
{
    size_t n = 0;
    for (size_t i = 0; i < gallery->memory.n_people; i++) {
        n += iso_gallery_is_other(gallery, gallery->memory.people[i].id);
    }
    return n;
}

bool iso_gallery_follow_site(struct iso_gallery *gallery)
{
    return gallery->memory.site && iso_site_index_follow(gallery->memory.site);
}

struct iso_site_state iso_gallery_site(struct iso_gallery *gallery)
{
    return gallery->memory.site ? iso_site_index_state(gallery->memory.site)
                                : (struct iso_site_state){.adapts = false};
}

bool iso_gallery_site_estimate(struct iso_gallery *gallery, struct iso_site_estimate *out)
{
    return gallery->memory.site && !iso__gallery_is_lost(gallery) &&
           iso_site_index_estimate(gallery->memory.site, out);
}
