/* isotherm-sim shapes: makes corpora of non-rigid shapes and measures their retrieval by
 * descriptors of heat diffusion. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "drivers/terminal/words.h"
#include "sim/commands/command.h"
#include "sim/commands/commands.h"
#include "sim/lab/match/extract_options.h"
#include "sim/shapes/describe/describe.h"
#include "sim/shapes/make/crops.h"
#include "sim/shapes/make/generate.h"
#include "sim/shapes/match/match.h"
#include "sim/shapes/search/query.h"
#include "sim/shapes/study/choice.h"
#include "sim/shapes/study/study.h"
#include "sim/shapes/study/tables.h"

struct arguments {
    struct sim_shapes_options generate;
    struct sim_shapes_study_options study;
    struct sim_tables_options tables;
    struct sim_crops_options crops;
    struct sim_describe_options describe;
    struct sim_index_options index;
    struct sim_query_options query;
    struct sim_match_options match;
    int threads;
};

#define FIELD(name) offsetof(struct arguments, name)

static const struct sim_option generate_options[] = {
    {"preset", "plain|textured", "what kind of corpus (plain)", sim_option_text,
     FIELD(generate.preset)},
    {"out", "DIR", "where the meshes go (made if it is missing)", sim_option_text,
     FIELD(generate.out)},
    {"seed", "S", "seed of all random numbers (1)", sim_option_count, FIELD(generate.seed)},
    {"classes", "N", "kinds of creature (12 plain, 10 textured)", sim_option_count,
     FIELD(generate.classes)},
    {"shapes", "N", "plain: number of shapes (148)", sim_option_count, FIELD(generate.shapes)},
    {"vertices", "N", "vertices of each shape, 200..200000 (3000)", sim_option_count,
     FIELD(generate.vertices)},
    {"format", "off|ply|vert", "format of the files (plain: off, textured: ply); vert: TOSCA",
     sim_option_text, FIELD(generate.format)},
    {"rest", NULL, "also write rest/NAME.npy: each vertex on the body at rest", sim_option_flag,
     FIELD(generate.rest)},
    {"threads", "N", "1..64 (a thread for each processor)", sim_option_threads, FIELD(threads)},
};

/* The options for the times of heat, which `times` of the arguments receives. */
#define TIMES_OPTIONS(times)                                                                  \
    {"times", "N",                                                                            \
     "times of heat, 40..1000; not of shape-dna, td, local-heat (0: the method's own)",       \
     sim_option_int, FIELD(times.n)},                                                         \
        {"time-first", "A", "the first of them, in areas of the shape (0: the method's own)", \
         sim_option_number, FIELD(times.first)},                                              \
    {                                                                                         \
        "time-last", "A", "the last of them (0: the method's own)", sim_option_number,        \
            FIELD(times.last)                                                                 \
    }

