/* Measures how long the stores take to open when the gallery is full: keys, gallery and log, as the
 * daemon opens them before it opens the sensor. Templates have the size of the product's.
 *
 *   bench_start DIRECTORY [PEOPLE]      an empty directory, on the disk that is meant; 1000 people
 */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "firmware/audit.h"
#include "firmware/gallery.h"
#include "firmware/key_ring.h"

enum {
    PEOPLE = 1000,
    AT_ONCE = 500,
    ROUNDS = 7,
    RADII = 3,
    ALGORITHM = 0x51,
    TEMPLATE_MAX = 16384
};

struct paths {
    char gallery[4096], log[4096], ring[4096], key[4096];
};

static double ms(clockid_t clock)
{
    struct timespec now;
    (void)clock_gettime(clock, &now);
    return (double)now.tv_sec * 1e3 + (double)now.tv_nsec / 1e6;
}

static void check(int error, const char *what, const struct iso_fault *fault)
{
    if (error) {
        (void)fprintf(stderr, "bench_start: %s: %s\n", what,
                      fault->text[0] ? fault->text : strerror(-error));
        exit(1);
    }
}

static struct paths paths_in(const char *directory)
{
    struct paths paths;
    (void)snprintf(paths.gallery, sizeof paths.gallery, "%s/gallery.db", directory);
    (void)snprintf(paths.log, sizeof paths.log, "%s/audit.log", directory);
    (void)snprintf(paths.ring, sizeof paths.ring, "%s/gallery.db.keys", directory);
    (void)snprintf(paths.key, sizeof paths.key, "%s/gallery.db.key", directory);
    return paths;
}

static struct iso_key_ring *open_ring(const struct paths *paths)
{
    const struct iso_key_place place = {.ring = paths->ring, .file = paths->key};
    struct iso_key_ring *ring = NULL;
    struct iso_fault fault = {""};
    check(iso_key_ring_open(&place, &ring, &fault), "keys", &fault);
    return ring;
}

static struct iso_gallery *open_gallery(const struct paths *paths, struct iso_key_ring *ring, int n)
{
    const struct iso_gallery_options options = {
        .path = paths->gallery, .capacity = n, .algorithm = ALGORITHM, .ring = ring};
    struct iso_gallery *gallery = NULL;
    struct iso_fault fault = {""};
    check(iso_gallery_open(&options, &gallery, &fault), "gallery", &fault);
    return gallery;
}

/* A face of random numbers: nothing here looks at its shape. */
static int draw_template(unsigned *seed, void *bytes)
{
    struct iso_template t = {.algorithm = ALGORITHM,
                             .sensor = "bench",
                             .n_radii = RADII,
                             .n_points = ISO_TEMPLATE_POINTS_MAX,
                             .n_frames = 5,
                             .quality = 0.9f,
                             .radius_mm = {10, 15, 20}};
    for (int r = 0; r < RADII; r++) {
        for (int l = 0; l < ISO_LANDMARKS; l++) {
            for (int i = 0; i < t.n_points; i++) {
                for (int k = 0; k < 3; k++) {
                    *seed = *seed * 1664525u + 1013904223u;
                    t.points_mm[r][l][i][k] = (float)(int)(*seed >> 16) / 256.0f - 128.0f;
                }
                t.weight[r][l][i] = 1;
            }
        }
    }
    return iso_template_serialise(&t, bytes, TEMPLATE_MAX);
}

static void fill(const struct paths *paths, int n)
{
    struct iso_key_ring *ring = open_ring(paths);
    struct iso_gallery *gallery = open_gallery(paths, ring, n);
    struct iso_gallery_item *items = calloc(AT_ONCE, sizeof *items);
    unsigned char *bytes = malloc((size_t)AT_ONCE * TEMPLATE_MAX);
    struct iso_fault fault = {""};
    unsigned seed = 1;
    size_t added = 0;
    if (!items || !bytes) {
        check(-ENOMEM, "people", &fault);
    }
    for (int first = 0; first < n; first += AT_ONCE) {
        const int some = n - first < AT_ONCE ? n - first : AT_ONCE;
        for (int i = 0; i < some; i++) {
            struct iso_gallery_item *item = &items[i];
            unsigned char *place = bytes + (size_t)i * TEMPLATE_MAX;
            (void)snprintf(item->person.name, sizeof item->person.name, "person %d", first + i);
            item->person.enrolled_s = 1;
            item->n = 1;
            item->templates[0].algorithm = ALGORITHM;
            item->templates[0].bytes = place;
            item->templates[0].size = (size_t)draw_template(&seed, place);
        }
        check(iso_gallery_import(gallery, items, (size_t)some, false, &added, &fault), "people",
              &fault);
    }
    printf("%d people, a template of %zu bytes each\n", n, items[0].templates[0].size);
    free(bytes);
    free(items);
    iso_gallery_close(gallery);
    iso_key_ring_close(ring);
}

static void start(const struct paths *paths, int n)
{
    const struct iso_times times = iso_times_system();
    struct iso_fault fault = {""};
    struct iso_audit *audit = NULL;
    const double wall_ms = ms(CLOCK_MONOTONIC), cpu_ms = ms(CLOCK_PROCESS_CPUTIME_ID);
    struct iso_key_ring *ring = open_ring(paths);
    const double keys_ms = ms(CLOCK_MONOTONIC);
    struct iso_gallery *gallery = open_gallery(paths, ring, n);
    const double gallery_ms = ms(CLOCK_MONOTONIC);
    const struct iso_audit_options options = {.path = paths->log, .sync = true, .ring = ring};
    check(iso_audit_open(&options, &times, &audit, &fault), "log", &fault);
    printf("start %8.1f ms (processor %8.1f ms): keys %6.1f, gallery %8.1f, log %6.1f ms\n",
           ms(CLOCK_MONOTONIC) - wall_ms, ms(CLOCK_PROCESS_CPUTIME_ID) - cpu_ms, keys_ms - wall_ms,
           gallery_ms - keys_ms, ms(CLOCK_MONOTONIC) - gallery_ms);
    iso_audit_close(audit);
    iso_gallery_close(gallery);
    iso_key_ring_close(ring);
}

int main(int argc, char **argv)
{
    const int n = argc > 2 ? atoi(argv[2]) : PEOPLE;
    if (argc < 2 || n < 1) {
        (void)fprintf(stderr, "usage: bench_start DIRECTORY [PEOPLE]\n");
        return 2;
    }
    const struct paths paths = paths_in(argv[1]);
    fill(&paths, n);
    for (int i = 0; i < ROUNDS; i++) {
        start(&paths, n);
    }
    return 0;
}
