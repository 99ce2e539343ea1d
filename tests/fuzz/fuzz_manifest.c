/* The manifest.csv of a corpus. */
#include <stdlib.h>

#include "sim/corpus/corpus.h"
#include "tests/fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct sim_corpus *corpus = NULL;
    struct iso_fault fault = {0};
    uint8_t *text = fuzz_copy(data, size);
    int error = sim_corpus_parse("input", (const char *)text, &corpus, &fault);
    if (error == 0) {
        fuzz_check(corpus->n_rows > 0, "rows");
    } else {
        fuzz_check(corpus == NULL && fault.text[0] != '\0', "a fault and no corpus");
    }
    sim_corpus_free(corpus);
    free(text);
    return 0;
}
