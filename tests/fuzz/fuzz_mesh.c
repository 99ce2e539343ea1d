/* Mesh files: the first byte chooses the format, and whether clouds are wanted. The first '!'
 * separates the two files of a TOSCA mesh.
 */
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "sim/shapes/mesh/mesh_file.h"
#include "tests/fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct iso_coloured_mesh mesh = {NULL, NULL};
    struct iso_fault fault = {0};
    if (size == 0) {
        return 0;
    }
    enum iso_mesh_format format = (enum iso_mesh_format)(data[0] % ISO_MESH_FORMATS);
    char *bytes = (char *)fuzz_copy(data + 1, size - 1), *tri = NULL;
    size_t length = size - 1;
    if (format == ISO_MESH_FORMAT_TOSCA) {
        tri = bytes + strcspn(bytes, "!");
        length = *tri ? (size_t)(tri - bytes) : length;
        *tri = '\0';
        tri += length < size - 1;
    }
    const bool clouds = data[0] / ISO_MESH_FORMATS % 2;
    int error = (clouds ? iso_mesh_or_cloud_parse : iso_mesh_parse)(format, "input", bytes, length,
                                                                    tri, &mesh, &fault);
    if (error) {
        fuzz_check(mesh.mesh == NULL && fault.text[0] != '\0', "a fault and no mesh");
    } else if (iso_mesh_mend(&mesh, NULL) == 0) {
        struct iso_fault what = {.text = ""};
        fuzz_check(iso_mesh_check(mesh.mesh, &what) == 0, "a sound mesh");
    }
    iso_coloured_mesh_done(&mesh);
    free(bytes);
    return 0;
}
