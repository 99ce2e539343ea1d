#include "tests/bench/enrolled.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { PLACE_MAX = 4200 };

struct batch {
    struct iso_gallery_item *items;
    uint8_t (*bytes)[ISO_TEMPLATE_BYTES_MAX]; /* of all their templates */
};

int bench_ring_open(const char *path, struct iso_key_ring **out, struct iso_fault *fault)
{
    char ring[PLACE_MAX], key[PLACE_MAX];
    (void)snprintf(ring, sizeof ring, "%s.keys", path);
    (void)snprintf(key, sizeof key, "%s.key", path);
    const struct iso_key_place place = {.ring = ring, .file = key};
    return iso_key_ring_open(&place, out, fault);
}

int bench_gallery_open(const char *path, size_t people, const struct iso_metric *metric,
                       struct iso_key_ring *ring, struct iso_gallery **out, struct iso_fault *fault)
{
    const struct iso_gallery_options options = {
        .path = path,
        .capacity = (int)people,
        .algorithm = metric->algorithm,
        .metric = metric,
        .ring = ring,
    };
    return iso_gallery_open(&options, out, fault);
}

static int make_item(struct iso_gallery_item *item, uint8_t (*bytes)[ISO_TEMPLATE_BYTES_MAX],
                     size_t person, size_t templates, bench_person_function *make,
                     const void *context)
{
    *item = (struct iso_gallery_item){.person = {.enrolled_s = 1}, .n = templates};
    (void)snprintf(item->person.name, sizeof item->person.name, "person %zu", person);
    for (size_t k = 0; k < templates; k++) {
        const struct iso_template tmpl = make(context, person, k);
        const int size = iso_template_serialise(&tmpl, bytes[k], sizeof bytes[k]);
        if (size < 0) {
            return size;
        }
        item->templates[k].algorithm = tmpl.algorithm;
        item->templates[k].bytes = bytes[k];
        item->templates[k].size = (size_t)size;
    }
    return 0;
}

int bench_gallery_fill(struct iso_gallery *gallery, size_t people, size_t at_once, size_t templates,
                       bench_person_function *make, const void *context, struct iso_fault *fault)
{
    struct batch batch = {
        .items = calloc(at_once, sizeof *batch.items),
        .bytes = calloc(at_once * templates, sizeof *batch.bytes),
    };
    int error = batch.items && batch.bytes ? 0 : -ENOMEM;
    for (size_t first = 0; !error && first < people; first += at_once) {
        size_t n = 0, added = 0;
        for (; !error && n < at_once && first + n < people; n++) {
            error = make_item(&batch.items[n], &batch.bytes[n * templates], first + n, templates,
                              make, context);
        }
        if (error) {
            error = iso_fault_set(fault, error, "template: %s", strerror(-error));
        } else {
            error = iso_gallery_import(gallery, batch.items, n, false, NULL, &added, fault);
        }
    }
    free(batch.items);
    free(batch.bytes);
    return error;
}

void bench_gallery_remove(const char *path)
{
    static const char *const ends[] = {"", ".anchor", ".keys", ".key"};
    char file[PLACE_MAX];
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
        (void)snprintf(file, sizeof file, "%s%s", path, ends[i]);
        (void)unlink(file);
    }
}
