#include "tests/support/stored_corpus.h"

#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <unistd.h>

#include <cmocka.h>

#include "sim/corpus/corpus.h"
#include "tests/support/scratch.h"

void stored_corpus_make(const char *directory, const char *manifest)
{
    struct sim_corpus *corpus = NULL;
    assert_int_equal(sim_corpus_parse("manifest", manifest, &corpus, NULL), 0);
    for (size_t i = 0; i < corpus->n_rows; i++) {
        const char *recording = corpus->rows[i].recording;
        char stored[4096];
        (void)snprintf(stored, sizeof stored, "%s/sim/stored/%s", ISOTHERM_SOURCE_DIR, recording);
        /* Several rows may name the same recording. */
        assert_true(symlink(stored, scratch_path(directory, recording)) == 0 || errno == EEXIST);
    }
    sim_corpus_free(corpus);
    scratch_write_text(scratch_path(directory, "manifest.csv"), manifest);
}
