/* Files that have points and no triangles. A command that works on clouds takes them, and every
 * other one refuses them. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "sim/shapes/mesh/mesh_file.h"
#include "tests/support/near.h"
#include "tests/support/scratch.h"

typedef int parser(enum iso_mesh_format format, const char *name, char *bytes, size_t size,
                   char *tri, struct iso_coloured_mesh *out, struct iso_fault *fault);

static int parse(parser *by, enum iso_mesh_format format, const char *text,
                 struct iso_coloured_mesh *out, struct iso_fault *fault)
{
    char copy[512];
    assert_true(strlen(text) < sizeof copy);
    strcpy(copy, text);
    return by(format, "m", copy, strlen(text), NULL, out, fault);
}

/* The points (1, 2, 3), (4, 5, 7.5) and the first one again. */
static const struct {
    enum iso_mesh_format format;
    const char *text;
    bool colours;
} cloud[] = {
    {ISO_MESH_FORMAT_XYZ, "# x y z n\n1 2 3 0.1 0.2 0.3\n\n4 5 7.5 text\n1 2 3\n", false},
    {ISO_MESH_FORMAT_OFF, "OFF\n3 0 0\n1 2 3\n4 5 7.5\n1 2 3\n", false},
    {ISO_MESH_FORMAT_OFF, "COFF\n3 0 0\n1 2 3 255 0 0\n4 5 7.5 0 0 0\n1 2 3 0 0 0\n", true},
    {ISO_MESH_FORMAT_OBJ, "v 1 2 3\nv 4 5 7.5\nv 1 2 3\n", false},
    {ISO_MESH_FORMAT_PLY,
     "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
     "property float z\nend_header\n1 2 3\n4 5 7.5\n1 2 3\n",
     false},
    {ISO_MESH_FORMAT_PLY,
     "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
     "property float z\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n"
     "1 2 3\n4 5 7.5\n1 2 3\n",
     false},
};

static void reads_clouds(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof cloud / sizeof *cloud; i++) {
        struct iso_coloured_mesh mesh = {NULL, NULL};
        struct iso_fault fault = {.text = ""};
        struct iso_mesh_mended mended;
        assert_int_equal(
            parse(iso_mesh_or_cloud_parse, cloud[i].format, cloud[i].text, &mesh, &fault), 0);
        assert_int_equal(mesh.mesh->n_vertices, 3);
        assert_int_equal(mesh.mesh->n_triangles, 0);
        assert_near(mesh.mesh->vertices_mm[1].z, 7.5, 0.0);
        assert_int_equal(mesh.colour != NULL, cloud[i].colours);
        assert_int_equal(iso_mesh_mend(&mesh, &mended), 0);
        assert_int_equal(mesh.mesh->n_vertices, 2);
        assert_int_equal(mended.merged, 1);
        assert_int_equal(mended.unused, 0);
        if (cloud[i].colours) {
            assert_near(mesh.colour[0].channel[0], 0.5, 1e-6);
        }
        iso_coloured_mesh_done(&mesh);
        assert_int_equal(parse(iso_mesh_parse, cloud[i].format, cloud[i].text, &mesh, &fault),
                         -EBADMSG);
        assert_null(mesh.mesh);
    }
}

static void refuses_damage(void **state)
{
    (void)state;
    struct iso_coloured_mesh mesh = {NULL, NULL};
    struct iso_fault fault = {.text = ""};
    assert_int_equal(
        parse(iso_mesh_or_cloud_parse, ISO_MESH_FORMAT_XYZ, "1 2 3\n4 5\n", &mesh, &fault),
        -EBADMSG);
    assert_non_null(strstr(fault.text, "m:2: 2 numbers of a point"));
    assert_int_equal(parse(iso_mesh_or_cloud_parse, ISO_MESH_FORMAT_XYZ, "1 2 x\n", &mesh, &fault),
                     -EBADMSG);
    assert_non_null(strstr(fault.text, "m:1: bad coordinate 'x'"));
    assert_int_equal(
        parse(iso_mesh_or_cloud_parse, ISO_MESH_FORMAT_XYZ, "# nothing\n", &mesh, &fault),
        -EBADMSG);
    assert_non_null(strstr(fault.text, "m: no points"));
}

static void reads_files(void **state)
{
    struct iso_coloured_mesh mesh = {NULL, NULL};
    struct iso_fault fault = {.text = ""};
    scratch_write_text(scratch_path(*state, "c.XYZ"), "1 2 3\n4 5 6\n");
    assert_int_equal(iso_mesh_file_read(scratch_path(*state, "c.XYZ"), &mesh, &fault), -ENOTSUP);
    assert_non_null(strstr(fault.text, "a mesh is wanted here"));
    assert_int_equal(
        iso_mesh_or_cloud_file_read(scratch_path(*state, "c.XYZ"), &mesh, NULL, &fault), 0);
    assert_int_equal(mesh.mesh->n_vertices, 2);
    iso_coloured_mesh_done(&mesh);
    assert_int_equal(
        iso_mesh_or_cloud_file_read(scratch_path(*state, "c.pcd"), &mesh, NULL, &fault), -ENOTSUP);
    assert_non_null(strstr(fault.text, ".vert or .xyz"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reads_clouds),
        cmocka_unit_test(refuses_damage),
        cmocka_unit_test_setup_teardown(reads_files, scratch_setup, scratch_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