static const struct sim_option eval_options[] = {
    {"corpus", "DIR",
     "meshes or clouds: with manifest.csv (file,class), or each class in a folder of its own",
     sim_option_text, FIELD(study.corpus)},
    {"out", "DIR", "where the results go (made if it is missing)", sim_option_text,
     FIELD(study.out)},
    {"method", "NAME,...|all", "methods, see below (all); may be repeated", sim_option_list,
     FIELD(study.methods)},
    {"classifier", "NAME,...|all", "classifiers (each method's own); may be repeated",
     sim_option_list, FIELD(study.classifiers)},
    {"pairs", "N", "eigenpairs (100)", sim_option_int, FIELD(study.pairs)},
    {"words", "N", "words of vocabularies, or principal components (the method's own, 64)",
     sim_option_int, FIELD(study.words)},
    TIMES_OPTIONS(study.times),
    {"neighbours", "N", "clouds: neighbours of a point from which its triangles are made (30)",
     sim_option_int, FIELD(study.neighbours)},
    {"distort", "KIND:LEVEL",
     "distort the queries: white, shot, scale, missing, stretch or bulge, 1..3",
     sim_distortion_parse, FIELD(study.distortion)},
    {"queries", "N", "look for N shapes only, the first of every class in turn (0: all)",
     sim_option_count, FIELD(study.queries)},
    {"smooth", "N", "double steps of Taubin's filter before all else (0)", sim_option_int,
     FIELD(study.smooth)},
    {"vertices", "N", "reduce larger meshes to N vertices (0: none)", sim_option_int,
     FIELD(study.vertices)},
    {"seed", "S", "seed of distortions, vocabularies and folds (1)", sim_option_count,
     FIELD(study.seed)},
    {"pictures", "N", "draw the first N matches of some queries (10; 0: none)", sim_option_int,
     FIELD(study.pictures)},
    {"mend", NULL, "use meshes even if over 1 % of the area is outside of the largest part",
     sim_option_flag, FIELD(study.mend)},
    {"strict", NULL, "end at the first mesh that cannot be used", sim_option_flag,
     FIELD(study.strict)},
    {"cache", "DIR", "descriptions of earlier runs (cache in --out; an empty name: none)",
     sim_option_text, FIELD(study.cache)},
    {"threads", "N", "1..64 (a thread for each processor)", sim_option_threads, FIELD(threads)},
};

static const struct sim_option tables_options[] = {
    {"corpus", "DIR", "shapes for the tables of the nonrigid world data set", sim_option_text,
     FIELD(tables.corpus)},
    {"large", "DIR", "shapes for the tables of SHREC'11 (those of --corpus)", sim_option_text,
     FIELD(tables.large)},
    {"textured", "DIR", "shapes with colours for tables 5.1 and 5.2, SHREC'13 (none: left out)",
     sim_option_text, FIELD(tables.textured)},
    {"out", "DIR", "where tables.csv goes (made if it is missing)", sim_option_text,
     FIELD(tables.out)},
    {"queries", "N", "number of shapes to distort as queries (36; 0: all)", sim_option_count,
     FIELD(tables.queries)},
    {"smooth", "N", "double steps of Taubin's filter before all else (10)", sim_option_int,
     FIELD(tables.smooth)},
    {"seed", "S", "seed of all random numbers (1)", sim_option_count, FIELD(tables.seed)},
    {"strict", NULL, "end at the first mesh that cannot be used", sim_option_flag,
     FIELD(tables.strict)},
    {"cache", "DIR", "descriptions of earlier runs (cache in --out; an empty name: none)",
     sim_option_text, FIELD(tables.cache)},
    {"threads", "N", "1..64 (a thread for each processor)", sim_option_threads, FIELD(threads)},
};

static const struct sim_option crops_options[] = {
    {"corpus", "DIR", "recordings and manifest.csv; may be repeated", sim_option_list,
     FIELD(crops.corpora)},
    {"out", "DIR", "where the meshes go (made if it is missing)", sim_option_text,
     FIELD(crops.out)},
    {"rows", "N", "rows of each corpus, evenly spread (0: all)", sim_option_count,
     FIELD(crops.rows)},
};

