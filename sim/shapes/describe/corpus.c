#include "sim/shapes/describe/corpus.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/base/path.h"
#include "drivers/terminal/words.h"
#include "sim/base/result_file.h"
#include "sim/lab/match/parallel.h"

struct seen {
    int error;
    struct sim_source_look look;
    struct iso_fault fault;
};

struct work {
    const struct sim_corpus_look *how;
    const struct sim_shape_manifest *manifest;
    struct seen *seen; /* [manifest->n] */
};

static int look_at(void *context, int worker, size_t number)
{
    struct work *work = context;
    struct seen *seen = &work->seen[number];
    const struct sim_source_options options = {.mend = work->how->mend,
                                               .neighbours = work->how->neighbours};
    char path[PATH_MAX];
    (void)worker;
    seen->error = iso_path_join(work->how->directory, work->manifest->rows[number].file, path,
                                &seen->fault);
    if (!seen->error) {
        seen->error = sim_source_look(path, &options, &seen->look, &seen->fault);
    }
    if (!seen->error && work->how->colours_needed && !seen->look.colours) {
        seen->error = iso_fault_set(&seen->fault, -ENODATA,
                                    "%s: a method needs colours, and the file has none", path);
    }
    return seen->error && work->how->strict ? seen->error : 0;
}

static void write_meshes(const void *context, FILE *out)
{
    const struct work *work = context;
    fputs("file,class,state,vertices,triangles,parts,vertices_left_out,area_left_out,"
          "merged_vertices,repeated_triangles,triangles_without_area,unused_vertices\n",
          out);
    for (int32_t i = 0; i < work->manifest->n; i++) {
        const struct sim_shape_row *row = &work->manifest->rows[i];
        const struct seen *seen = &work->seen[i];
        const struct iso_part_survey *part = &seen->look.part;
        const struct iso_mesh_mended *mended = &seen->look.mended;
        fprintf(out, "%s,%s,", row->file, row->class_name);
        if (seen->error) {
            fprintf(out, "left out,,,,,,,,,\n");
            continue;
        }
        const bool cloud = seen->look.points > 0; /* triangles of its points are none of the file */
        fprintf(out, "used,%d,%d,%d,%d,%.6g,%d,%d,%d,%d\n", part->n_vertices,
                cloud ? 0 : part->n_triangles, part->n_parts, part->vertices_left_out,
                sim_source_loss(&seen->look), mended->merged, mended->repeated,
                cloud ? 0 : mended->collapsed + part->flat_triangles, mended->unused);
    }
}

/* The meshes and clouds of which something was left out or mended, in one sentence. */
static void report(const struct work *work)
{
    int32_t n = 0, worst = -1;
    double most = -1.0;
    for (int32_t i = 0; i < work->manifest->n; i++) {
        char text[256];
        if (work->seen[i].error) {
            continue;
        }
        sim_source_left_out(&work->seen[i].look, text, sizeof text);
        const double loss = sim_source_loss(&work->seen[i].look);
        n += text[0] != '\0';
        if (text[0] && loss > most) {
            most = loss;
            worst = i;
        }
    }
    if (n > 0) {
        char text[256];
        sim_source_left_out(&work->seen[worst].look, text, sizeof text);
        fprintf(stderr, "isotherm-sim: %d %s mended (meshes.csv); %s: %s\n", n,
                iso_plural((uint64_t)n, "file was", "files were"), work->manifest->rows[worst].file,
                text);
    }
}

static int judge(const struct work *work, struct sim_shape_manifest *manifest, int32_t *coloured,
                 struct iso_fault *fault)
{
    uint8_t *keep = calloc((size_t)manifest->n, 1);
    int32_t n = 0, n_coloured = 0;
    const struct seen *first = NULL;
    if (!keep) {
        return iso_fault_set(fault, -ENOMEM, "out of memory");
    }
    for (int32_t i = 0; i < manifest->n; i++) {
        const struct seen *seen = &work->seen[i];
        keep[i] = seen->error == 0;
        n += keep[i];
        n_coloured += keep[i] && seen->look.colours;
        first = seen->error && !first ? seen : first;
    }
    int error = 0;
    if (first && (n == 0 || work->how->strict)) {
        error = first->error;
        *fault = first->fault;
    } else {
        for (int32_t i = 0; i < manifest->n; i++) {
            if (!keep[i]) {
                fprintf(stderr, "isotherm-sim: left out: %s\n", work->seen[i].fault.text);
            }
        }
        report(work);
        sim_shape_manifest_keep(manifest, keep);
        *coloured = n_coloured;
    }
    free(keep);
    return error;
}

int sim_corpus_look(const struct sim_corpus_look *how, struct sim_shape_manifest *manifest,
                    const char *out, int32_t *coloured, struct iso_fault *fault)
{
    struct work work = {how, manifest, calloc((size_t)manifest->n, sizeof *work.seen)};
    if (!work.seen) {
        return iso_fault_set(fault, -ENOMEM, "out of memory");
    }
    int error = sim_parallel(how->threads, "looking at meshes", (size_t)manifest->n, look_at,
                             &work);
    if (error == -EAGAIN || (error == -EINVAL && !how->strict)) {
        error = iso_fault_set(fault, error, "--threads: %s", strerror(-error));
    } else {
        error = error ? 0 : sim_result_file(out, "meshes.csv", write_meshes, &work, fault);
        if (!error) {
            error = judge(&work, manifest, coloured, fault);
        }
    }
    free(work.seen);
    return error;
}
