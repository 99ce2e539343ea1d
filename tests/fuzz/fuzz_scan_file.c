/* Scanner files of public databases: the first byte chooses the format. */
#include <stdlib.h>

#include "sim/corpus/scan_file.h"
#include "tests/fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static int (*const parsers[])(const char *, const char *, size_t, struct iso_mesh **,
                                  struct iso_fault *) = {
        sim_scan_parse_abs,
        sim_scan_parse_bnt,
        sim_scan_parse_vrml,
    };
    if (size == 0) {
        return 0;
    }
    struct iso_mesh *mesh = NULL;
    struct iso_fault fault = {0};
    uint8_t *bytes = fuzz_copy(data + 1, size - 1);
    int error = parsers[data[0] % 3]("input", (const char *)bytes, size - 1, &mesh, &fault);
    if (error == 0) {
        fuzz_check(mesh->n_triangles > 0 && iso_mesh_check(mesh, NULL) == 0, "a sound mesh");
    } else {
        fuzz_check(mesh == NULL && fault.text[0] != '\0', "a fault and no mesh");
    }
    iso_mesh_free(mesh);
    free(bytes);
    return 0;
}