static const struct sim_option describe_options[] = {
    {"", "MESH...",
     "files: OFF, OBJ, PLY, STL, or TOSCA's .vert beside its .tri; clouds: the same or XYZ",
     sim_option_list, FIELD(describe.meshes)},
    {"out", "DIR", "where a directory for each mesh goes (made if it is missing)", sim_option_text,
     FIELD(describe.out)},
    {"what", "NAME,...|all", "what is written, see below (all)", sim_option_text,
     FIELD(describe.what)},
    {"format", "npy|csv|mat5", "format of the arrays (npy)", sim_option_text,
     FIELD(describe.format)},
    {"pairs", "N", "eigenpairs (100)", sim_option_int, FIELD(describe.pairs)},
    {"laplacian", "plain|robust", "finite elements of the mesh (plain), or for bad meshes",
     sim_option_text, FIELD(describe.laplacian)},
    {"times", "N", "times of hks, on a logarithmic scale (100)", sim_option_int,
     FIELD(describe.quantity.times)},
    {"time-first", "T", "first time, in the square of the mesh's unit (4 ln 10 / last lambda)",
     sim_option_number, FIELD(describe.quantity.time_first)},
    {"time-last", "T", "last time (4 ln 10 / first lambda)", sim_option_number,
     FIELD(describe.quantity.time_last)},
    {"energies", "N", "energies of wks (100)", sim_option_int, FIELD(describe.quantity.energies)},
    {"persistence", "S", "segments: least persistence of a peak, in ranges of the heat (0.1)",
     sim_option_number, FIELD(describe.quantity.persistence)},
    {"neighbours", "N", "clouds: neighbours of a point from which its triangles are made (30)",
     sim_option_int, FIELD(describe.neighbours)},
    {"source", "V", "heat: the vertex of the shape where it starts, from 0 (0)", sim_option_int,
     FIELD(describe.quantity.heat_source)},
    {"views", "N", "how many best views, 1..16 (4)", sim_option_int,
     FIELD(describe.quantity.views)},
    {"view-score", "entropy|divergence", "which views are the best (entropy)", sim_option_text,
     FIELD(describe.view_score)},
    {"vertices", "N", "reduce larger meshes to N vertices (0: none)", sim_option_int,
     FIELD(describe.vertices)},
    {"smooth", "N", "double steps of Taubin's filter before all else (0)", sim_option_int,
     FIELD(describe.smooth)},
    {"mend", NULL, "describe the largest part even if over 1 % of the area is outside of it",
     sim_option_flag, FIELD(describe.mend)},
    {"strict", NULL, "end at the first mesh that cannot be described", sim_option_flag,
     FIELD(describe.strict)},
    {"no-pictures", NULL, "draw no functions.png", sim_option_flag, FIELD(describe.no_pictures)},
    {"threads", "N", "1..64 (a thread for each processor)", sim_option_threads, FIELD(threads)},
};

static const struct sim_option index_options[] = {
    {"", "DIR", "a directory of meshes or clouds, with or without manifest.csv", sim_option_text,
     FIELD(index.corpus)},
    {"out", "DIR", "where the index goes (DIR.index)", sim_option_text, FIELD(index.out)},
    {"method", "NAME", "how shapes are compared, see below (cp-hk)", sim_option_text,
     FIELD(index.method)},
    {"pairs", "N", "eigenpairs (100)", sim_option_int, FIELD(index.pairs)},
    TIMES_OPTIONS(index.times),
    {"neighbours", "N", "clouds: neighbours of a point from which its triangles are made (30)",
     sim_option_int, FIELD(index.neighbours)},
    {"vertices", "N", "reduce larger meshes to N vertices (0: none)", sim_option_int,
     FIELD(index.vertices)},
    {"smooth", "N", "double steps of Taubin's filter before all else (0)", sim_option_int,
     FIELD(index.smooth)},
    {"mend", NULL, "use meshes even if over 1 % of the area is outside of the largest part",
     sim_option_flag, FIELD(index.mend)},
    {"strict", NULL, "end at the first mesh that cannot be used", sim_option_flag,
     FIELD(index.strict)},
    {"threads", "N", "1..64 (a thread for each processor)", sim_option_threads, FIELD(threads)},
};

static const struct sim_option query_options[] = {
    {"", "MESH...", "files of meshes or clouds to look for", sim_option_list, FIELD(query.meshes)},
    {"index", "DIR", "the index, made by shapes index", sim_option_text, FIELD(query.index)},
    {"out", "DIR", "where rankings and pictures go (none are written)", sim_option_text,
     FIELD(query.out)},
    {"matches", "N", "how many shapes are printed and drawn, 1..100 (10)", sim_option_int,
     FIELD(query.matches)},
    {"mend", NULL, "look for the largest part even if over 1 % of the area is outside of it",
     sim_option_flag, FIELD(query.mend)},
};

