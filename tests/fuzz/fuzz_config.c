/* The appliance's configuration. */
#include <stdlib.h>

#include "firmware/config/config.h"
#include "tests/fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct iso_config config = iso_config_default();
    struct iso_fault fault = {0};
    uint8_t *text = fuzz_copy(data, size);
    int error = iso_config_parse("input", (const char *)text, &config, &fault);
    if (error == 0) {
        fuzz_check(config.decision.agree >= 1 && config.door.unlock_ms > 0, "sane values");
    } else {
        fuzz_check(fault.text[0] != '\0', "a fault that says something");
    }
    free(text);
    return 0;
}
