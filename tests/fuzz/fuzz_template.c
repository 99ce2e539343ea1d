/* Serialised templates, which come from the gallery. The target corrects the checksum, so that the
 * code after its check is reached. */
#include <stdlib.h>

#include "core/base/bytes.h"
#include "core/base/crc32.h"
#include "core/match/distance.h"
#include "isotherm/template.h"
#include "tests/fuzz/fuzz.h"

/* The workspace of registrations. */
static struct iso_icp_workspace registration;

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    uint8_t *bytes = fuzz_copy(data, size);
    if (size >= 4) {
        (void)iso_put_u32(bytes + size - 4, iso_crc32(0, bytes, size - 4));
    }
    struct iso_template tmpl;
    if (iso_template_parse(bytes, size, &tmpl) == 0) {
        struct iso_match_options options = iso_match_options_default();
        uint8_t again[ISO_TEMPLATE_BYTES_MAX];
        double distance_mm;
        int written = iso_template_serialise(&tmpl, again, sizeof again);
        fuzz_check(written == (int)size, "a template that was read can be written");
        fuzz_check(iso_match_distance(&registration, &tmpl, &tmpl, &options, &distance_mm) != 0 ||
                       (distance_mm >= 0.0 && distance_mm < 1e-3),
                   "no distance from a template to itself");
    }
    free(bytes);
    return 0;
}