static const struct sim_option match_options[] = {
    {"", "FROM TO", "two files of meshes or clouds", sim_option_list, FIELD(match.meshes)},
    {"out", "DIR", "where the results go (made if it is missing)", sim_option_text,
     FIELD(match.out)},
    {"pairs", "N", "eigenpairs to which the map is refined (100)", sim_option_int,
     FIELD(match.pairs)},
    {"first-pairs", "N", "eigenpairs of the first map (20)", sim_option_int,
     FIELD(match.first_pairs)},
    {"step", "N", "eigenpairs that each step of ZoomOut adds (5)", sim_option_int,
     FIELD(match.step)},
    {"weight", "W", "of the commutator with the Laplacians (0.01)", sim_option_number,
     FIELD(match.weight)},
    {"vertices", "N", "reduce larger meshes to N vertices (0: none)", sim_option_int,
     FIELD(match.vertices)},
    {"neighbours", "N", "clouds: neighbours of a point from which its triangles are made (30)",
     sim_option_int, FIELD(match.neighbours)},
    {"mend", NULL, "use meshes even if over 1 % of the area is outside of the largest part",
     sim_option_flag, FIELD(match.mend)},
};

/* Only OpenBLAS has this function. The command starts its own threads; those of OpenBLAS would
 * compete with them for the processors. */
extern void openblas_set_num_threads(int n) __attribute__((weak));

static void quieten_blas(void)
{
    if (openblas_set_num_threads) {
        openblas_set_num_threads(1);
    }
}

static int run_generate(void *target, struct iso_fault *fault)
{
    struct arguments *arguments = target;
    int32_t n = 0;
    if (!arguments->generate.out) {
        return iso_fault_set(fault, -EINVAL, "--out is needed");
    }
    arguments->generate.threads = arguments->threads;
    const int error = sim_shapes_generate(&arguments->generate, &n, fault);
    if (!error) {
        printf("%d %s in %s\n", n, iso_plural((uint64_t)n, "shape", "shapes"),
               arguments->generate.out);
    }
    return error;
}

static int run_eval(void *target, struct iso_fault *fault)
{
    struct arguments *arguments = target;
    if (!arguments->study.corpus || !arguments->study.out) {
        return iso_fault_set(fault, -EINVAL, "--corpus and --out are needed");
    }
    arguments->study.threads = arguments->threads;
    return sim_shapes_study(&arguments->study, stdout, fault);
}

static int run_tables(void *target, struct iso_fault *fault)
{
    struct arguments *arguments = target;
    if (!arguments->tables.corpus || !arguments->tables.out) {
        return iso_fault_set(fault, -EINVAL, "--corpus and --out are needed");
    }
    arguments->tables.threads = arguments->threads;
    return sim_shapes_tables(&arguments->tables, stdout, fault);
}

static int run_crops(void *target, struct iso_fault *fault)
{
    struct arguments *arguments = target;
    int32_t n = 0, n_empty = 0;
    if (!arguments->crops.out) {
        return iso_fault_set(fault, -EINVAL, "--corpus and --out are needed");
    }
    const int error = sim_crops_write(&arguments->crops, &n, &n_empty, fault);
    if (!error) {
        printf("%d shapes in %s; %d %s left out, because the object is too small\n", n,
               arguments->crops.out, n_empty, iso_plural((uint64_t)n_empty, "frame", "frames"));
    }
    return error;
}

static int run_describe(void *target, struct iso_fault *fault)
{
    struct arguments *arguments = target;
    if (!arguments->describe.out) {
        return iso_fault_set(fault, -EINVAL, "--out is needed");
    }
    arguments->describe.threads = arguments->threads;
    return sim_shapes_describe(&arguments->describe, stdout, fault);
}

