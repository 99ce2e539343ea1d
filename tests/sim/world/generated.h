/* Corpora that tests generate, and functions to examine them. A failure fails the running test. */
#ifndef TESTS_SIM_WORLD_GENERATED_H
#define TESTS_SIM_WORLD_GENERATED_H

#include "isotherm/frame.h"
#include "sim/corpus/corpus.h"
#include "sim/world/generate/generate.h"

/* Returns the preset's options for a corpus in `directory`. Skips the test if the head model is
 * missing. */
struct sim_generate_options generated_options(const char *preset, const char *directory);

/* Returns options for a small corpus: two people, three later visits of these people, and one
 * stranger, with two frames each. */
struct sim_generate_options generated_small(const char *directory);

/* Generates the corpus. */
void generated_write(const struct sim_generate_options *options);

/* Generates the corpus and reads it again. Free it with sim_corpus_free. */
struct sim_corpus *generated_corpus(const struct sim_generate_options *options);

/* Returns a frame of a recording. Free it with iso_frame_free. */
struct iso_frame *generated_frame(const char *directory, const char *recording, size_t index);

/* Returns whether a file has the same bytes in two corpora. */
bool generated_same(const char *a, const char *b, const char *file);

/* Returns the point that a pixel measures in a frame of a pinhole camera; z is 0 if the pixel has
 * no measurement. */
struct iso_vec3 generated_point(const struct iso_frame *frame, int column, int row);

/* Solves n <= 6 linear equations: a[i][0..n-1] x = a[i][6]. The solution x replaces a[i][6]. */
void generated_solve(double a[6][7], int n);

#endif
