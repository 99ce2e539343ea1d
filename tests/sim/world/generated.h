/* Corpora that tests have generated, and what to look at in them. Failures fail the running test.
 */
#ifndef TESTS_SIM_WORLD_GENERATED_H
#define TESTS_SIM_WORLD_GENERATED_H

#include "isotherm/frame.h"
#include "sim/corpus/corpus.h"
#include "sim/world/generate/generate.h"

/* The preset's options for a corpus in `directory`; skips the test without the head model. */
struct sim_generate_options generated_options(const char *preset, const char *directory);

/* Two people, three later visits of theirs and one stranger, two frames each. */
struct sim_generate_options generated_small(const char *directory);

void generated_write(const struct sim_generate_options *options);

/* Generates and reads back. */
struct sim_corpus *generated_corpus(const struct sim_generate_options *options);

/* A frame of a recording; free with iso_frame_free. */
struct iso_frame *generated_frame(const char *directory, const char *recording, size_t index);

/* Whether two corpora have the same bytes in one file. */
bool generated_same(const char *a, const char *b, const char *file);

/* The point that a pixel of a pinhole camera's frame measures; z 0 if it does not. */
struct iso_vec3 generated_point(const struct iso_frame *frame, int column, int row);

/* Solves n <= 6 linear equations: a[i][0..n-1] x = a[i][6]; x comes out as a[i][6]. */
void generated_solve(double a[6][7], int n);

#endif
