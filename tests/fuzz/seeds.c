/* Writes the binary inputs with which fuzzing starts: the smallest valid ones.
 *
 * usage: fuzz_seeds DIRECTORY       (makes one folder for each target there) */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "core/match/cohort.h"
#include "drivers/file/png.h"
#include "isotherm/head_model.h"
#include "isotherm/metric.h"
#include "tests/fuzz/fuzz.h"

static char path[4096];

static const char *place(const char *directory, const char *target, const char *name)
{
    (void)snprintf(path, sizeof path, "%s/%s", directory, target);
    (void)mkdir(path, 0777);
    (void)snprintf(path, sizeof path, "%s/%s/%s", directory, target, name);
    return path;
}

static void write_file(const char *file, const void *bytes, size_t size)
{
    FILE *out = fopen(file, "wb");
    fuzz_check(out && fwrite(bytes, 1, size, out) == size && fclose(out) == 0, file);
}

static void write_pictures(const char *directory)
{
    static const struct {
        const char *name;
        enum iso_pixel pixel;
    } kinds[] = {
        {"grey8", ISO_PIXEL_GREY8}, {"grey16", ISO_PIXEL_GREY16}, {"rgb8", ISO_PIXEL_RGB8}};
    uint16_t samples[5 * 3 * 3];
    for (size_t i = 0; i < sizeof samples / sizeof *samples; i++) {
        samples[i] = (uint16_t)(257 * i);
    }
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        struct iso_image image = {
            .width_px = 5, .height_px = 3, .pixel = kinds[i].pixel, .samples = samples};
        struct iso_fault fault = {0};
        fuzz_check(iso_png_write(place(directory, "png", kinds[i].name), &image, 6, &fault) == 0,
                   fault.text);
    }
}

static void make_template(int person, struct iso_template *out)
{
    memset(out, 0, sizeof *out);
    *out = (struct iso_template){
        .algorithm = 7, .sensor = "astra", .n_radii = 1, .n_points = 4, .n_frames = 1};
    out->quality = 1.0f;
    out->radius_mm[0] = 18.0f;
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        for (int i = 0; i < out->n_points; i++) {
            float *p = out->points_mm[0][l][i];
            p[0] = (float)(7 * l - 40 + (i & 1) * 18);
            p[1] = (float)(5 * l * l % 60 - 30 + (i & 2) * 9);
            p[2] = (float)((l * i + person) % 11);
            out->weight[0][l][i] = 1.0f;
        }
    }
}

static void write_templates(const char *directory)
{
    struct iso_template people[ISO_COHORT_MIN];
    const struct iso_template *cohort[ISO_COHORT_MIN];
    for (int i = 0; i < ISO_COHORT_MIN; i++) {
        make_template(i, &people[i]);
        cohort[i] = &people[i];
    }
    uint8_t bytes[ISO_TEMPLATE_BYTES_MAX];
    int written = iso_template_serialise(&people[0], bytes, sizeof bytes);
    fuzz_check(written > 0, "a template");
    write_file(place(directory, "template", "one"), bytes, (size_t)written);

    void *file = NULL;
    size_t size = 0;
    fuzz_check(iso_cohort_serialise(cohort, ISO_COHORT_MIN, &file, &size) == 0, "a cohort");
    write_file(place(directory, "cohort", "eight"), file, size);
    free(file);
}

static void write_head_model(const char *directory)
{
    struct iso_head_model *model = NULL;
    void *file = NULL;
    size_t size = 0;
    fuzz_check(iso_head_model_new(4, 2, 1, 1, &model) == 0, "room for a head model");
    for (uint32_t i = 0; i < 4; i++) {
        model->mean_mm[i] = iso_vec3(10.0 * (i & 1), 12.0 * (i >> 1), i);
        model->region[i] = ISO_HEAD_FACE;
        model->identity_mm[3 * i] = (float)i;
        model->expression_mm[3 * i + 1] = 1.0f;
    }
    memcpy(model->triangles, (const uint32_t[2][3]){{0, 1, 2}, {1, 3, 2}},
           2 * sizeof *model->triangles);
    for (int i = 0; i < ISO_LANDMARKS_IBUG; i++) {
        model->landmarks[i] = (struct iso_head_point){(uint32_t)(i & 1), {0.25f, 0.25f, 0.5f}};
    }
    fuzz_check(iso_head_model_serialise(model, &file, &size) == 0, "a head model");
    write_file(place(directory, "head_model", "four_vertices"), file, size);
    free(file);
    iso_head_model_free(model);
}

static void write_metric(const char *directory)
{
    const struct iso_metric shape = {
        .algorithm = 81,
        .landmarks = 1,
        .n_radii = 1,
        .n_points = 4,
        .n_dimensions = 2,
        .weight_min = 0.25f,
        .gain = 1.0f,
        .n_origins = 1,
        .origin = {"train-1"},
        .n_nodes = 2,
        .node = {3, 8},
    };
    struct iso_metric *metric = NULL;
    void *file = NULL;
    size_t size = 0;
    fuzz_check(iso_metric_new(&shape, &metric) == 0, "room for a metric");
    for (int d = 0; d < metric->n_dimensions; d++) {
        metric->between[d] = 2.0f;
        metric->axis[d] = 0.5f;
    }
    fuzz_check(iso_metric_serialise(metric, &file, &size) == 0, "a metric");
    write_file(place(directory, "metric", "two_dimensions"), file, size);
    free(file);
    iso_metric_free(metric);
}

/* Two types, two changes and a rule (RFC 8536), after the empty data of version 1. */
static void write_zone(const char *directory)
{
    static const uint8_t file[] = {
        'T', 'Z', 'i', 'f', '2', 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,
        0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 'T', 'Z', 'i', 'f', '2', 0, 0, 0, 0, 0,
        0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0, 2, 0,
        0, 0, 4,
        /* times, their types */
        0, 0, 0, 0, 0x10, 0, 0, 0, 0, 0, 0, 0, 0x20, 0, 0, 0, 0, 1,
        /* types: offset, summer, letters */
        0, 0, 0x0e, 0x10, 0, 0, 0, 0, 0x1c, 0x20, 1, 0, 'C', 'E', 'T', 0};
    uint8_t whole[256];
    static const char rule[] = "\nCET-1CEST,M3.5.0,J300/3\n";
    memcpy(whole, file, sizeof file);
    memcpy(whole + sizeof file, rule, sizeof rule - 1);
    write_file(place(directory, "zone", "berlin"), whole, sizeof file + sizeof rule - 1);
}

int main(int argc, char **argv)
{
    if (argc != 2) {
        fprintf(stderr, "usage: %s DIRECTORY\n", argv[0]);
        return 2;
    }
    write_pictures(argv[1]);
    write_templates(argv[1]);
    write_head_model(argv[1]);
    write_metric(argv[1]);
    write_zone(argv[1]);
    return 0;
}
