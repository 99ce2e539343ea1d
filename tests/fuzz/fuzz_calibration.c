/* Calibration files of camera pairs. */
#include <stdlib.h>

#include "drivers/stereo/calibration.h"
#include "tests/fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct iso_stereo_calibration calibration;
    struct iso_fault fault = {0};
    uint8_t *text = fuzz_copy(data, size);
    int error = iso_stereo_calibration_parse("input", (const char *)text, &calibration, &fault);
    if (error == 0) {
        fuzz_check(iso_stereo_calibration_check(&calibration, NULL) == 0, "cameras that are sound");
    } else {
        fuzz_check(fault.text[0] != '\0', "a fault that says something");
    }
    free(text);
    return 0;
}
