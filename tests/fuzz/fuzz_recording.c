/* The file recording.ini. */
#include <stdlib.h>

#include "drivers/recording/recording.h"
#include "tests/fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct iso_recording_meta meta;
    struct iso_fault fault = {0};
    uint8_t *text = fuzz_copy(data, size);
    int error = iso_recording_meta_parse("input", (const char *)text, &meta, &fault);
    if (error == 0) {
        fuzz_check(iso_recording_meta_check(&meta, NULL) == 0, "a description that is sound");
    } else {
        fuzz_check(fault.text[0] != '\0', "a fault that says something");
    }
    free(text);
    return 0;
}