static int run_index(void *target, struct iso_fault *fault)
{
    struct arguments *arguments = target;
    if (!arguments->index.corpus) {
        return iso_fault_set(fault, -EINVAL, "no directory is given");
    }
    arguments->index.threads = arguments->threads;
    return sim_shapes_index(&arguments->index, stdout, fault);
}

static int run_query(void *target, struct iso_fault *fault)
{
    struct arguments *arguments = target;
    if (!arguments->query.index) {
        return iso_fault_set(fault, -EINVAL, "--index is needed");
    }
    return sim_shapes_query(&arguments->query, stdout, fault);
}

static int run_match(void *target, struct iso_fault *fault)
{
    struct arguments *arguments = target;
    if (!arguments->match.out) {
        return iso_fault_set(fault, -EINVAL, "--out is needed");
    }
    return sim_shapes_match(&arguments->match, stdout, fault);
}

static const struct sim_subcommand targets[] = {
    {{"shapes match", "FROM TO --out DIR",
      "Finds for each vertex of one shape the vertex of another one that corresponds to it, by a\n"
      "functional map that ZoomOut refines.",
      run_match, NULL},
     match_options,
     sizeof match_options / sizeof *match_options},
    {{"shapes index", "DIR",
      "Describes a folder of meshes or clouds once, so that `shapes query` can look for others in "
      "it.",
      run_index, sim_choice_names},
     index_options,
     sizeof index_options / sizeof *index_options},
    {{"shapes query", "MESH... --index DIR",
      "Prints the shapes of an index that are most like a mesh, by the index's method and its "
      "norm.\n"
      "With --out it writes the whole ranking and a picture of the matches.",
      run_query, NULL},
     query_options,
     sizeof query_options / sizeof *query_options},
    {{"shapes describe", "MESH... --out DIR",
      "Writes what is known of single meshes as arrays for other programs, with the parameters\n"
      "beside them, and draws it.",
      run_describe, sim_describe_names},
     describe_options,
     sizeof describe_options / sizeof *describe_options},
    {{"shapes generate", "--out DIR",
      "Makes a corpus of non-rigid shapes: creatures in many poses. The same options make the "
      "same\n"
      "bytes.",
      run_generate, NULL},
     generate_options,
     sizeof generate_options / sizeof *generate_options},
    {{"shapes eval", "--corpus DIR --out DIR",
      "Measures how well methods and classifiers retrieve the shapes of a corpus. Every file is\n"
      "looked at before the work begins; one that cannot be used is named and left out.",
      run_eval, sim_choice_names},
     eval_options,
     sizeof eval_options / sizeof *eval_options},
    {{"shapes tables", "--corpus DIR --out DIR",
      "Prints tables 4.1-4.13, 5.1 and 5.2 of the dissertation, measured on these corpora, with\n"
      "the dissertation's figures beside them.",
      run_tables, NULL},
     tables_options,
     sizeof tables_options / sizeof *tables_options},
    {{"shapes crops", "--corpus DIR --out DIR",
      "Cuts the nearest object out of recorded frames and makes a corpus of faces and of other\n"
      "objects.",
      run_crops, NULL},
     crops_options,
     sizeof crops_options / sizeof *crops_options},
};

int sim_cmd_shapes(int argc, char **argv)
{
    static struct arguments arguments = {
        /* too large for the stack */
        .generate = {.preset = "plain", .seed = 1},
        .study = {.seed = 1, .pictures = 10},
        .tables = {.queries = 36, .smooth = 10, .seed = 1},
        .index = {.method = "cp-hk"},
        .query = {.matches = 10},
        .match = {.first_pairs = 20, .step = 5, .weight = 0.01},
        .describe = {.what = "all",
                     .format = "npy",
                     .laplacian = "plain",
                     .view_score = "entropy",
                     .quantity = {.persistence = 0.1}},
    };
    arguments.threads = sim_threads_default(ISO_HEAT_DIRECT);
    quieten_blas();
    return sim_subcommand_run("shapes", targets, sizeof targets / sizeof *targets, &arguments, argc,
                              argv);
}
