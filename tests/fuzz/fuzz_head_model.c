/* The head model file. The target corrects its length and checksum. */
#include <math.h>
#include <stdlib.h>

#include "core/base/bytes.h"
#include "core/base/crc32.h"
#include "isotherm/head_model.h"
#include "tests/fuzz/fuzz.h"

enum { CHECKED_FROM = 16 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    uint8_t *bytes = fuzz_copy(data, size);
    struct iso_head_model *model = NULL;
    struct iso_fault fault = {.text = ""};
    if (size >= CHECKED_FROM) {
        (void)iso_put_u32(bytes + 8, (uint32_t)size);
        (void)iso_put_u32(bytes + 12, iso_crc32(0, bytes + CHECKED_FROM, size - CHECKED_FROM));
    }
    if (iso_head_model_parse(bytes, size, &model, &fault) == 0) {
        struct iso_vec3 nose = iso_head_point_on(
            model, model->mean_mm, model->landmarks[iso_landmark_ibug[ISO_LM_NOSE_TIP]]);
        fuzz_check(isfinite(nose.x) && isfinite(nose.y) && isfinite(nose.z), "finite landmarks");
    } else {
        fuzz_check(model == NULL && fault.text[0] != '\0', "a fault and no model");
    }
    iso_head_model_free(model);
    free(bytes);
    return 0;
}
