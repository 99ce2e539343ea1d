/* PNG files, which come from recordings. */
#include <stdlib.h>
#include <string.h>

#include "drivers/file/png.h"
#include "tests/fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct iso_image image = {0};
    struct iso_fault fault = {0};
    uint8_t *bytes = fuzz_copy(data, size);
    int error = iso_png_read_memory("input", bytes, size, NULL, &image, &fault);
    if (error == 0) {
        size_t pixels = iso_image_row_bytes(&image) * (size_t)image.height_px;
        fuzz_check(pixels > 0 && pixels <= image.capacity, "a picture that fits its memory");
    } else {
        fuzz_check(error < 0 && strncmp(fault.text, "input", 5) == 0,
                   "a fault that names the file");
    }
    iso_image_done(&image);
    free(bytes);
    return 0;
}
