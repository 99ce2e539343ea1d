/* The specification of a GPIO line in the configuration. */
#include <stdlib.h>

#include "drivers/door/gpio_line.h"
#include "tests/fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct iso_gpio_spec spec = {.chip = ""};
    struct iso_fault fault = {0};
    uint8_t *text = fuzz_copy(data, size);
    const int error = iso_gpio_spec_parse("input", (const char *)text, &spec, &fault);
    if (error == 0) {
        fuzz_check((*spec.chip == '\0') != (*spec.name == '\0'), "either a chip or a name");
    } else {
        fuzz_check(fault.text[0] != '\0', "a fault that says something");
    }
    free(text);
    return 0;
}
